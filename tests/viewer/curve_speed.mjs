// Measures the curve panel of `pliant edit`: how long each picture takes while one pans and zooms, and how long the page
// stops when a key is changed. Medians and, in brackets, the slowest of twenty [ms]. Without FLAGs for Chromium its
// graphics card is one that SwiftShader makes of the processor; with --disable-gpu there is none.
// usage: node curve_speed.mjs PLIANT KEYS [FLAG…]

import { spawn } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { createInterface } from "node:readline";

import { chromium } from "playwright-core";

const [pliant, keys, ...flags] = process.argv.slice(2);
const emulated = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const folder = mkdtempSync(path.join(tmpdir(), "pliant-curves-"));
const perFrame = Math.max(8, keys / 500);
const key = (k) => `<key frame="${1 + k / perFrame}" value="${(500 * Math.sin(k / 30)).toFixed(2)}"/>`;
writeFileSync(
  path.join(folder, "scene.xml"),
  `<scene version="1" fps="24" start="1" end="${Math.max(24, Math.ceil(1 + keys / perFrame))}">
  <surface name="sheet"><grid columns="9" rows="9" width="8" depth="8"/></surface>
  <point name="poke" center="0 0 0" direction="0 1 0" deformationRadius="3" forceRadius="1">
    <animate attribute="magnitude">${Array.from({ length: Number(keys) }, (_, k) => key(k)).join("\n")}</animate>
  </point>
</scene>`,
);
const command = spawn(path.resolve(pliant), ["edit", "scene.xml", "--no-open"], { cwd: folder, stdio: ["ignore", "pipe", "ignore"], env: { ...process.env, XDG_STATE_HOME: folder } });
const address = await new Promise((resume) => createInterface(command.stdout).once("line", resume));
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-dev-shm-usage", ...(flags.length > 0 ? flags : emulated)],
});
const told = (times) => {
  times.sort((a, b) => a - b);
  return `${times[times.length >> 1].toFixed(1)} (${times[Math.floor(0.95 * times.length)].toFixed(1)})`;
};
try {
  const page = await (await browser.newContext({ viewport: { width: 1600, height: 900 } })).newPage();
  page.setDefaultTimeout(120_000);
  await page.goto(address);
  await page.getByRole("button", { name: "Curves", exact: true }).click();
  await page.getByRole("img", { name: new RegExp(`${keys} keys`) }).waitFor();
  // Nothing else is drawn meanwhile.
  await page.waitForFunction(() => /^(\d+) of \1 /.test(document.getElementById("state").textContent));
  await page.waitForTimeout(3000);
  const { x, y, width, height } = await page.locator("#curve-view").boundingBox();
  const [middleX, middleY] = [x + width / 2, y + height / 2];
  // Each turn or move, and then the picture that shows it.
  const measured = (act) =>
    page.evaluate(async ([what, cx, cy]) => {
      const layer = document.elementFromPoint(cx, cy);
      const events = {
        zoom: (k) => layer.dispatchEvent(new WheelEvent("wheel", { clientX: cx, clientY: cy, deltaY: k % 20 < 10 ? -60 : 60, bubbles: true, cancelable: true })),
        pan: (k) => layer.dispatchEvent(new PointerEvent("pointermove", { pointerId: 1, clientX: cx + 40 * Math.sin(k / 5), clientY: cy, bubbles: true })),
      };
      const times = [];
      const channel = new MessageChannel();
      for (let k = 0; k < 120; ++k) {
        const begin = performance.now();
        events[what](k);
        // After the picture's scripts, style, layout and painting.
        await new Promise((resume) => requestAnimationFrame(() => {
          channel.port1.onmessage = resume;
          channel.port2.postMessage(0);
        }));
        times.push(performance.now() - begin);
      }
      return times;
    }, [act, middleX, middleY]);
  console.log(`${keys} keys: zoom ${told(await measured("zoom"))}`);
  await page.mouse.move(middleX, middleY);
  await page.mouse.down({ button: "middle" });
  console.log(`${keys} keys: pan ${told(await measured("pan"))}`);
  await page.mouse.up({ button: "middle" });
  const stops = await page.evaluate(async () => {
    const long = [];
    new PerformanceObserver((list) => long.push(...list.getEntries().map(({ duration }) => duration))).observe({ type: "longtask" });
    const { editor } = window.pliant.edit;
    const [first] = editor.scene.head.channels[0].keys;
    for (let k = 0; k < 5; ++k) {
      const before = editor.session.revision;
      await editor.apply([{ op: "setKey", channel: "poke.magnitude", frame: first.at[0], value: String(k + 1) }]);
      while (editor.scene.head.revision <= before) await new Promise((resume) => setTimeout(resume, 5));
    }
    return long;
  });
  console.log(`${keys} keys: the page stops for ${stops.length === 0 ? "less than 50" : told(stops)} ms after a change`);
} finally {
  await browser.close();
  command.kill("SIGINT");
  await new Promise((resume) => command.once("exit", resume));
  rmSync(folder, { recursive: true });
}
