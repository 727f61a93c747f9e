// The stability page in a browser. Called as: node stability.test.mjs PROGRAM FOLDER, or with a folder that holds report.html and
// results.json, and PROGRAM "-"; exit code 77 means skipped.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, rmSync } from "node:fs";
import { join } from "node:path";
import { folder, here, needs, program, skip } from "./start.mjs";

needs("playwright-core");
const { checkOnScreens, chromiumPath } = await import("./browser.mjs");

const kWeights = ["skipped", "held", "degraded", "fails as expected", "wrong"];
const classOf = outcome => outcome.replaceAll(" ", "-");
const marksShown = page => page.$$eval("button.mark", all => all.filter(mark => mark.offsetParent !== null).length);

// From results.json alone: the heaviest outcome of all draws of a case on a surface by a method.
function expectedMarks(results) {
  const worst = new Map();
  for (const cell of results.cells) {
    const key = [cell.case, cell.surface, cell.method].join("\n"), weight = kWeights.indexOf(cell.outcome);
    assert.ok(weight >= 0, `${cell.outcome} is no outcome`);
    worst.set(key, Math.max(weight, worst.get(key) ?? 0));
  }
  return [...worst.values()].map(weight => classOf(kWeights[weight])).sort();
}

async function everyCellHasItsMark({ page }, results) {
  const marks = await page.$$eval("button.mark", all => all.map(mark => mark.className.replace("mark ", "")));
  assert.deepEqual(marks.sort(), expectedMarks(results));
  assert.equal(await marksShown(page), marks.length);
  for (const [outcome, count] of Object.entries(results.counts)) {
    assert.equal(Number(await page.textContent(`.count.${classOf(outcome)} strong`)), count, outcome);
  }
  const cases = await page.$$eval("tr.case", all => all.length);
  assert.equal(cases, results.cases.length);
}

async function outcomesAreToldApartWithoutColour({ page }) {
  const looks = await page.$$eval(".count .mark", all => all.map(mark => [mark.textContent, getComputedStyle(mark).borderStyle, getComputedStyle(mark).borderWidth]));
  assert.equal(new Set(looks.map(([glyph]) => glyph)).size, kWeights.length, "glyphs differ");
  assert.equal(new Set(looks.map(([, style, width]) => style + width)).size, kWeights.length, "outlines differ");
  const labels = await page.$$eval("button.mark", all => all.map(mark => [mark.className.replace("mark ", ""), mark.getAttribute("aria-label")]));
  for (const [outcome, label] of labels) assert.equal(classOf(label.split(":")[0]), outcome, "a mark is read out with its outcome");
}

// WCAG 2.2: text 4.5:1, what can be pressed at least 24 px.
async function marksCanBeReadAndPressed({ page }) {
  const faint = await page.evaluate(() => {
    const canvas = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
    const luminance = (under, color) => {
      canvas.fillStyle = under;
      canvas.fillRect(0, 0, 1, 1);
      canvas.fillStyle = color;
      canvas.fillRect(0, 0, 1, 1);
      const [r, g, b] = [...canvas.getImageData(0, 0, 1, 1).data].map(c => (c / 255 <= .04045 ? c / 255 / 12.92 : ((c / 255 + .055) / 1.055) ** 2.4));
      return .2126 * r + .7152 * g + .0722 * b;
    };
    const card = getComputedStyle(document.querySelector(".scroll")).backgroundColor, found = [];
    for (const mark of document.querySelectorAll(".mark")) {
      const paper = luminance(card, getComputedStyle(mark).backgroundColor);
      for (const part of mark.children) {
        const ink = luminance(card, getComputedStyle(part).color), ratio = (Math.max(ink, paper) + .05) / (Math.min(ink, paper) + .05);
        if (ratio < 4.5) found.push(`${mark.className} ${part.tagName} ${ratio.toFixed(2)}`);
      }
    }
    return [...new Set(found)];
  });
  assert.deepEqual(faint, []);
  const small = await page.$$eval("button.mark, .count, #panel .close", all => all.map(one => one.getBoundingClientRect())
    .filter(box => box.width > 0 && (box.width < 24 || box.height < 24)).length);
  assert.equal(small, 0, "marks that are hard to hit");
}

async function outcomesCanBeTakenAway({ page }, results) {
  const all = await marksShown(page);
  for (const outcome of kWeights) {
    const box = page.locator(`input[name=outcome][value=${classOf(outcome)}]`), own = expectedMarks(results).filter(one => one === classOf(outcome)).length;
    await box.focus();
    await page.keyboard.press("Space");
    assert.equal(await marksShown(page), all - own, outcome);
    assert.match(await page.textContent(".status"), new RegExp(`^${all - own} of ${all} marks`));
    const empty = await page.$$eval("tr.case", lines => lines.filter(line => line.offsetParent !== null && ![...line.querySelectorAll("button.mark")].some(mark => !mark.hidden)).length);
    assert.equal(empty, 0, "cases without a mark stay away");
    await page.keyboard.press("Space");
  }
  const surface = results.cells[0].surface;
  await page.selectOption("select[name=surface]", surface);
  const kept = new Set(results.cells.filter(cell => cell.surface === surface).map(cell => [cell.case, cell.method].join("\n"))).size;
  assert.equal(await marksShown(page), kept);
  await page.selectOption("select[name=surface]", "");
  assert.equal(await marksShown(page), all);
}

async function aMarkOpensWithEverythingAboutIt({ page }, results) {
  const data = JSON.parse(await page.$eval("#stability", element => element.textContent));
  let pictures = 0;
  for (const outcome of kWeights) {
    const mark = page.locator(`button.mark.${classOf(outcome)}`).first();
    if (await mark.count() === 0) continue;
    const cell = data.cells[data.marks[Number(await mark.getAttribute("data-mark"))].worst];
    assert.ok(results.cells.some(one => one.case === cell.case && one.message === cell.message && one.outcome === cell.outcome));
    await mark.scrollIntoViewIfNeeded();
    await mark.click();
    assert.ok(await page.isVisible("#panel"));
    const text = await page.innerText("#panel");
    for (const part of [cell.outcome, cell.message, cell.method, ...cell.said, cell.command]) {
      assert.ok(text.replace(/\s+/g, " ").includes(part.replace(/\s+/g, " ").trim()), `"${part}" is not told`);
    }
    assert.match(cell.command, new RegExp(`^limn stability --case ${cell.case} --seed ${cell.seed}\\b`));
    if (cell.number !== null) assert.match(text, /bound/);
    for (const image of await page.$$("#panel img")) {
      await image.evaluate(one => one.decode());
      assert.ok(await image.evaluate(one => one.naturalWidth > 0 && one.alt.length > 0));
      ++pictures;
    }
    const edges = await page.$eval("#panel", one => one.getBoundingClientRect().toJSON());
    assert.ok(edges.left >= 0 && edges.top >= 0 && edges.right <= page.viewportSize().width && edges.bottom <= page.viewportSize().height);
    await page.keyboard.press("Escape");
    assert.ok(!await page.isVisible("#panel"));
    assert.equal(await page.evaluate(() => document.activeElement.dataset.mark), await mark.getAttribute("data-mark"), "focus goes back");
  }
  if (data.cells.some(cell => cell.picture && kWeights.indexOf(cell.outcome) > 1)) assert.ok(pictures > 0, "pictures are shown");
}

async function pointingAtAMarkShowsIt({ page }) {
  if (page.viewportSize().width < 800) return;
  const mark = page.locator("button.mark").first();
  await mark.scrollIntoViewIfNeeded();
  // It may lie there already, and only coming over a mark shows it.
  await page.mouse.move(2, 2);
  await mark.hover();
  assert.ok(await page.isVisible("#panel"));
  await page.mouse.move(2, 2);
  assert.ok(!await page.isVisible("#panel"));
}

async function arrowsGoFromMarkToMark({ page }) {
  assert.equal(await page.$$eval("button.mark", all => all.filter(mark => mark.tabIndex === 0).length), 1, "one stop for the tabulator");
  await page.locator("button.mark[tabindex='0']").focus();
  const at = () => page.evaluate(() => Number(document.activeElement.dataset.mark));
  const order = await page.$$eval("button.mark", all => all.map(mark => Number(mark.dataset.mark)));
  const from = order.indexOf(await at());
  const [key, back, to] = from + 1 < order.length ? ["ArrowRight", "ArrowLeft", from + 1] : ["ArrowLeft", "ArrowRight", from - 1];
  await page.keyboard.press(key);
  assert.equal(await at(), order[to]);
  await page.keyboard.press(back);
  assert.equal(await at(), order[from]);
  const line = () => page.evaluate(() => [...document.querySelectorAll("tr.case")].indexOf(document.activeElement.closest("tr")));
  const start = await line();
  await page.keyboard.press(start === 0 ? "ArrowDown" : "ArrowUp");
  assert.equal(await line(), start === 0 ? 1 : start - 1);
}

async function itFitsTheScreen({ page }) {
  const [wide, screen] = await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
  assert.ok(wide <= screen, `the page is ${wide} px wide on a screen of ${screen} px`);
}

if (!chromiumPath) skip("no Chromium; Debian's package chromium brings it");
if (program !== "-") {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  const cases = ["cube_faces", "corners_split_normals", "inverted_mesh"].flatMap(name => ["--case", name]);
  try {
    execFileSync(program, ["stability", ...cases, "-q", "-o", folder]);
  } catch (error) {
    // 1 says that something is wrong in the cells, which is for other tests to judge.
    assert.equal(error.status, 1, String(error.stderr));
  }
}
const results = JSON.parse(readFileSync(join(folder, "results.json"), "utf8"));
assert.ok(results.cells.length > 0 && results.cases.length > 1);
await checkOnScreens(folder, [{ width: 1280, height: 900 }, { width: 1280, height: 900, dark: true }, { width: 390, height: 844, dark: true }], [
  everyCellHasItsMark, outcomesAreToldApartWithoutColour, marksCanBeReadAndPressed, outcomesCanBeTakenAway, itFitsTheScreen,
  aMarkOpensWithEverythingAboutIt, pointingAtAMarkShowsIt, arrowsGoFromMarkToMark,
], results);
