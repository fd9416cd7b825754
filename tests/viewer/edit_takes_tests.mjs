// Tests of takes in the page of `pliant edit`: kept, opened, drawn behind the scene, saved; a part of edit_tests.mjs.

import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import path from "node:path";

import { becomes, until } from "./edit_command.mjs";

/** What a page has of takes. */
class TakesPanel {
  constructor(hand) {
    this.hand = hand;
    this.page = hand.page;
    this.list = hand.page.getByRole("list", { name: "Takes", exact: true });
    this.items = this.list.getByRole("listitem");
  }

  names = () => this.items.evaluateAll((all) => all.map((each) => each.querySelector("button").textContent));
  item = (name) => this.items.filter({ has: this.page.getByRole("button", { name, exact: true }) });
  open = (name) => this.item(name).getByRole("button", { name, exact: true });
  ghost = (name) => this.item(name).getByRole("button", { name: "Ghost", exact: true });
  pressed = () => this.list.getByRole("button", { name: "Ghost", exact: true }).evaluateAll((all) => all.map((each) => each.getAttribute("aria-pressed") === "true"));
  keep = async () => {
    const before = (await this.names()).length;
    await this.hand.button("Keep take").click();
    await until(async () => (await this.names()).length === before + 1, "it is kept");
  };

  /** The ghosts that are drawn: take, frame, and positions of a surface. */
  shown = (surface = "sheet") => this.page.evaluate((name) => window.pliant.edit.ghosts().map(({ take, frame, positions }) => ({ take, frame, positions: [...(positions[name] ?? [])] })), surface);
  /** Waits until these are drawn at that frame. */
  drawn = (takes, frame) => becomes(async () => (await this.shown()).map((each) => [each.take, each.frame]), takes.map((take) => [take, frame]), "ghosts");

  /** Keeps the picture of the view, without what is over it, in the page. */
  picture = (name) =>
    this.page.evaluate(async (key) => {
      (window.pictures ??= {})[key] = (await window.pliant.stage.drawPixels()).data;
    }, name);

  /** How many pixels of two pictures differ. */
  differing = (a, b) =>
    this.page.evaluate((names) => {
      const [one, other] = names.map((name) => window.pictures[name]);
      let count = 0;
      for (let k = 0; k < one.length; k += 4) if ([0, 1, 2].some((c) => Math.abs(one[k + c] - other[k + c]) > 6)) ++count;
      return count;
    }, [a, b]);
}

export function editTakesTests({ test, pictures, scene, editing, opened, baked }) {
  const high = scene.replace('magnitude="3000"', 'magnitude="9000"');

  test("in the editor, takes are kept, and opened as steps", async () => {
    await editing(scene, { height: 700 }, async (hand) => {
      const { page, command: made } = hand;
      const takes = new TakesPanel(hand);
      await hand.settled();
      assert.equal(await takes.list.isVisible(), false);
      assert.equal(await page.getByRole("heading", { name: "Takes" }).isVisible(), false);
      await takes.keep();
      await made.operate({ op: "set", path: "poke.magnitude", value: "9000" });
      await hand.followed();
      await takes.keep();
      assert.deepEqual(await takes.names(), ["Take 1", "Take 2"]);
      assert.deepEqual(await takes.pressed(), [false, false]);
      // Each has a picture that differs from one colour.
      await until(() => takes.items.locator("img.shown").count().then((count) => count === 2), "the pictures");
      const shades = await takes.items.locator("img").evaluateAll((all) => all.map((image) => {
        const canvas = Object.assign(document.createElement("canvas"), { width: 24, height: 15 });
        const context = canvas.getContext("2d");
        context.drawImage(image, 0, 0, 24, 15);
        return [image.naturalWidth, new Set(new Uint32Array(context.getImageData(0, 0, 24, 15).data.buffer)).size];
      }));
      for (const [width, count] of shades) assert.ok(width === 240 && count > 10, `${shades}`);
      await page.screenshot({ path: path.join(pictures, "edit-takes.png") });
      // A step, which can be undone and made again.
      await takes.open("Take 1").click();
      await hand.says(scene);
      await becomes(() => hand.button("Undo").getAttribute("aria-description"), "open Take 1");
      await hand.undo(high);
      await hand.press("Control+Shift+z");
      await hand.says(scene);
      // What it is already changes nothing; by the keyboard too.
      const revision = await hand.revision();
      await takes.open("Take 1").focus();
      await hand.press("Enter");
      await takes.open("Take 2").focus();
      await hand.press("Space");
      await hand.says(high);
      assert.equal(await hand.revision(), revision + 1);
      assert.equal(await page.evaluate(() => window.pliant.playback.isPlaying), false);
    });
  });

  test("in the editor, takes have a menu and keys: they are renamed, saved and deleted", async () => {
    await editing(scene, { height: 700 }, async (hand) => {
      const { page, command: made, press } = hand;
      const takes = new TakesPanel(hand);
      await hand.settled();
      await takes.keep();
      await made.operate({ op: "set", path: "poke.magnitude", value: "9000" });
      await hand.followed();
      await takes.keep();
      // Names are text.
      await takes.open("Take 1").click({ button: "right" });
      assert.deepEqual(await hand.menu.getByRole("menuitem").evaluateAll((all) => all.map((each) => each.getAttribute("aria-label"))), ["Rename", "Save as…", "Delete"]);
      await hand.entry("Rename").click();
      assert.equal(await hand.focused(), "New name of Take 1");
      await page.keyboard.type("<b>calm</b>");
      await press("Enter");
      await becomes(takes.names, ["<b>calm</b>", "Take 2"]);
      await becomes(hand.focused, "<b>calm</b>");
      await press("F2");
      await page.keyboard.type("no");
      await press("Escape");
      assert.deepEqual(await takes.names(), ["<b>calm</b>", "Take 2"]);
      await press("F2");
      await page.keyboard.type("calm");
      await press("Enter");
      await becomes(takes.names, ["calm", "Take 2"]);
      // It is saved as a scene, whatever the document is; the file is asked for until it is free.
      await takes.open("calm").focus();
      await press("Shift+F10", "ArrowDown", "Enter");
      const saving = hand.dialog("Save as");
      const file = saving.getByRole("textbox", { name: "File" });
      await becomes(() => file.inputValue(), "calm.xml");
      await file.fill("scene.xml");
      await press("Enter");
      await saving.getByText("already").waitFor();
      await file.fill("first.xml");
      await press("Enter");
      await becomes(() => saving.isVisible(), false);
      assert.equal(made.read("first.xml"), scene);
      assert.equal(made.read(), scene);
      assert.deepEqual([(await made.document()).file, (await made.document()).saved], ["scene.xml", false]);
      // Save is about the document again.
      await hand.button("Save").click();
      await becomes(made.read, high);
      assert.equal(existsSync(made.path("calm.xml")), false);
      // Delete, of the take that has the focus, and not of what is selected.
      await hand.choose("poke");
      await takes.open("calm").focus();
      await press("Delete");
      await becomes(takes.names, ["Take 2"]);
      await becomes(hand.focused, "Take 2");
      assert.equal(await made.text(), high);
      await press("Delete");
      await becomes(takes.names, []);
      assert.equal(await takes.list.isVisible(), false);
      await becomes(hand.focused, "Keep take");
    });
  });

  test("in the editor, a ghost is the take at the playhead, behind the scene", async () => {
    await editing(scene, { height: 700 }, async (hand) => {
      const { page, command: made } = hand;
      const takes = new TakesPanel(hand);
      await hand.settled();
      await takes.keep();
      await made.operate({ op: "set", path: "poke.magnitude", value: "-3000" }, { op: "set", path: "poke.center", value: "-1 0 2" });
      await hand.goTo(12);
      await hand.settled();
      await page.waitForFunction(() => { const { scene } = window.pliant.edit; return scene.solved.size === 24 && scene.readyNow.length === 1 && scene.readyNow[0][1] === 24; });
      await page.evaluate(() => window.pliant.edit.editor.viewer.redraw());
      await takes.picture("without");
      const there = await hand.shown("sheet");
      await takes.ghost("Take 1").click();
      assert.deepEqual(await takes.pressed(), [true]);
      await takes.drawn([1], 12);
      const [ghost] = await takes.shown();
      assert.deepEqual(ghost.positions, baked(made, scene, 12, "sheet"));
      // What is shown is the present one, and the ghost is drawn.
      assert.deepEqual(await hand.shown("sheet"), there);
      await hand.drawn();
      await takes.picture("ghost");
      const drawn = await takes.differing("ghost", "without");
      assert.ok(drawn > 10_000, `${drawn}`);
      await page.screenshot({ path: path.join(pictures, "edit-ghost.png") });
      // It follows the playhead, also while it plays and the present one changes.
      for (const frame of [20, 1, 7]) {
        await hand.goTo(frame);
        await takes.drawn([1], frame);
      }
      await made.operate({ op: "set", path: "poke.magnitude", value: "-5000" });
      await hand.settled();
      await takes.drawn([1], 7);
      assert.deepEqual((await takes.shown())[0].positions, baked(made, scene, 7, "sheet"));
      await made.post("undo");
      await hand.goTo(12);
      await hand.settled();
      // Off, it leaves no trace.
      await takes.ghost("Take 1").click();
      assert.deepEqual([await takes.pressed(), await takes.shown()], [[false], []]);
      await page.waitForFunction(() => { const { scene } = window.pliant.edit; return scene.solved.size === 24 && scene.readyNow.length === 1 && scene.readyNow[0][1] === 24 && scene.shownDetails?.frame === 12 && scene.shownDetails.revision === window.pliant.edit.session.revision; });
      await hand.drawn();
      await takes.picture("off");
      assert.ok((await takes.differing("off", "without")) < 50);
      // That of the present text is at the same place, and covers nothing.
      await takes.open("Take 1").click();
      await hand.says(scene);
      await hand.settled();
      await page.waitForFunction(() => { const { scene, session } = window.pliant.edit; return scene.readyNow.length === 1 && scene.readyNow[0][1] === 24 && scene.solved.size === 24 && scene.shownDetails?.isComplete && scene.shownDetails.revision === session.revision; });
      await hand.press("g"); // a ghost shows through what is before it, too
      await hand.drawn();
      await takes.picture("alone");
      await takes.ghost("Take 1").click();
      await takes.drawn([1], 12);
      await hand.drawn();
      await takes.picture("behind");
      const behind = await takes.differing("behind", "alone");
      assert.ok(behind < drawn / 20, `${behind} of ${drawn}`);
    });
  });

  test("in the editor, ghosts may have other surfaces, vertices and frames, and two are drawn", async () => {
    await editing(scene, { height: 700 }, async (hand) => {
      const { page, command: made, goTo } = hand;
      const takes = new TakesPanel(hand);
      await hand.settled();
      await takes.keep();
      await made.operate({ op: "set", path: "scene.end", value: "40" }, { op: "set", path: "sheet.columns", value: "31" }, { op: "duplicate", object: "sheet", name: "other" }, { op: "set", path: "other.translate", value: "0 1 0" });
      await hand.followed();
      await takes.keep();
      const larger = await made.text();
      await made.operate({ op: "set", path: "poke.magnitude", value: "1000" });
      await hand.followed();
      await takes.keep();
      await takes.open("Take 1").click();
      await hand.says(scene);
      await takes.ghost("Take 2").click();
      await takes.drawn([2], 1);
      await goTo(24);
      await takes.drawn([2], 24);
      for (const name of ["sheet", "other"]) assert.deepEqual((await takes.shown(name))[0].positions, baked(made, larger, 24, name));
      // A ghost that ends earlier is not there after its end.
      await takes.open("Take 2").click();
      await hand.says(larger);
      await hand.settled();
      await takes.ghost("Take 1").click();
      await takes.drawn([2, 1], 24);
      assert.deepEqual((await takes.shown())[1].positions, baked(made, scene, 24, "sheet"));
      await page.screenshot({ path: path.join(pictures, "edit-two-ghosts.png") });
      await goTo(33);
      await becomes(async () => (await takes.shown()).map(({ frame }) => frame), [33, null]);
      await goTo(5);
      await takes.drawn([2, 1], 5);
      // A third takes the place of the first.
      await takes.ghost("Take 3").click();
      assert.deepEqual(await takes.pressed(), [true, false, true]);
      await takes.drawn([1, 3], 5);
      // With its take it goes.
      await takes.open("Take 3").focus();
      await hand.press("Delete");
      await takes.drawn([1], 5);
    });
  });

  test("in the editor, a take whose files are gone is a message", async () => {
    const mesh = "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\nf 1/1 2/2 4/4 3/3\n";
    const begin = (made) => made.write(mesh, "mesh.obj");
    await editing(scene.replace("</surface>", '</surface><surface name="own"><mesh file="mesh.obj"/></surface>'), { begin }, async (hand) => {
      const { page, command: made } = hand;
      const takes = new TakesPanel(hand);
      await hand.settled();
      await takes.keep();
      await takes.ghost("Take 1").click();
      await takes.drawn([1], 1);
      await made.operate({ op: "delete", objects: ["own"] });
      await hand.settled();
      await takes.ghost("Take 1").click();
      made.write("", "mesh.obj");
      await takes.ghost("Take 1").click();
      const told = page.getByRole("complementary", { name: "Objects" }).getByRole("alert").filter({ hasText: "no faces" });
      await told.waitFor();
      assert.deepEqual(await takes.pressed(), [false]);
      const text = await made.text();
      await takes.open("Take 1").click();
      await told.waitFor();
      assert.equal(await made.text(), text);
      // The mesh is there again.
      made.write(mesh, "mesh.obj");
      await takes.ghost("Take 1").click();
      await takes.drawn([1], 1);
    });
  });

  test("in the editor, all pages have the same takes, also after a reload", async () => {
    await editing(scene, { height: 700 }, async (hand) => {
      const { page, command: made } = hand;
      const takes = new TakesPanel(hand);
      await hand.settled();
      await takes.keep();
      const other = await opened(made, made.url);
      const others = new TakesPanel(other);
      await becomes(others.names, ["Take 1"]);
      await others.keep();
      await becomes(takes.names, ["Take 1", "Take 2"]);
      // What is drawn is each page's own; what one does not want any more the other may keep.
      await takes.ghost("Take 1").click();
      await takes.drawn([1], 1);
      assert.deepEqual([await others.pressed(), await others.shown()], [[false, false], []]);
      await others.ghost("Take 1").click();
      await others.drawn([1], 1);
      await others.ghost("Take 1").click();
      await hand.goTo(9);
      await takes.drawn([1], 9);
      await others.open("Take 2").focus();
      await other.press("F2");
      await other.page.keyboard.type("theirs");
      await other.press("Enter");
      await becomes(takes.names, ["Take 1", "theirs"]);
      await page.reload();
      await becomes(takes.names, ["Take 1", "theirs"]);
      await until(() => takes.items.locator("img.shown").count().then((count) => count === 2), "the pictures");
      assert.deepEqual(await takes.pressed(), [false, false]);
      await takes.open("Take 1").focus();
      await hand.press("Delete");
      await becomes(others.names, ["theirs"]);
      assert.deepEqual(other.page.complaints, []);
      await other.page.close();
    });
  });

  test("in a narrow window, takes are in the panel of objects", async () => {
    await editing(scene, { width: 390, height: 844 }, async (hand) => {
      const { page } = hand;
      const takes = new TakesPanel(hand);
      await hand.settled();
      await hand.button("More").click();
      await hand.button("Keep take").click();
      await hand.button("Objects").click();
      await takes.open("Take 1").waitFor();
      await takes.ghost("Take 1").click();
      await takes.drawn([1], 1);
      await takes.open("Take 1").scrollIntoViewIfNeeded();
      await page.screenshot({ path: path.join(pictures, "edit-takes-narrow.png") });
      const widths = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
      assert.equal(widths[0], widths[1]);
      for (const each of [takes.open("Take 1"), takes.ghost("Take 1")]) {
        const { width, height } = await each.boundingBox();
        assert.ok(width >= 24 && height >= 24, `${width} x ${height}`);
      }
    });
  });
}
