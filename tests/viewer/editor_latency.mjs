// Measures in the page of `pliant edit` how long a drag takes from the pointer's event: until the
// page has the frame, at the last of 96, and until that is drawn. Medians and, in brackets, the
// slowest of ten [ms]. Here Chromium draws by the processor, which takes most of the time.
// usage: node editor_latency.mjs PLIANT SCENE FORCE (the scene has a surface `sheet`)

import { spawn } from "node:child_process";
import { cpSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { createInterface } from "node:readline";

import { chromium } from "playwright-core";

const [pliant, scene, force] = process.argv.slice(2);
const folder = mkdtempSync(path.join(tmpdir(), "pliant-latency-"));
cpSync(scene, path.join(folder, "scene.xml"));
const command = spawn(path.resolve(pliant), ["edit", "scene.xml", "--no-open"], { cwd: folder, stdio: ["ignore", "pipe", "ignore"], env: { ...process.env, XDG_STATE_HOME: folder } });
const address = await new Promise((resume) => createInterface(command.stdout).once("line", resume));
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
try {
  const page = await (await browser.newContext({ viewport: { width: 1000, height: 640 } })).newPage();
  page.setDefaultTimeout(60_000);
  await page.goto(address);
  await page.getByRole("treeitem", { name: force }).click();
  await page.evaluate(() => window.pliant.playback.goTo(96));
  await page.waitForFunction(() => window.pliant.edit.shown().exact && window.pliant.edit.shown().positions.sheet.length > 0);
  await page.evaluate(() => {
    const { edit, stage } = window.pliant;
    window.latency = { arrived: [], drawn: [] };
    let [from, arrived, revision] = [0, undefined, edit.shown().revision];
    addEventListener("pointermove", ({ timeStamp }) => (from = timeStamp), true);
    edit.scene.onChange(() => {
      const shown = edit.shown();
      if (from !== 0 && shown.exact && shown.revision !== revision) arrived ??= performance.now() - from;
    });
    stage.onDraw(() => {
      const shown = edit.shown();
      if (from === 0 || !shown.exact || shown.revision === revision) return;
      window.latency.arrived.push(arrived);
      window.latency.drawn.push(performance.now() - from);
      [from, arrived, revision] = [0, undefined, shown.revision];
    });
  });
  const { x, y, width, height } = await page.getByRole("slider", { name: `Move ${force}` }).boundingBox();
  const [fromX, fromY] = [x + width / 2, y + height / 2];
  await page.mouse.move(fromX, fromY);
  await page.mouse.down();
  for (let k = 1; k <= 40; ++k) {
    const count = await page.evaluate(() => window.latency.drawn.length);
    await page.mouse.move(fromX + 15 * Math.cos(k) + 4, fromY + 15 * Math.sin(k));
    await page.waitForFunction((before) => window.latency.drawn.length > before, count);
  }
  await page.mouse.up();
  const { arrived, drawn } = await page.evaluate(() => window.latency);
  const told = (times) => {
    times.sort((a, b) => a - b);
    return `${times[times.length >> 1].toFixed(0)} (${times[Math.floor(0.9 * times.length)].toFixed(0)})`;
  };
  console.log(`arrived ${told(arrived)}, drawn ${told(drawn)}`);
} finally {
  await browser.close();
  command.kill("SIGINT");
  await new Promise((resume) => command.once("exit", resume));
  rmSync(folder, { recursive: true });
}
