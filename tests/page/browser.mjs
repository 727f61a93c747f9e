// Debian's Chromium, driven from here, with every request that would leave the page counted.
import assert from "node:assert/strict";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

export const chromiumPath = ["/usr/bin/chromium", "/usr/bin/chromium-browser"].find(path => existsSync(path));

export async function startBrowser() {
  const folder = mkdtempSync(join(tmpdir(), "limn-page-"));
  const context = await chromium.launchPersistentContext(folder, {
    executablePath: chromiumPath,
    headless: true,
    args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
      "--disable-component-update", "--disable-sync"],
  });
  const close = async () => {
    await context.close();
    rmSync(folder, { recursive: true, force: true });
  };
  return { context, close };
}

// Opens a file; what the page asks for and complains about is collected from its first moment on.
export async function openPage(context, file, { width, height, dark = false }) {
  const page = await context.newPage();
  const url = pathToFileURL(file).href;
  const requests = [], complaints = [];
  page.on("request", request => {
    if (!request.url().startsWith("data:") && request.url() !== url) requests.push(request.url());
  });
  page.on("console", message => {
    if (["error", "warning"].includes(message.type())) complaints.push(message.text());
  });
  page.on("pageerror", error => complaints.push(String(error)));
  await page.setViewportSize({ width, height });
  await page.emulateMedia({ colorScheme: dark ? "dark" : "light" });
  await page.goto(url, { waitUntil: "load" });
  return { page, requests, complaints };
}

// Runs the checks on the page on screens of each size; no request leaves the page, which complains of nothing; pictures stay in `folder`.
export async function checkOnScreens(folder, screens, checks, about) {
  const { context, close } = await startBrowser();
  try {
    for (const screen of screens) {
      const opened = await openPage(context, join(folder, "report.html"), screen);
      for (const check of checks) {
        await check(opened, about);
        console.log(`ok: ${check.name} at ${screen.width} px${screen.dark ? ", dark" : ""}`);
      }
      assert.deepEqual(opened.requests, [], "no request left the page");
      assert.deepEqual(opened.complaints, []);
      await opened.page.screenshot({ path: join(folder, `report-${screen.width}${screen.dark ? "-dark" : ""}.png`), fullPage: true });
      await opened.page.close();
    }
  } finally {
    await close();
  }
}
