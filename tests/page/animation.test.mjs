// An animated drawing of `limn contours --frames --animate` in a browser: at any time just the frame is shown whose turn it is, and it is the
// drawing that the same call writes for that frame. Called as: node animation.test.mjs PROGRAM FOLDER; exit code 77 means skipped.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, rmSync } from "node:fs";
import { join } from "node:path";
import { folder, needs, program, skip } from "./start.mjs";

needs("playwright-core");
const { chromiumPath, openPage, startBrowser } = await import("./browser.mjs");
if (!chromiumPath) skip("no Chromium; the package chromium brings it");

const kFrames = 6, kRate = 4;
rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });
const call = ["contours", "tilted_torus", "--size", "240x180", "--frames", String(kFrames), "--turn", "40", "-q"];
execFileSync(program, [...call, "--animate", "--fps", String(kRate), "-o", join(folder, "film.svg")]);
execFileSync(program, [...call, "-o", join(folder, "still.svg")]);

const { context, close } = await startBrowser();
try {
  const { page, requests, complaints } = await openPage(context, join(folder, "film.svg"), { width: 240, height: 180 });
  // Stops the film and says which frames are shown that many seconds after its start.
  const shownAt = seconds => page.evaluate(at => {
    for (const animation of document.getAnimations()) {
      animation.pause();
      animation.currentTime = 1000 * at;
    }
    return [...document.querySelectorAll(".frame")].filter(frame => getComputedStyle(frame).visibility === "visible").map(frame => frame.id);
  }, seconds);
  assert.equal(await page.evaluate(() => document.getAnimations().length), kFrames);
  for (let turn = 0; turn < 2; ++turn) {
    for (let k = 0; k < kFrames; ++k) {
      for (const share of [0.05, 0.5, 0.95]) assert.deepEqual(await shownAt((turn * kFrames + k + share) / kRate), [`frame-${k}`]);
    }
  }
  console.log("ok: one frame at a time, each for its share, again and again");
  for (let k = 0; k < kFrames; ++k) {
    await shownAt((k + 0.5) / kRate);
    const film = await page.screenshot();
    const still = await openPage(context, join(folder, `still_f${k}.svg`), { width: 240, height: 180 });
    assert.ok(film.equals(await still.page.screenshot()), `frame ${k} looks as its still does`);
    const ids = text => [...text.matchAll(/data-id="(\d+)"/g)].map(match => match[1]);
    const shown = await page.$$eval(`#frame-${k} path`, paths => paths.map(path => path.dataset.id));
    assert.deepEqual(shown, ids(readFileSync(join(folder, `still_f${k}.svg`), "utf8")), `frame ${k} has the still's ids`);
    await still.page.close();
  }
  console.log("ok: every frame of the film is the still of that frame");
  const twice = await page.evaluate(() => {
    const ids = [...document.querySelectorAll("[id]")].map(element => element.id);
    return ids.length - new Set(ids).size;
  });
  assert.equal(twice, 0, "no id twice");
  assert.deepEqual([requests, complaints], [[], []]);
} finally {
  await close();
}
