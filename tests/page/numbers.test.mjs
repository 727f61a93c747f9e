// The numbers that a study's page reckons itself, against the program's. Called as: node numbers.test.mjs TESTS FOLDER, where TESTS is
// limn-test-samples. Needs neither a browser nor packages.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { folder, here, program } from "./start.mjs";

const script = readFileSync(join(here, "../../samples/page/study_numbers.js"), "utf8");
const page = new Function(`${script}\nreturn { cellsOf, pointsOf, frontOf, quickestWithin, predictedSlope, logRange, logTicks };`)();

mkdirSync(folder, { recursive: true });
const file = join(folder, "numbers.json");
execFileSync(program, ["--gtest_filter=StudyPageNumbers.*"], { env: { ...process.env, LIMN_PAGE_NUMBERS: file } });
const numbers = JSON.parse(readFileSync(file, "utf8"));

const near = (a, b, within, about) => assert.ok(Math.abs(a - b) <= within * Math.abs(b), `${about}: ${a} on the page, ${b} in the program`);

// The program's charts leave a little less room about their values than the page's.
function axesAndTicksAreTheProgramsOwn() {
  let ticks = 0;
  for (const axis of numbers.axes) {
    const range = page.logRange(axis.values, axis.least, 0.06);
    for (const key of ["low", "high", "floor"]) near(range[key], axis[key], 1e-12, key);
    assert.equal(range.clamped, axis.clamped);
    const own = page.logTicks(axis.low, axis.high, axis.length);
    assert.equal(own.length, axis.ticks.length);
    own.forEach((tick, i) => near(tick, axis.ticks[i], 1e-12, "tick"));
    ticks += own.length;
  }
  assert.ok(numbers.axes.length >= 400 && ticks > 1000);
}

const choiceOf = (study, { drawing, metric, view, series }) => ({ drawing, view, metric: study.metrics[metric], series: new Set(series) });

function frontsMediansAndSlopesAreTheProgramsOwn() {
  let fronts = 0, slopes = 0, within = 0;
  for (const { data, choices } of numbers.studies) {
    for (const choice of choices) {
      const want = choiceOf(data, choice), cells = page.cellsOf(data, want), points = page.pointsOf(data, cells, want);
      for (const cost of ["ms", "bytes"]) {
        assert.deepEqual(page.frontOf(points, cost, data.beating, want.series).map(point => point.model), choice.fronts[cost]);
        fronts += choice.fronts[cost].length;
      }
      assert.deepEqual(points.map(point => point.model), choice.medians.map(([model]) => model));
      points.forEach((point, i) => {
        const [, lowQuartile, median, ms] = choice.medians[i];
        // The page has six digits, and four of what is drawn only.
        near(point.error, median, 1e-5, point.name);
        near(point.ms, ms, 1e-5, point.name);
        near(point.lowQuartile, lowQuartile, 1e-3, point.name);
      });
      const quickest = page.quickestWithin(points, data.floors[want.metric.name]?.right ?? null);
      assert.equal(quickest?.model ?? null, choice.within);
      within += quickest !== undefined;
      const at = name => data.metrics.findIndex(metric => metric.name === name), [predicted, normal] = [at(data.roles.predicted), at(data.roles.normal)];
      const slope = predicted < 0 ? null : page.predictedSlope(cells.map(cell => [cell[5][predicted], cell[5][normal]]));
      assert.equal(slope === null, choice.slope === null);
      for (const key of slope ? ["low", "median", "high"] : []) near(slope[key], choice.slope[key], 1e-4, `${key} slope`);
      slopes += slope !== null;
    }
  }
  assert.ok(fronts > 500 && slopes > 100 && within > 20, `${fronts} ${slopes} ${within}`);
}

for (const check of [axesAndTicksAreTheProgramsOwn, frontsMediansAndSlopesAreTheProgramsOwn]) {
  check();
  console.log(`ok: ${check.name}`);
}
