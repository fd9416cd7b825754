// The command `pliant edit`, and what its page shows by roles and names, as docs/editor.md has them; for edit_tests.mjs.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdirSync, readFileSync, renameSync, writeFileSync } from "node:fs";
import path from "node:path";
import { createInterface } from "node:readline";

const patience = 60_000; // the machine may be busy [ms]
const pause = (time) => new Promise((resume) => setTimeout(resume, time));

/** Waits until `holds` returns something, and returns that. */
export async function until(holds, what) {
  for (const limit = Date.now() + patience; ; await pause(15)) {
    const found = await holds();
    if (found) return found;
    if (Date.now() > limit) assert.fail(`it does not come: ${typeof what === "function" ? await what() : what}`);
  }
}

/** The same for a value that shall become another one. */
export async function becomes(read, expected, what = "") {
  let last;
  const isThere = async () => JSON.stringify((last = await read())) === JSON.stringify(expected);
  await until(isThere, () => `${what} ${JSON.stringify(expected)}, it stays ${JSON.stringify(last)}`);
}

// A test that fails leaves its command.
const running = new Set();
process.on("exit", () => running.forEach((each) => each.kill("SIGKILL")));

/** A command in a folder of its own. */
export class EditCommand {
  constructor(pliant, folder) {
    this.pliant = pliant;
    this.folder = folder;
    mkdirSync(folder, { recursive: true });
  }

  path = (name) => path.join(this.folder, name);
  read = (name = "scene.xml") => readFileSync(this.path(name), "utf8");

  /** All at once, so that nobody sees half of it. */
  write(text, name = "scene.xml") {
    writeFileSync(this.path(".part"), text);
    renameSync(this.path(".part"), this.path(name));
  }

  async start(...words) {
    const env = { ...process.env, XDG_STATE_HOME: this.path("state") };
    this.process = spawn(this.pliant, ["edit", "--no-open", ...words], { cwd: this.folder, env, stdio: ["ignore", "pipe", "pipe"] });
    this.errors = "";
    this.process.stderr.on("data", (text) => (this.errors += text));
    running.add(this.process);
    this.ended = new Promise((resume) => this.process.once("exit", resume)).finally(() => running.delete(this.process));
    const lines = createInterface({ input: this.process.stdout });
    this.url = await new Promise((resume, refuse) => {
      lines.once("line", resume);
      this.process.once("exit", () => refuse(new Error(this.errors)));
    });
    return this.url;
  }

  async end(signal = "SIGKILL") {
    this.process.kill(signal);
    return this.ended;
  }

  async get(route) {
    const answer = await fetch(this.url + route);
    return answer.json();
  }

  document = () => this.get("document");
  text = async () => (await this.document()).text;

  async post(route, body = {}) {
    const answer = await fetch(this.url + route, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
    assert.equal(answer.status, 200, await answer.clone().text());
  }

  operate = (...operations) => this.post("operations", { operations });
}

/** What one does with a page, and what it shows. */
export class Hand {
  constructor(page, command) {
    this.page = page;
    this.command = command;
    this.tree = page.getByRole("tree", { name: "Objects" });
    this.properties = page.getByRole("region", { name: "Properties" });
    this.view = page.getByRole("img", { name: /: \d+ frames/ });
    this.menu = page.getByRole("menu");
  }

  item = (name) => this.tree.getByRole("treeitem", { name, exact: true });
  row = (name) => this.item(name).getByText(name, { exact: true });
  field = (name, role = "spinbutton") => this.properties.getByRole(role, { name, exact: true });
  key = (name) => this.field(`Key ${name}`, "button");
  handle = (name) => this.page.getByRole("slider", { name, exact: true });
  button = (name) => this.page.getByRole("button", { name, exact: true });
  dialog = (name, role = "dialog") => this.page.getByRole(role, { name });
  entry = (name) => this.menu.getByRole("menuitem", { name, exact: true });
  state = () => this.page.getByRole("status", { name: "State" }).textContent();
  press = (...keys) => keys.reduce((before, key) => before.then(() => this.page.keyboard.press(key)), Promise.resolve());
  focused = () => this.page.evaluate(() => document.activeElement.getAttribute("aria-label") ?? document.activeElement.textContent.trim());
  selected = () => this.tree.getByRole("treeitem", { selected: true }).evaluateAll((all) => all.map((each) => each.getAttribute("aria-label")));
  pressed = (locator) => locator.getAttribute("aria-pressed");
  goTo = (frame) => this.page.evaluate((to) => window.pliant.playback.goTo(to), frame);
  frame = () => this.page.evaluate(() => window.pliant.playback.frame);
  revision = async () => (await this.command.document()).revision;

  alert = (text) => this.page.getByRole("alert").filter({ hasText: text }).first();

  /** Selects by the tree. */
  choose = async (...names) => {
    for (const [k, name] of names.entries()) await this.row(name).click(k === 0 ? {} : { modifiers: ["Control"] });
    await becomes(async () => (await this.selected()).sort(), [...names].sort());
    await this.drawn();
  };

  /** Types a value. */
  type = async (name, text, role) => {
    await this.field(name, role).fill(text);
    await this.press("Enter");
  };

  /** Two pictures later. */
  drawn = () => this.page.evaluate(() => new Promise((resume) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(resume)))));

  /** Waits until the page has read the document as it is now. */
  followed = async () => {
    const revision = await this.revision();
    await this.page.waitForFunction((now) => window.pliant.edit.session.facts.revision >= now, revision);
  };

  /** Waits until the page shows the frame of the document as it is now. */
  settled = async () => {
    await until(async () => {
      const revision = await this.revision();
      return this.page.evaluate((now) => { const { revision, exact } = window.pliant.edit.shown(); return exact && revision === now && window.pliant.edit.scene.head.revision === now && window.pliant.edit.session.facts.revision === now; }, revision);
    }, "the page does not follow");
    await this.drawn();
  };

  /** Waits for the text of the document. */
  says = (text, what) => becomes(() => this.command.text(), text, what);

  /** Positions of a surface on the screen, their frame and revision. */
  shown = (name) => this.page.evaluate((surface) => { const { revision, frame, exact, positions } = window.pliant.edit.shown(); return { revision, frame, exact, positions: [...positions[surface]] }; }, name);

  /** The middle of an element in the window. */
  middle = async (locator) => {
    const { x, y, width, height } = await locator.boundingBox();
    return { x: x + width / 2, y: y + height / 2 };
  };

  /** Drags an element; `held`: keys that are down meanwhile. `before` is done before the pointer is let go. */
  drag = async (locator, dx, dy, { held = [], before = () => {}, steps = 2 } = {}) => {
    const { mouse, keyboard } = this.page;
    const { x, y } = await this.middle(locator);
    await mouse.move(x, y);
    await mouse.down();
    for (const key of held) await keyboard.down(key);
    for (let k = 1; k <= steps; ++k) await mouse.move(x + (dx * k) / steps, y + (dy * k) / steps);
    await before();
    await mouse.up();
    for (const key of held) await keyboard.up(key);
  };

  /** The text of a handle. */
  value = (name) => this.handle(name).getAttribute("aria-valuetext");
  numbers = async (name) => (await this.value(name)).split(" ").map(Number);

  /** Undoes one step, after which the text is that. */
  undo = async (text) => {
    await this.followed();
    await this.press("Control+z");
    await this.says(text, "undo");
    await this.followed();
  };

  /** Undoes all steps, one after the other. */
  undoAll = async (text) => {
    for (let document; (document = await this.command.document()).undo !== ""; ) {
      await this.press("Control+z");
      await until(async () => (await this.revision()) > document.revision, `undo ${document.undo}`);
      await this.followed();
    }
    await this.says(text, "undo all");
  };
}
