// Makes the picture of the page at the top of docs/viewer.md: a sheet under three forces, its
// curves, and the numbers of a vertex; or that in docs/sweeps.md: a sweep of the scene with a take
// that is pointed at. usage: node page_picture.mjs PLIANT SCENE OUT.png [sweep]

import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";

import { chromium } from "playwright-core";

const [pliant, scene, out, isSweep] = process.argv.slice(2);
const folder = mkdtempSync(path.join(tmpdir(), "pliant-page-"));
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
try {
  const sweep = path.join(folder, "damping");
  if (isSweep) {
    const vary = ["--vary", "sheet.damping=2:200:6:log", "--vary", "poke.magnitude*=0.5:1.75:6"];
    execFileSync(path.resolve(pliant), ["sweep", "run", scene, "-o", sweep, ...vary, "--quiet"]);
  }
  execFileSync(path.resolve(pliant), [...(isSweep ? ["sweep", "view", "damping"] : ["view", path.resolve(scene)]), "-o", "page.html", "--quiet"], { cwd: folder });
  const page = await (await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: "dark" })).newPage();
  page.setDefaultTimeout(120_000);
  await page.goto(`file://${folder}/page.html#frame=12`);
  await page.waitForFunction(() => document.documentElement.dataset.ready === "true");
  if (isSweep) {
    await page.waitForFunction(() => document.documentElement.dataset.whole === "true");
    await page.setViewportSize({ width: 1600, height: 1000 });
    await page.evaluate(() => window.pliant.pointing.keep(window.pliant.sweep.row(22), "picture"));
    await page.waitForTimeout(3000);
    await page.screenshot({ path: out });
  } else {
    await page.keyboard.press("c");
    await page.evaluate(() => new Promise((resume) => requestAnimationFrame(() => requestAnimationFrame(resume))));
    await page.mouse.move(560, 330);
    await page.waitForFunction(() => document.getElementById("readout").textContent !== "");
    await page.screenshot({ path: out });
  }
} finally {
  await browser.close();
  rmSync(folder, { recursive: true });
}
