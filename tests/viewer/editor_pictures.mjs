// Makes the pictures of docs/editor.md and the film strip of README.md: pages of `pliant edit`, in
// which a pointer, keys or fingers do what the text says.
// usage: node editor_pictures.mjs PLIANT OUT_FOLDER [NAME…]

import { spawn } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { createInterface } from "node:readline";

import { chromium } from "playwright-core";

const [pliant, out, ...wanted] = process.argv.slice(2).map((word, k) => (k < 2 ? path.resolve(word) : word));
mkdirSync(out, { recursive: true });
const folder = mkdtempSync(path.join(tmpdir(), "pliant-editor-"));
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});

/** Runs `body` with a page of a new scene, in a folder of its own. */
async function edit(name, { look = "", ...options }, body) {
  const own = path.join(folder, name);
  mkdirSync(own);
  const command = spawn(pliant, ["edit", "--no-open", "--quiet"], { cwd: own, stdio: ["ignore", "pipe", "ignore"], env: { ...process.env, XDG_STATE_HOME: own } });
  const [address] = await new Promise((resume) => createInterface(command.stdout).once("line", (line) => resume([line])));
  const page = await (await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: "dark", ...options })).newPage();
  page.setDefaultTimeout(60_000);
  try {
    await page.goto(`${address}#${look}`);
    await page.getByRole("list", { name: "Starters" }).waitFor();
    await body(page);
  } finally {
    await page.context().close();
    command.kill("SIGINT");
    await new Promise((resume) => command.once("exit", resume));
  }
}

const take = (page, name, options = {}) => page.screenshot({ path: path.join(out, `${name}.png`), ...options });

/** Waits until all frames are solved, and the one at the playhead is drawn. */
async function settle(page) {
  await page.waitForFunction(() => {
    const { edit } = window.pliant;
    const { frame, revision } = edit.shown();
    const { head } = edit.scene;
    return edit.shown().exact && head?.revision === revision && frame >= head.first && /^(\d+) of \1 /.test(document.getElementById("state").textContent);
  });
  await page.waitForTimeout(600);
}

/** Begins with a starter. */
async function begin(page, name) {
  await page.getByRole("list", { name: "Starters" }).getByRole("button", { name: new RegExp(`^${name}`) }).click();
  await page.waitForFunction(() => window.pliant.edit.scene.head !== undefined);
  await settle(page);
}

async function goTo(page, frame) {
  await page.evaluate((number) => window.pliant.playback.goTo(number), frame);
  await settle(page);
}

const select = (page, name) => page.getByRole("treeitem", { name }).click();

/** Drags a handle so far, and does not let go of it. */
async function drag(page, name, [dx, dy]) {
  const { x, y, width, height } = await page.getByRole("slider", { name }).boundingBox();
  const [fromX, fromY] = [x + width / 2, y + height / 2];
  await page.mouse.move(fromX, fromY);
  await page.mouse.down();
  for (let k = 1; k <= 10; ++k) await page.mouse.move(fromX + (dx * k) / 10, fromY + (dy * k) / 10);
  await settle(page);
}

/** Performs: presses a handle and moves it over offsets, one for each tenth of a second, and lets go. */
async function perform(page, name, offsets, before = () => {}) {
  const { x, y, width, height } = await page.getByRole("slider", { name }).boundingBox();
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  for (const [dx, dy] of offsets) {
    await page.mouse.move(x + width / 2 + dx, y + height / 2 + dy);
    await page.waitForTimeout(100);
  }
  await before();
  await page.mouse.up();
  await settle(page);
}

const button = (page, name) => page.getByRole("button", { name, exact: true });

/** A shot of the starter `sheet`: the finger is led over it and pressed by two passes of the hand, at a quarter of the speed. */
async function shoot(page, { during = () => {}, after = () => {} } = {}) {
  await begin(page, "sheet");
  await page.evaluate(() => window.pliant.edit.editor.selection.set([])); // the scene
  await page.getByRole("spinbutton", { name: "end", exact: true }).fill("120");
  await page.keyboard.press("Enter");
  await select(page, "sheet");
  await page.getByRole("combobox", { name: "release", exact: true }).selectOption("recover"); // what the finger leaves
  await select(page, "finger");
  await goTo(page, 1);
  await button(page, "Record").click();
  await page.getByRole("combobox", { name: "Recording speed" }).selectOption("0.25");
  const hand = Array.from({ length: 185 }, (_, k) => k / 26);
  await page.keyboard.down("Alt"); // over the surface
  await perform(page, "Move finger", hand.map((time) => [70 * Math.sin(time) * Math.min(1, time), 22 * (1 - Math.cos(time))]), () => during(1));
  await page.keyboard.up("Alt");
  await after(1);
  await goTo(page, 1);
  await perform(page, "Magnitude of finger", hand.map((time) => [0, -60 * (1 - Math.cos(2.5 * time))]), () => during(2));
  await after(2);
  await button(page, "Record").click();
}

async function openExport(page, file) {
  await page.getByRole("button", { name: "Export…" }).click();
  const dialog = page.getByRole("dialog", { name: "Export" });
  await dialog.getByRole("textbox", { name: "File" }).fill(file);
  return dialog;
}

const picturesShown = () => [...document.querySelectorAll("#starters img")].every((each) => each.classList.contains("shown"));

async function showStarters(page) {
  await page.waitForFunction(picturesShown);
  await page.waitForTimeout(600); // they come softly
}

// Each takes PNGs whose names begin with its own; those of several are joined to a row by script/gallery.
const pictures = {
  async first() {
    await edit("first", {}, async (page) => {
      await showStarters(page);
      await take(page, "first");
    });
  },
  async window() {
    await edit("window", {}, async (page) => {
      await begin(page, "sheet");
      await select(page, "finger");
      await goTo(page, 12);
      await take(page, "window");
    });
  },
  async properties() {
    await edit("properties", { colorScheme: "light", viewport: { width: 1280, height: 720 } }, async (page) => {
      await begin(page, "sheet");
      await select(page, "finger");
      await goTo(page, 12);
      await page.getByRole("button", { name: "Key center" }).click();
      await goTo(page, 24);
      await page.getByRole("spinbutton", { name: "center x" }).fill("6 / 4");
      await page.getByRole("spinbutton", { name: "center x" }).press("Enter");
      await goTo(page, 33);
      const clip = { x: 1280 - 420, y: 43, width: 420, height: 500 };
      await page.getByRole("spinbutton", { name: "magnitude" }).click({ button: "right" });
      await take(page, "properties-1", { clip });
      await page.keyboard.press("Escape");
      await select(page, "sheet");
      const motion = page.getByRole("group", { name: "Motion" });
      await motion.scrollIntoViewIfNeeded();
      await page.waitForFunction(() => !document.querySelector(".motion input").disabled);
      const box = await motion.boundingBox();
      await take(page, "properties-2", { clip: { ...clip, x: 1280 - 282, width: 282, y: Math.min(box.y + box.height - 490, 720 - 500 - 56) } });
    });
  },
  async curves() {
    await edit("curves", {}, async (page) => {
      await begin(page, "sheet");
      await select(page, "finger");
      await goTo(page, 12);
      await button(page, "Curves").click();
      const keys = page.getByRole("region", { name: "Curves" }).locator("button[data-kind=key]");
      await keys.nth(0).click();
      await keys.nth(1).click({ modifiers: ["Shift"] });
      await take(page, "curves");
    });
  },
  async perform() {
    await edit("perform", {}, async (page) => {
      await page.evaluate(() => document.getElementById("curves-toggle").click());
      await shoot(page, { during: (pass) => (pass === 2 ? take(page, "perform") : null) });
    });
  },
  async takes() {
    await edit("takes", { colorScheme: "light" }, async (page) => {
      await begin(page, "sheet");
      await select(page, "finger");
      await goTo(page, 12);
      await button(page, "Keep take").click();
      await page.getByRole("list", { name: "Takes" }).getByRole("button", { name: "Ghost" }).click();
      await drag(page, "Move finger", [90, 25]);
      await page.mouse.up();
      await settle(page);
      await page.waitForTimeout(1500);
      await take(page, "takes");
    });
  },
  async export() {
    await edit("export", { colorScheme: "light", viewport: { width: 900, height: 600 } }, async (page) => {
      await begin(page, "sheet");
      await goTo(page, 12);
      const dialog = await openExport(page, "finger.glb");
      await dialog.getByRole("button", { name: "Export", exact: true }).click();
      await dialog.getByText("finger.glb is written").waitFor();
      await take(page, "export");
    });
  },
  async narrow() {
    await edit("narrow", { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 1 }, async (page) => {
      await begin(page, "sheet");
      await page.getByRole("button", { name: "Objects" }).tap();
      await page.getByRole("treeitem", { name: "finger" }).tap();
      await goTo(page, 12);
      await take(page, "narrow-1");
      await page.getByRole("button", { name: "Objects" }).tap();
      await page.waitForTimeout(300);
      await take(page, "narrow-2");
      await page.getByRole("button", { name: "Properties" }).tap();
      await page.waitForTimeout(300);
      await take(page, "narrow-3");
    });
  },
  async strip() {
    await edit("strip", { colorScheme: "light", viewport: { width: 760, height: 570 }, look: "regions=off&boxes=off&legend=off&colour=signed&peak=0.3&tilt=36" }, async (page) => {
      await showStarters(page);
      await page.getByRole("button", { name: /^ripple/ }).hover();
      await take(page, "strip-1");
      await begin(page, "ripple");
      await page.getByRole("button", { name: "Objects" }).click();
      await select(page, "drop");
      await page.getByRole("button", { name: "Objects" }).click();
      await goTo(page, 13);
      await drag(page, "Move drop", [120, 10]);
      await take(page, "strip-2");
      await page.mouse.up();
      await goTo(page, 27);
      await take(page, "strip-3");
      const dialog = await openExport(page, "ripple.glb");
      await dialog.getByRole("button", { name: "Export", exact: true }).click();
      await dialog.getByText("ripple.glb is written").waitFor();
      await take(page, "strip-4");
    });
  },
};

try {
  for (const [name, make] of Object.entries(pictures)) {
    if (wanted.length === 0 || wanted.includes(name)) await make();
  }
} finally {
  await browser.close();
  rmSync(folder, { recursive: true });
}
