// The site that ./run docs makes, in a browser: on a wide screen in light and dark, and on a narrow one, five pages fit, load nothing from
// elsewhere and complain of nothing; the search finds; text stands out from its ground.
// site.test.mjs SITE FOLDER: pictures go to FOLDER; exit code 77 means skipped.
import assert from "node:assert/strict";
import { existsSync, mkdirSync } from "node:fs";
import { join } from "node:path";
import { folder, needs, program as site, skip } from "./start.mjs";

needs("playwright-core");
const { chromiumPath, openPage, startBrowser } = await import("./browser.mjs");
const pages = ["index", "cookbook", "methods", "reference", "python"];
const screens = [{ width: 1280, height: 900 }, { width: 1280, height: 900, dark: true }, { width: 390, height: 844 }];

// Of the text that is seen: contrast with the ground behind it (WCAG 2.1), worst first.
function contrasts() {
  const parse = text => (text.match(/[\d.]+/g) ?? []).map(Number);
  const light = ([r, g, b]) => [r, g, b].map(v => v / 255).map(v => (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
    .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const over = (top, below) => { const a = top[3] ?? 1; return [0, 1, 2].map(i => a * top[i] + (1 - a) * below[i]); };
  const ground = element => {
    const layers = [];
    for (let e = element; e; e = e.parentElement) layers.push(parse(getComputedStyle(e).backgroundColor));
    return layers.reverse().reduce((below, top) => (top.length ? over(top, below) : below), [255, 255, 255]);
  };
  const found = [];
  for (const element of document.querySelectorAll("article p, article li, article td, article th, article code, article a, article h1, article h2")) {
    const text = [...element.childNodes].filter(node => node.nodeType === 3).map(node => node.textContent.trim()).join(" ").trim();
    if (!text || !element.checkVisibility()) continue;
    const below = ground(element), a = light(over(parse(getComputedStyle(element).color), below)), b = light(below);
    found.push([(Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), element.tagName, text.slice(0, 40)]);
  }
  return found.sort((x, y) => x[0] - y[0]);
}

if (!chromiumPath) skip("no Chromium; the package chromium brings it");
if (!existsSync(join(site, "index.html"))) skip(`no site in ${site}; ./run docs makes it`);
mkdirSync(folder, { recursive: true });
for (const screen of screens) {
  // The theme keeps the first scheme that it chose: a browser of its own each.
  const { context, close } = await startBrowser();
  try {
    const kind = screen.dark ? "dark" : screen.width < 600 ? "narrow" : "light";
    for (const name of pages) {
      const { page, requests, complaints } = await openPage(context, join(site, `${name}.html`), screen);
      assert.deepEqual(requests.filter(url => !url.startsWith("file:")), [], `${name}: requests`);
      assert.deepEqual(complaints, [], `${name}: complaints`);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
      assert.ok(wide <= 0, `${name}, ${kind}: ${wide} px wider than the screen`);
      const broken = await page.evaluate(async () => {
        const images = [...document.images];
        for (const image of images) image.loading = "eager";
        await Promise.all(images.map(image => image.decode().catch(() => 0)));
        return images.filter(image => !image.naturalWidth).map(image => image.src);
      });
      assert.deepEqual(broken, [], `${name}: pictures`);
      assert.equal(await page.getAttribute("body", "data-md-color-scheme"), screen.dark ? "slate" : "default", `${name}, ${kind}`);
      const [worst] = await page.evaluate(contrasts);
      assert.ok(worst[0] >= 4.5, `${name}, ${kind}: the contrast of ${worst[1]} "${worst[2]}" is ${worst[0].toFixed(2)}`);
      await page.screenshot({ path: join(folder, `${name}-${kind}.png`) });
      console.log(`ok: ${name}, ${kind}: least contrast ${worst[0].toFixed(1)}`);
      await page.close();
    }
    if (kind !== "light") continue;
    const { page } = await openPage(context, join(site, "index.html"), screen);
    await page.click(".md-search__input");
    const found = () => page.waitForSelector(".md-search-result__item a", { timeout: 5000 }).then(() => true, () => false);
    // What is typed before the index is there is not looked for.
    for (let tries = 0; tries < 12; ++tries) {
      await page.fill(".md-search__input", "");
      await page.type(".md-search__input", "rim_width", { delay: 20 });
      if (await found()) break;
      assert.ok(tries < 11, "the search finds nothing");
    }
    console.log(`ok: the search finds ${await page.locator(".md-search-result__item").count()} pages`);
  } finally {
    await close();
  }
}
