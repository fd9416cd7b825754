// Makes the picture of the page at the top of docs/viewer.md: a sheet under three forces, its
// curves, and the numbers of a vertex. usage: node page_picture.mjs PLIANT SCENE OUT.png

import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";

import { chromium } from "playwright-core";

const [pliant, scene, out] = process.argv.slice(2);
const folder = mkdtempSync(path.join(tmpdir(), "pliant-page-"));
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
try {
  execFileSync(pliant, ["view", scene, "-o", path.join(folder, "page.html"), "--quiet"]);
  const page = await (await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: "dark" })).newPage();
  page.setDefaultTimeout(120_000);
  await page.goto(`file://${folder}/page.html#frame=12`);
  await page.waitForFunction(() => document.documentElement.dataset.ready === "true");
  await page.keyboard.press("c");
  await page.evaluate(() => new Promise((resume) => requestAnimationFrame(() => requestAnimationFrame(resume))));
  await page.mouse.move(560, 330);
  await page.waitForFunction(() => document.getElementById("readout").textContent !== "");
  await page.screenshot({ path: out });
} finally {
  await browser.close();
  rmSync(folder, { recursive: true });
}
