// A study's page in a browser. Called as: node study.test.mjs PROGRAM FOLDER, or with a folder that holds a report.html and PROGRAM "-";
// exit code 77 means skipped.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { folder, here, needs, program, skip } from "./start.mjs";

needs("vega");
const { checkOnScreens, chromiumPath } = await import("./browser.mjs");

const kCharts = ["chart_accuracy_time", "chart_accuracy_memory", "chart_order", "chart_normal_border", "chart_views"];

function theVendoredChartsAreTheLockedOnes() {
  const lock = JSON.parse(readFileSync(join(here, "package-lock.json"), "utf8")).packages;
  for (const name of ["vega", "vega-lite", "vega-embed"]) {
    const vendored = readFileSync(join(here, `../../samples/page/vendor/${name}.min.js`), "utf8");
    const locked = readFileSync(join(here, `node_modules/${name}/build/${name}.min.js`), "utf8");
    assert.ok(vendored.endsWith(locked), `${name} differs from the npm package's`);
    const licence = vendored.slice(0, vendored.length - locked.length);
    assert.match(licence, /^\/\*![^]*\*\/\n$/, "before it stands its licence and nothing else");
    assert.ok(licence.includes(`${name} ${lock[`node_modules/${name}`].version},`), "its version is the lock's");
    assert.match(licence, /Redistribution and use in source and binary forms/);
  }
}

const isDrawn = ({ page }) => page.waitForFunction(() => document.body.dataset.drawn);
async function drawnAnew({ page }, change) {
  const before = await page.$eval("body", body => Number(body.dataset.drawn));
  await change();
  await page.waitForFunction(turn => Number(document.body.dataset.drawn) > turn, before);
}
const marksOf = page => page.$$eval("figure.chart", all => Object.fromEntries(all.map(one =>
  [one.id, one.querySelector(".plot").hidden ? 0 : one.querySelectorAll(".plot svg .mark-symbol path").length])));

async function everyChartIsDrawn({ page }) {
  const marks = await marksOf(page);
  assert.deepEqual(Object.keys(marks).sort(), [...kCharts].sort());
  for (const chart of kCharts) assert.ok(marks[chart] > 0, `${chart} shows nothing`);
  const counted = await page.$$eval("figure.chart", all => Object.fromEntries(all.map(one => [one.id, Number(one.dataset.marks)])));
  assert.deepEqual(marks, counted, "as many marks as numbers");
  const words = await page.$$eval(".chart .words", all => all.map(one => one.textContent));
  assert.ok(words.every(text => text.length > 20), "every chart is told in words too");
  assert.ok((await page.$$eval(".plot svg[aria-label], .plot svg [aria-label]", all => all.length)) >= kCharts.length);
}

// From the cells alone: medians of the views, and every pair of models held against each other.
function frontByTrying(study, cost, shown) {
  const metric = study.metrics.findIndex(one => one.name === study.mainMetric), groups = new Map();
  for (const cell of study.cells) {
    if (cell[1] !== study.mainDrawing || cell[5][metric] === null || !shown.has(study.models[cell[0]].series)) continue;
    groups.set(cell[0], [...groups.get(cell[0]) ?? [], cell]);
  }
  const median = values => { const up = values.sort((a, b) => a - b), half = (up.length - 1) / 2; return 0.5 * (up[Math.floor(half)] + up[Math.ceil(half)]); };
  const models = [...groups].map(([model, cells]) => ({
    model, error: median(cells.map(cell => Math.abs(cell[5][metric]))),
    cost: cost === "time" ? median(cells.map(cell => cell[3])) : Math.max(...cells.map(cell => cell[4])) }));
  return models.filter(one => !models.some(other => other.cost <= one.cost && other.error <= one.error &&
    (other.cost < one.cost || other.error < one.error || other.model < one.model))).sort((a, b) => a.cost - b.cost).map(one => one.model);
}
const shownSeries = async page => new Set(await page.$$eval(".filters input:checked", all => all.map(box => Number(box.value))));
const resultOf = (page, id) => page.$eval(`#${id}`, figure => JSON.parse(figure.dataset.result));

async function frontsHoldWhatNothingShownBeats(opened) {
  const { page } = opened, study = JSON.parse(await page.$eval("#study", element => element.textContent));
  const check = async () => {
    const shown = await shownSeries(page);
    for (const cost of ["time", "memory"])
      assert.deepEqual((await resultOf(page, `chart_accuracy_${cost}`)).front, frontByTrying(study, cost, shown), `${cost}, series ${[...shown]}`);
  };
  await check();
  const boxes = page.locator(".filters input"), count = await boxes.count();
  for (let i = 0; i + 1 < count; ++i) {
    await drawnAnew(opened, () => boxes.nth(i).uncheck());
    await check();
    if (i % 2) await drawnAnew(opened, () => boxes.nth(i - 1).check());
  }
  for (let i = 0; i < count; ++i) if (!await boxes.nth(i).isChecked()) await drawnAnew(opened, () => boxes.nth(i).check());
}

async function ordersAreThoseOfTheProgram({ page }) {
  const study = JSON.parse(await page.$eval("#study", element => element.textContent));
  const metric = study.metrics.findIndex(one => one.name === study.mainMetric), [all] = study.looks[study.mainDrawing][metric];
  const { orders } = await resultOf(page, "chart_order");
  assert.equal(orders.length, study.series.length);
  assert.ok(orders.some(order => order !== null));
  all.fits.forEach((fit, i) => assert.equal(orders[i], fit && fit[0]));
}

async function aSeriesCanBeTakenAway(opened) {
  const { page } = opened, before = await marksOf(page);
  const box = page.locator(".filters input").last();
  await box.focus();
  await drawnAnew(opened, () => page.keyboard.press("Space"));
  const without = await marksOf(page);
  for (const chart of ["chart_accuracy_time", "chart_order"]) assert.ok(without[chart] < before[chart], `${chart} is as full as before`);
  await drawnAnew(opened, () => page.keyboard.press("Space"));
  assert.deepEqual(await marksOf(page), before);
}

async function choicesChangeWhatIsDrawn(opened) {
  const { page } = opened;
  const texts = () => page.$eval("#chart_accuracy_time .plot", plot => plot.innerHTML);
  for (const name of ["method", "parameters", "view", "metric"]) {
    const options = await page.$$eval(`.filters select[name=${name}] option`, all => all.map(option => option.value));
    if (options.length < 2) continue;
    const select = page.locator(`.filters select[name=${name}]`), old = await select.inputValue(), before = await texts();
    const marks = await marksOf(page);
    await drawnAnew(opened, () => select.selectOption(options.find(one => one !== old)));
    assert.notEqual(await texts(), before, `${name} changes nothing`);
    if (name === "view") assert.ok((await marksOf(page)).chart_views < marks.chart_views, "one view has fewer marks than all");
    await drawnAnew(opened, () => select.selectOption(old));
    assert.deepEqual(await marksOf(page), marks);
  }
}

async function nothingChosenIsSaid(opened) {
  const { page } = opened, boxes = page.locator(".filters input"), count = await boxes.count();
  for (let i = 0; i < count; ++i) await drawnAnew(opened, () => boxes.nth(i).uncheck());
  assert.match(await page.textContent("#chart_order .caption"), /Nothing to draw/);
  for (let i = 0; i < count; ++i) await drawnAnew(opened, () => boxes.nth(i).check());
}

async function aPointShowsItsNumbersAndPicture({ page }) {
  const mark = page.locator("#chart_accuracy_time .mark-symbol path").first();
  await mark.scrollIntoViewIfNeeded();
  const bubble = page.locator(".bubble");
  // Scrolling hides it, and is told later than it happens.
  for (let tries = 0; tries < 20 && !await bubble.isVisible(); ++tries) {
    const box = await mark.boundingBox();
    await page.mouse.move(box.x + 0.5 * box.width + tries % 2, box.y + 0.5 * box.height);
    await page.waitForTimeout(50);
  }
  assert.ok(await bubble.isVisible(), "pointing at a mark shows its numbers");
  assert.match(await bubble.innerText(), /time[^]*memory/);
  const pictures = await page.$$eval(".bubble img", all => all.map(image => [image.naturalWidth, image.alt]));
  assert.ok(pictures.length === 1 && pictures[0][0] > 0 && pictures[0][1].length > 0, "with the picture of the cell");
  await page.keyboard.press("Escape");
}

async function itFitsTheScreen({ page }) {
  const [wide, screen] = await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
  const beyond = await page.$$eval("body *", (all, edge) => all.filter(one => !one.closest(".scroll") && one.getBoundingClientRect().right > edge + 1)
    .map(one => `${one.tagName}.${one.getAttribute("class")}`).slice(0, 5), screen);
  assert.ok(wide <= screen, `the page is ${wide} px wide on a screen of ${screen} px: ${beyond.join(" ")}`);
  const cut = await page.$$eval(".plot svg", all => all.filter(svg => svg.getBoundingClientRect().width > svg.parentElement.clientWidth + 1).length);
  assert.equal(cut, 0, "charts wider than their places");
}

async function theTableSorts({ page }) {
  const column = () => page.$$eval(".models tbody tr", rows => rows.map(row => row.querySelector("[data-value]").dataset.value));
  const head = page.locator(".models th:not(.text)").first();
  await head.locator("button").focus();
  await page.keyboard.press("Enter");
  const numbers = (await column()).filter(text => text !== "").map(Number);
  assert.deepEqual(numbers, [...numbers].sort((a, b) => a - b));
  assert.equal(await head.getAttribute("aria-sort"), "ascending");
}

theVendoredChartsAreTheLockedOnes();
if (!chromiumPath) skip("no Chromium; Debian's package chromium brings it");
if (program !== "-") {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  const scene = join(folder, "egg.toml");
  writeFileSync(scene, '[[object]]\nshape = "ellipsoid"\nradii = [1.0, 0.7, 0.5]\n');
  execFileSync(program, ["study", scene, "--size", "160x120", "--views", "2", "--levels", "1,2,3", "--voxels", "16,32,48", "-q", "-o", folder]);
}
await checkOnScreens(folder, [{ width: 1280, height: 900 }, { width: 390, height: 844, dark: true }], [
  isDrawn, everyChartIsDrawn, frontsHoldWhatNothingShownBeats, ordersAreThoseOfTheProgram, itFitsTheScreen,
  aSeriesCanBeTakenAway, choicesChangeWhatIsDrawn, nothingChosenIsSaid, aPointShowsItsNumbersAndPicture, theTableSorts,
]);
