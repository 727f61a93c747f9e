// The report page in a browser. Called as: node report.test.mjs PROGRAM FOLDER; exit code 77 means skipped.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { folder, here, needs, program, skip } from "./start.mjs";

needs("playwright-core");
const { checkOnScreens, chromiumPath } = await import("./browser.mjs");

function theVendoredSliderIsTheLockedOne() {
  const vendored = readFileSync(join(here, "../../samples/page/vendor/img-comparison-slider.js"), "utf8");
  const locked = readFileSync(join(here, "node_modules/img-comparison-slider/dist/index.js"), "utf8");
  const version = JSON.parse(readFileSync(join(here, "package-lock.json"), "utf8")).packages["node_modules/img-comparison-slider"].version;
  const licence = vendored.slice(0, vendored.length - locked.length);
  assert.ok(vendored.endsWith(locked), "the slider differs from the npm package's");
  assert.match(licence, /^\/\*![^]*\*\/\n$/, "before the slider stands its licence and nothing else");
  assert.match(licence, new RegExp(`img-comparison-slider ${version.replaceAll(".", "\\.")},`), "its version is the lock's");
  assert.match(licence, /Copyright \(c\) 2019/);
}

async function itLoadsInSilence({ page, requests, complaints }) {
  assert.deepEqual(complaints, []);
  assert.deepEqual(requests, []);
  const broken = await page.$$eval("img", images => images.filter(image => image.src && image.naturalWidth === 0).length);
  assert.equal(broken, 0, "pictures that do not show");
  const wordless = await page.$$eval("img", images => images.filter(image => !image.alt).length);
  assert.equal(wordless, 0, "pictures without words");
}

async function nothingIsWiderThanTheScreen({ page }) {
  const [wide, screen] = await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
  assert.ok(wide <= screen, `the page is ${wide} px wide on a screen of ${screen} px`);
}

const sliderValue = page => page.$eval("img-comparison-slider", slider => Number(slider.value));

async function theSliderMovesByKeyAndByMouse({ page }) {
  const slider = page.locator("img-comparison-slider");
  await slider.scrollIntoViewIfNeeded();
  await slider.focus();
  const outline = await slider.evaluate(element => getComputedStyle(element).outlineStyle);
  assert.notEqual(outline, "none", "the focus shows");
  const before = await sliderValue(page);
  await page.keyboard.down("ArrowRight");
  await page.waitForFunction(value => document.querySelector("img-comparison-slider").value > value + 2, before);
  await page.keyboard.up("ArrowRight");
  const box = await slider.boundingBox();
  await page.mouse.move(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.2 * box.width, box.y + 0.5 * box.height, { steps: 4 });
  await page.mouse.up();
  assert.ok(Math.abs(await sliderValue(page) - 20) < 2, `dragged to 20 %, it is at ${await sliderValue(page)} %`);
  assert.ok(Math.abs(Number(await slider.getAttribute("aria-valuenow")) - 20) <= 2, "readers of the page are told");
  await page.keyboard.press("End");
  assert.equal(await sliderValue(page), 100);
  await page.keyboard.press("Home");
  assert.equal(await sliderValue(page), 0);
}

async function anyTwoPicturesCanBeChosen({ page }) {
  const options = await page.$$eval("select[name=left] option", all => all.map(option => option.value));
  const cells = await page.$$eval(".cell .picture img", all => all.length);
  assert.equal(options.length, cells, "every picture can be chosen");
  const sources = () => page.$$eval("img-comparison-slider img", images => images.map(image => image.src));
  await page.selectOption("select[name=left]", options.at(-1));
  await page.selectOption("select[name=right]", options.at(0));
  const [left, right] = await sources();
  const pictures = await page.$$eval(".cell .picture img", all => all.map(image => image.src));
  assert.equal(left, pictures[Number(options.at(-1))]);
  assert.equal(right, pictures[0]);
  await page.locator(".cell .look").nth(1).click();
  assert.equal((await sources())[1], pictures[1], "a card's picture goes to the right side");
}

async function pixelsAreSquaresWhenEnlarged({ page }) {
  const width = () => page.$eval("img-comparison-slider", slider => slider.offsetWidth);
  await page.selectOption("select[name=zoom]", "8");
  const natural = await page.$eval("img-comparison-slider img", image => image.naturalWidth);
  assert.equal(await width(), 8 * natural);
  assert.equal(await page.$eval("img-comparison-slider img", image => getComputedStyle(image).imageRendering), "pixelated");
  await page.selectOption("select[name=zoom]", "fit");
  assert.ok(await width() <= await page.$eval(".stage", stage => stage.clientWidth));
}

async function theTableSorts({ page }) {
  const column = () => page.$$eval("tbody tr", rows => rows.map(row => row.querySelector("[data-value]").dataset.value));
  const head = page.locator("th:not(.text)").first();
  await head.locator("button").focus();
  await page.keyboard.press("Enter");
  assert.equal(await head.getAttribute("aria-sort"), "ascending");
  const numbers = (await column()).filter(text => text !== "").map(Number);
  assert.ok(numbers.length > 1);
  assert.deepEqual(numbers, [...numbers].sort((a, b) => a - b));
  await page.keyboard.press("Enter");
  assert.equal(await head.getAttribute("aria-sort"), "descending");
  assert.deepEqual((await column()).filter(text => text !== "").map(Number), [...numbers].reverse());
  assert.equal(await page.locator("th[aria-sort]").count(), 1);
}

async function eachMethodHasItsCards({ page }) {
  const listed = JSON.parse(execFileSync(program, ["list", "methods", "--json"], { encoding: "utf8" })).map(method => method.name);
  const shown = await page.$$eval(".method h3", heads => heads.map(head => head.textContent.split(" ")[0]));
  assert.deepEqual(shown, listed);
  await page.check("#show-difference");
  assert.ok(await page.locator(".view.difference").first().isVisible());
  assert.ok(!await page.locator(".cell:has(.difference) .view.picture").first().isVisible());
  await page.check("#show-picture");
}

theVendoredSliderIsTheLockedOne();
if (!chromiumPath) skip("no Chromium; Debian's package chromium brings it");
mkdirSync(folder, { recursive: true });
const coarse = ["--size", "320x240", "--voxels", "48", "--level", "2"];
execFileSync(program, ["compare", "machined_part", "--methods", "all", ...coarse, "-q", "-o", folder]);
await checkOnScreens(folder, [{ width: 1280, height: 900 }, { width: 390, height: 844, dark: true }], [
  itLoadsInSilence, nothingIsWiderThanTheScreen, theSliderMovesByKeyAndByMouse, anyTwoPicturesCanBeChosen,
  pixelsAreSquaresWhenEnlarged, theTableSorts, eachMethodHasItsCards,
]);
