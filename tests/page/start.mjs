// What the page tests are called with, and how they say that they cannot run.
import { existsSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

export const here = dirname(fileURLToPath(import.meta.url));
export const [program, folder] = process.argv.slice(2);

export function skip(reason) {
  console.log(`skipped: ${reason}`);
  process.exit(77);
}

export function needs(packageName) {
  if (!existsSync(join(here, "node_modules", packageName))) skip("tests/page/node_modules is missing; `npm ci` there makes it");
}
