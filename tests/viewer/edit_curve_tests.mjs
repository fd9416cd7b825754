// Tests of the curve panel of the page of `pliant edit`, and of keys that are copied; a part of edit_tests.mjs.

import assert from "node:assert/strict";
import path from "node:path";

import { becomes, until } from "./edit_command.mjs";

const curve = (attribute, keys) => `<animate attribute="${attribute}">${keys.map(([frame, value, more = ""]) => `<key frame="${frame}" value="${value}"${more}/>`).join("")}</animate>`;

export function editCurveTests({ test, scene, editing, pictures }) {
  /** The same with other curves of `bulge`. */
  const withCurves = (...curves) => scene.replace(/<animate[\s\S]*<\/animate>/, curves.join("\n    "));
  const plain = withCurves(curve("magnitude", [[2, 0], [8, 900], [16, 0], [20, 300]]));
  const vector = withCurves(curve("center", [[2, "-2 0 2"], [10, "0 1.5 0.6"], [18, "1 0 0"]]), curve("magnitude", [[4, 100], [12, 700]])).replace('name="bulge" center="-2 0 2"', 'name="bulge"');

  /** What one does with the panel. */
  class Panel {
    constructor(hand) {
      this.hand = hand;
      this.curves = hand.page.getByRole("region", { name: "Curves", exact: true });
      this.tools = hand.page.getByRole("toolbar", { name: "Keys" });
    }

    channel = (name) => this.curves.getByRole("listbox", { name: "Animated channels" }).getByRole("option", { name, exact: true });
    key = (name) => this.curves.getByRole("button", { name, exact: true });
    tool = (name, role = "button") => this.tools.getByRole(role, { name, exact: true });
    keys = async () => (await this.curves.locator("button[data-kind=key]").evaluateAll((all) => all.map((each) => each.getAttribute("aria-label")))).sort();
    chosen = async () => (await this.curves.locator("button[data-kind=key][aria-pressed=true]").evaluateAll((all) => all.map((each) => each.getAttribute("aria-label")))).sort();
    chooses = (names) => becomes(this.chosen, [...names].sort(), "chosen");

    /** Pixels for a frame and a value, by where two keys are. */
    async scale(channel, a, b) {
      const [from, to] = [await this.hand.middle(this.key(`${channel} key ${a[0]}`)), await this.hand.middle(this.key(`${channel} key ${b[0]}`))];
      return { frame: (to.x - from.x) / (b[0] - a[0]), value: (to.y - from.y) / (b[1] - a[1]) };
    }

    /** The place of a frame and a value in the window. */
    async spot(channel, a, b, frame, value) {
      const from = await this.hand.middle(this.key(`${channel} key ${a[0]}`));
      const scale = await this.scale(channel, a, b);
      return { x: from.x + (frame - a[0]) * scale.frame, y: from.y + (value - a[1]) * scale.value };
    }
  }

  /** The document's channel as the page has it: frames and values. */
  const keysOf = (hand, name) => hand.page.evaluate((path) => window.pliant.edit.scene.head.channels.find((each) => each.path === path).keys.map(({ at }) => at), name);
  const says = (hand, name, keys) => becomes(() => keysOf(hand, name), keys, name);
  /** Values of a curve at frames, from the plot's points. */
  const valuesOf = (hand, name, frames) => hand.page.evaluate(([channel, at]) => at.map((frame) => window.pliant.edit.editor.numbersOf(channel, frame)), [name, frames]);

  async function onCurves(text, body, options = {}) {
    await editing(text, { height: 760, ...options }, async (hand) => {
      await hand.button("Curves").click();
      await hand.settled();
      await body(hand, new Panel(hand));
      await hand.settled();
      await hand.undoAll(text);
    });
  }

  test("in the editor, keys of curves are chosen and moved", async () => {
    await onCurves(plain, async (hand, panel) => {
      const { page } = hand;
      const name = (frame) => `bulge.magnitude key ${frame}`;
      assert.deepEqual(await panel.keys(), [16, 2, 20, 8].map(name).sort());
      await panel.key(name(8)).click();
      await panel.chooses([name(8)]);
      assert.deepEqual([await panel.tool("Frame", "spinbutton").inputValue(), await panel.tool("Value", "spinbutton").inputValue()], ["8", "900"]);
      await panel.key(name(16)).click({ modifiers: ["Shift"] });
      await panel.chooses([name(8), name(16)]);
      await page.screenshot({ path: path.join(pictures, "edit-curves.png") });
      // Two by their frames and values: what is not chosen stays.
      const scale = await panel.scale("bulge.magnitude", [2, 0], [8, 900]);
      const [dx, dy] = [2.2 * scale.frame, 100 * scale.value];
      await hand.drag(panel.key(name(8)), dx, dy, { before: () => becomes(panel.keys, [2, 10, 18, 20].map(name).sort()) });
      await becomes(async () => (await keysOf(hand, "bulge.magnitude")).map(([frame]) => frame), [2, 10, 18, 20]);
      await panel.chooses([name(10), name(18)]);
      const moved = await keysOf(hand, "bulge.magnitude");
      assert.ok(Math.abs(moved[1][1] - 1000) < 15 && Math.abs(moved[2][1] - 100) < 15, JSON.stringify(moved));
      // No more digits than a pixel can show, and one.
      for (const [, value] of moved.slice(1, 3)) assert.ok(String(value).replace(/^-|\.|0*$/g, "").length <= 5, String(value));
      await hand.undo(plain);
      await panel.chooses([]);
      // Shift: along the axis that moved more. Escape: back.
      await panel.key(name(8)).click();
      await hand.drag(panel.key(name(8)), 3 * scale.frame, 12, { held: ["Shift"], before: () => becomes(panel.keys, [2, 11, 16, 20].map(name).sort()) });
      await says(hand, "bulge.magnitude", [[2, 0], [11, 900], [16, 0], [20, 300]]);
      await hand.undo(plain);
      await panel.key(name(8)).click();
      await hand.drag(panel.key(name(8)), 3 * scale.frame, 12, { before: () => hand.press("Escape") });
      await hand.says(plain);
      assert.equal((await hand.command.document()).redo !== "", true);
      await panel.chooses([name(8)]);
      // Ctrl: off whole frames, also while the pointer rests.
      await hand.drag(panel.key(name(8)), 0.4 * scale.frame, 0, {
        before: async () => {
          await page.keyboard.down("Control");
          await until(async () => (await panel.keys()).some((each) => /key 8\.\d/.test(each)), "off whole frames");
          await page.keyboard.up("Control");
          await becomes(panel.keys, [2, 8, 16, 20].map(name).sort());
        },
      });
      await hand.says(plain);
      await hand.settled();
      await hand.drag(panel.key(name(8)), 0.4 * scale.frame, 0, { held: ["Control"], before: () => until(async () => (await panel.keys()).some((each) => /key 8\.\d/.test(each)), "off whole frames") });
      await until(async () => !Number.isInteger((await keysOf(hand, "bulge.magnitude"))[1][0]), "off whole frames");
      await hand.settled();
      // It stays there when it is pulled up, not quite straight.
      const [, [between]] = await keysOf(hand, "bulge.magnitude");
      const text = await hand.command.text();
      await hand.drag(panel.key(name(between)), 1, 20);
      await until(async () => (await keysOf(hand, "bulge.magnitude"))[1][1] < 900, "lower");
      assert.equal((await keysOf(hand, "bulge.magnitude"))[1][0], between);
      await hand.undo(text);
      await hand.undo(plain);
      // Two on a frame are refused; ahead of that they are marked.
      await panel.key(name(8)).click();
      await hand.drag(panel.key(name(8)), 8 * scale.frame, 0, {
        before: async () => {
          await hand.alert("frame 16").waitFor();
          await becomes(() => panel.curves.locator("button[data-clash]").count(), 2);
        },
      });
      await becomes(() => panel.curves.locator("button[data-clash]").count(), 0);
      await hand.says(plain);
      await panel.chooses([name(8)]);
      // Fields.
      const frame = panel.tool("Frame", "spinbutton");
      await frame.fill("6*2");
      await hand.press("Enter");
      await says(hand, "bulge.magnitude", [[2, 0], [12, 900], [16, 0], [20, 300]]);
      await panel.chooses([name(12)]);
      const value = panel.tool("Value", "spinbutton");
      await value.fill("1000/4");
      await hand.press("Enter");
      await says(hand, "bulge.magnitude", [[2, 0], [12, 250], [16, 0], [20, 300]]);
      await value.fill("much");
      await hand.press("Enter");
      await becomes(() => value.getAttribute("aria-invalid"), "true");
      await hand.press("Escape");
      // Of several, whichever was chosen first.
      await hand.settled();
      await panel.key(name(20)).click();
      await panel.key(name(16)).click({ modifiers: ["Shift"] });
      await frame.focus();
      await hand.press("ArrowUp");
      await says(hand, "bulge.magnitude", [[2, 0], [12, 250], [17, 0], [21, 300]]);
      await panel.chooses([name(17), name(21)]);
      await hand.press("ArrowDown");
      await says(hand, "bulge.magnitude", [[2, 0], [12, 250], [16, 0], [20, 300]]);
      // Arrow keys, and Delete.
      await hand.settled();
      await panel.key(name(12)).focus();
      await hand.press("ArrowLeft", "ArrowUp");
      await until(async () => { const [, [at, to]] = await keysOf(hand, "bulge.magnitude"); return at === 11 && to > 250; }, "arrow keys");
      await panel.chooses([name(11)]);
      assert.equal(await hand.focused(), name(11));
      await hand.press("Delete");
      await becomes(async () => (await keysOf(hand, "bulge.magnitude")).map(([at]) => at), [2, 16, 20]);
    });
  });

  test("in the editor, a box chooses keys, scales them, and does not act on others", async () => {
    await onCurves(plain, async (hand, panel) => {
      const { page } = hand;
      const name = (frame) => `bulge.magnitude key ${frame}`;
      const spot = (frame, value) => panel.spot("bulge.magnitude", [2, 0], [8, 900], frame, value);
      const box = async (from, to, held = []) => {
        const [a, b] = [await spot(...from), await spot(...to)];
        await page.mouse.move(a.x, a.y);
        for (const key of held) await page.keyboard.down(key);
        await page.mouse.down();
        await page.mouse.move((a.x + b.x) / 2, (a.y + b.y) / 2);
        await page.mouse.move(b.x, b.y);
        await page.mouse.up();
        for (const key of held) await page.keyboard.up(key);
      };
      // The panel has just been opened.
      await hand.press("Control+a");
      await panel.chooses([2, 8, 16, 20].map(name));
      await box([5, 950], [17, -40]);
      await panel.chooses([name(8), name(16)]);
      await box([19, 400], [21, 200], ["Shift"]);
      await panel.chooses([name(8), name(16), name(20)]);
      await box([9, 500], [10, 450]);
      await panel.chooses([]);
      await box([7, 950], [21, -40]);
      await panel.chooses([name(8), name(16), name(20)]);
      await page.screenshot({ path: path.join(pictures, "edit-scale-box.png") });
      const scale = await panel.scale("bulge.magnitude", [2, 0], [8, 900]);
      await hand.drag(hand.button("Scale keys right"), -6 * scale.frame, 0, { before: () => panel.chooses([8, 12, 14].map(name)) });
      await says(hand, "bulge.magnitude", [[2, 0], [8, 900], [12, 0], [14, 300]]);
      await panel.chooses([8, 12, 14].map(name));
      await hand.undo(plain);
      await panel.chooses([name(8)]);
      await box([7, 950], [21, -40]);
      await hand.drag(hand.button("Scale keys top"), 0, -450 * Math.abs(scale.value));
      await until(async () => Math.abs((await keysOf(hand, "bulge.magnitude"))[1][1] - 1350) < 20, "scaled");
      const [first, high, low, middle] = await keysOf(hand, "bulge.magnitude");
      assert.deepEqual([first, low], [[2, 0], [16, 0]]);
      assert.ok(Math.abs(middle[1] - high[1] / 3) < 0.1);
      assert.match(`${high[1]} ${middle[1]}`, /^\d+(\.\d)? \d+(\.\d)?$/);
      await hand.undo(plain);
      // Everything, and nothing.
      await panel.key(name(8)).click();
      await hand.press("Control+a");
      await panel.chooses([2, 8, 16, 20].map(name));
      const away = await spot(13, 800);
      await page.mouse.click(away.x, away.y);
      await panel.chooses([]);
    });
  });

  test("in the editor, a double click adds a key and the curve stays", async () => {
    await onCurves(plain, async (hand, panel) => {
      const { page } = hand;
      const frames = Array.from({ length: 24 }, (_, k) => k + 1);
      const before = await valuesOf(hand, "bulge.magnitude", frames);
      const [value] = before[4];
      const { x, y } = await panel.spot("bulge.magnitude", [2, 0], [8, 900], 5, value);
      await page.mouse.dblclick(x, y);
      await panel.chooses(["bulge.magnitude key 5"]);
      await becomes(async () => (await keysOf(hand, "bulge.magnitude")).map(([frame]) => frame), [2, 5, 8, 16, 20]);
      const after = await valuesOf(hand, "bulge.magnitude", frames);
      after.forEach(([each], k) => assert.ok(Math.abs(each - before[k][0]) <= 1e-9 * 900, `frame ${k + 1}: ${each}, it was ${before[k][0]}`));
    });
  });

  test("in the editor, handles turn tangents", async () => {
    await onCurves(plain, async (hand, panel) => {
      const handle = (side) => panel.key(`bulge.magnitude key 8 ${side}`);
      const slopes = () => hand.page.evaluate(() => {
        const { handles } = window.pliant.edit.scene.head.channels.find((each) => each.path === "bulge.magnitude");
        return Object.fromEntries(handles.filter(({ key }) => key[0] === 8).map(({ key, tip, side }) => [side, (tip[1] - key[1]) / (tip[0] - key[0])]));
      });
      // Those of what is not chosen are not in the way.
      assert.equal(await handle("out").evaluate((each) => getComputedStyle(each).pointerEvents), "none");
      await panel.key("bulge.magnitude key 8").click();
      await becomes(() => handle("out").evaluate((each) => getComputedStyle(each).pointerEvents), "auto");
      assert.equal(await panel.tool("Tangent", "combobox").inputValue(), "auto");
      await hand.drag(handle("out"), 4, 30);
      // Both are as short as a pixel needs, a tenth, over more than a frame, and still in one line.
      await until(async () => { const { in: before, out } = await slopes(); return out < -1 && Math.abs(before - out) <= 0.05; }, "joined tangents turn together");
      for (const side of ["in", "out"]) assert.match(await hand.command.text(), new RegExp(`frame="8"[^>]* ${side}Handle="\\S+ -?\\d+(\\.\\d)?"`));
      assert.equal(await hand.pressed(panel.tool("Break")), "false");
      await hand.settled();
      const joined = await slopes();
      const parting = panel.tool("Break");
      await parting.click();
      await becomes(() => hand.pressed(parting), "true");
      await hand.drag(handle("in"), 2, -25);
      await until(async () => Math.abs((await slopes()).in - joined.in) > 1, "a broken tangent turns");
      assert.ok(Math.abs((await slopes()).out - joined.out) < 1e-9 * Math.abs(joined.out));
      await hand.settled();
      await parting.click();
      await until(async () => { const { in: before, out } = await slopes(); return Math.abs(before - out) < 1e-6 * Math.abs(out); }, "joined again");
      await becomes(() => hand.pressed(parting), "false");
      await panel.tool("Tangent", "combobox").selectOption("linear");
      await until(async () => /frame="8"[^>]*tangent="linear"/.test(await hand.command.text()), "a word");
      await hand.settled();
      // Words of one side, of a menu.
      await handle("out").click({ button: "right" });
      await hand.entry("flat").click();
      await until(async () => (await slopes()).out === 0, "one side");
      await becomes(() => panel.tool("Tangent", "combobox").inputValue(), "");
      await hand.settled();
      await panel.tool("Interpolation", "combobox").selectOption("step");
      await until(async () => /frame="8"[^>]*interpolation="step"/.test(await hand.command.text()), "interpolation");
      await hand.settled();
      await panel.tool("After", "combobox").selectOption("linear");
      await until(async () => /<animate attribute="magnitude" after="linear"|after="linear"/.test(await hand.command.text()), "after");
      await becomes(() => panel.tool("After", "combobox").inputValue(), "linear");
      await hand.settled();
      await panel.tool("After", "combobox").selectOption("slope");
      await becomes(() => panel.tool("After", "combobox").inputValue(), "slope 0");
    });
  });

  test("in the editor, components of vectors have keys of their own", async () => {
    await onCurves(vector, async (hand, panel) => {
      const name = (part, frame) => `bulge.center ${part} key ${frame}`;
      await panel.channel("bulge.center").click();
      assert.deepEqual(await panel.keys(), ["x", "y", "z"].flatMap((part) => [10, 18, 2].map((frame) => name(part, frame))).sort());
      // One is on the other.
      for (const part of ["y", "z"]) {
        await panel.key(name(part, 18)).click();
        await panel.chooses([name(part, 18)]);
      }
      await panel.key(name("y", 10)).click();
      await hand.drag(panel.key(name("y", 10)), 0, -20);
      await until(async () => (await keysOf(hand, "bulge.center"))[1][2] > 1.5, "one component");
      const [, [frame, x, , z]] = await keysOf(hand, "bulge.center");
      assert.deepEqual([frame, x, z], [10, 0, 0.6]);
      await panel.chooses([name("y", 10)]);
      assert.equal(await panel.tool("Value", "spinbutton").inputValue(), String((await keysOf(hand, "bulge.center"))[1][2]));
      // Its frame is that of all.
      await panel.tool("Frame", "spinbutton").fill("12");
      await hand.press("Enter");
      await becomes(panel.keys, ["x", "y", "z"].flatMap((part) => [12, 18, 2].map((each) => name(part, each))).sort());
      await panel.chooses([name("y", 12)]);
      // The time of a handle is that of all as well; their slopes are their own.
      await hand.settled();
      const slopes = async () => {
        const handles = await hand.page.evaluate(() => window.pliant.edit.scene.head.channels.find((each) => each.path === "bulge.center").handles.filter(({ key }) => key[0] === 12));
        return handles.map(({ key, tip }) => [1, 2, 3].map((k) => (tip[k] - key[k]) / (tip[0] - key[0])));
      };
      const before = await slopes();
      assert.equal(before.length, 2);
      await panel.key(name("x", 12)).click();
      await hand.drag(panel.key(`${name("x", 12)} out`), 30, 20);
      await until(async () => Math.abs((await slopes())[1][0] - before[1][0]) > 1e-3, "turned");
      (await slopes()).forEach((each, side) => [1, 2].forEach((part) => assert.ok(Math.abs(each[part] - before[side][part]) < 1e-9, `${side} ${part}: ${each}, it was ${before[side]}`)));
      await hand.settled();
      // Tangents stay broken while others are shown.
      await panel.tool("Break").click();
      await becomes(() => hand.pressed(panel.tool("Break")), "true");
      await panel.channel("bulge.magnitude").click();
      await becomes(async () => (await panel.keys()).length, 2);
      await panel.channel("bulge.center").click();
      await panel.key(name("x", 12)).click();
      await becomes(() => hand.pressed(panel.tool("Break")), "true");
      // Two channels.
      await panel.channel("bulge.magnitude").click({ modifiers: ["Control"] });
      await becomes(async () => (await panel.keys()).length, 11);
      // A finger adds a key to the curve that it is at.
      const { x: left, y: over } = await panel.spot("bulge.magnitude", [4, 100], [12, 700], 8, 400);
      for (let k = 0; k < 2; ++k) await hand.page.touchscreen.tap(left, over);
      await panel.chooses(["bulge.magnitude key 8"]);
    }, { hasTouch: true });
  });

  test("in the editor, curves are simplified and baked", async () => {
    const other = `<fragment><point name="far" center="3 0 3">${curve("magnitude", [[3, 0], [30, 9]])}</point></fragment>`;
    await onCurves(plain.replace("</scene>", '<include file="part.xml"/></scene>'), async (hand, panel) => {
      // What stands in another file is left out.
      const baking = hand.dialog("Bake keys");
      await panel.channel("far.magnitude").click();
      await panel.tool("Bake…").click();
      await baking.getByRole("alert").filter({ hasText: "another file" }).waitFor();
      await hand.press("Enter", "Escape");
      await panel.channel("bulge.magnitude").click({ modifiers: ["Control"] });
      await panel.tool("Bake…").click();
      assert.deepEqual([await baking.locator("p").first().textContent(), await baking.getByLabel("Last frame").inputValue()], ["bulge.magnitude", "20"]);
      await baking.getByLabel("First frame").fill("2");
      await baking.getByLabel("Last frame").fill("20");
      await baking.getByLabel("Step").fill("0");
      await hand.press("Enter");
      await baking.getByRole("alert").filter({ hasText: "step" }).waitFor();
      await baking.getByLabel("Step").fill("1");
      await hand.press("Enter");
      await becomes(async () => (await keysOf(hand, "bulge.magnitude")).length, 19);
      await hand.settled();
      const baked = await hand.command.text();
      await panel.tool("Simplify…").click();
      const simplifying = hand.dialog("Simplify");
      const tolerance = simplifying.getByRole("spinbutton", { name: "Tolerance" });
      // It shows what it does, and Escape takes that back.
      await tolerance.fill("100");
      await until(async () => /^\d+ of 19 keys$/.test(await simplifying.getByRole("status").textContent()) && (await keysOf(hand, "bulge.magnitude")).length < 12, "fewer keys");
      const few = (await keysOf(hand, "bulge.magnitude")).length;
      await tolerance.fill("0");
      await until(async () => (await keysOf(hand, "bulge.magnitude")).length > few, "more keys");
      await hand.press("Escape");
      await hand.says(baked);
      await hand.settled();
      await panel.tool("Simplify…").click();
      // After what is refused, and what is no number, it goes on.
      for (const [wrong, reason] of [["-1", "at least 0"], ["abc", "not a number"]]) {
        await tolerance.fill("100");
        await becomes(async () => (await keysOf(hand, "bulge.magnitude")).length, few);
        await tolerance.fill(wrong);
        await hand.press("Enter");
        await simplifying.getByRole("alert").filter({ hasText: reason }).waitFor();
        await hand.says(baked);
        await hand.press("Enter");
        assert.equal(await simplifying.isVisible(), true);
      }
      await tolerance.fill("100");
      await becomes(async () => (await keysOf(hand, "bulge.magnitude")).length, few);
      await simplifying.getByRole("button", { name: "Simplify" }).click();
      await becomes(() => simplifying.isVisible(), false);
      assert.match((await hand.command.document()).undo, /simplify/);
    }, { begin: (made) => made.write(other, "part.xml") });
  });

  test("in the editor, the curves are panned, zoomed and fitted", async () => {
    await onCurves(plain, async (hand, panel) => {
      const { page } = hand;
      const name = (frame) => `bulge.magnitude key ${frame}`;
      const place = async (frame) => { const { x, y } = await hand.middle(panel.key(name(frame))); return [Math.round(x), Math.round(y)]; };
      const [a, b] = [await place(2), await place(20)];
      await page.mouse.move(a[0] + 40, a[1] - 40);
      await page.mouse.wheel(0, -200);
      await until(async () => (await place(8))[0] - (await place(2))[0] > 1.2 * ((b[0] - a[0]) / 18) * 6, "zoomed");
      assert.equal((await hand.command.document()).undo, "");
      const [from, at] = [await place(2), await place(8)];
      await page.mouse.move(from[0] + 60, from[1] - 30);
      await page.mouse.down({ button: "middle" });
      await page.mouse.move(from[0] + 90, from[1] - 20, { steps: 3 });
      await page.mouse.up({ button: "middle" });
      await becomes(() => place(8), [at[0] + 30, at[1] + 10]);
      await panel.tool("Fit").click();
      await becomes(async () => [await place(2), await place(20)], [a, b]);
      // To what is chosen.
      await panel.key(name(8)).click();
      await panel.key(name(16)).click({ modifiers: ["Shift"] });
      await panel.tool("Fit").click();
      await until(async () => (await place(16))[0] - (await place(8))[0] > 0.6 * (b[0] - a[0]), "fitted");
      await page.getByRole("slider", { name: "Frame" }).focus();
    });
  });

  test("in the editor, keys are copied between channels of one dimension", async () => {
    const followed = vector.replace(/(<line name="crease") from="-2 0 -3"([^>]*)\/>/, `$1$2><path attribute="from"><waypoint at="-2 0 -3"/><waypoint at="-1 0 -2"/><waypoint at="0 0 -3"/>${curve("progress", [[2, 0], [6, 1, ' in="0.2"']]).replace(">", ' tangent="flat" interpolation="linear">')}</path></line>`);
    await onCurves(followed, async (hand, panel) => {
      const { page } = hand;
      // With all that the file says of them, in keys or for all of a curve, also where that is in a path.
      await panel.channel("crease.from.progress").click();
      await panel.key("crease.from.progress key 2").click();
      await hand.press("Control+a", "Control+c");
      await hand.command.operate({ op: "animate", channels: ["poke.magnitude"], frame: 1 });
      await hand.settled();
      await panel.channel("poke.magnitude").click();
      await hand.goTo(10);
      await panel.curves.getByRole("listbox").focus();
      await hand.press("Control+v");
      await says(hand, "poke.magnitude", [[1, 3000], [10, 0], [14, 1]]);
      const [text] = (await hand.command.text()).match(/<point name="poke"[^]*?<\/point>/);
      for (const [frame, ...words] of [[10, 'value="0"', 'tangent="flat"', 'interpolation="linear"'], [14, 'value="1"', 'in="0.2"', 'out="flat"']]) {
        const key = text.match(new RegExp(`<key frame="${frame}" [^>]*>`))[0];
        assert.deepEqual(words.filter((each) => !key.includes(each)), [], key);
      }
      await hand.undoAll(followed);
      await hand.settled();
      await hand.command.operate({ op: "animate", channels: ["poke.magnitude"], frame: 1 });
      await hand.command.operate({ op: "setTangent", keys: [{ channel: "bulge.magnitude", frames: [4] }], tangent: "linear" });
      await hand.settled();
      await panel.channel("bulge.magnitude").click();
      await panel.key("bulge.magnitude key 4").click();
      await hand.press("Control+a");
      await panel.chooses(["bulge.magnitude key 4", "bulge.magnitude key 12"]);
      await hand.press("Control+c");
      await panel.channel("poke.magnitude").click();
      await hand.goTo(10);
      await panel.curves.getByRole("listbox").focus();
      await hand.press("Control+v");
      await says(hand, "poke.magnitude", [[1, 3000], [10, 100], [18, 700]]);
      assert.match(await hand.command.text(), /frame="10" value="100" tangent="linear"/);
      // Those of a vector have no place there.
      await panel.channel("bulge.center").click();
      await panel.key("bulge.center x key 2").click();
      await hand.press("Control+c");
      await panel.channel("poke.magnitude").click();
      const before = await hand.command.text();
      await hand.press("Control+v");
      await hand.alert("no channels").waitFor();
      assert.equal(await hand.command.text(), before);
      // By the marks of the timeline, to the same attribute of what is selected.
      await page.getByRole("alert").getByRole("button", { name: "Dismiss" }).click();
      await hand.choose("bulge");
      await hand.button("Keys at 12").click();
      await hand.press("Control+c");
      await hand.choose("crease");
      await hand.goTo(6);
      await hand.button("Frame").focus();
      await hand.press("Control+v");
      await until(async () => /<line name="crease"[\s\S]*<key frame="6" value="700"/.test(await hand.command.text()), "pasted to a constant");
    });
  });

  test("in the editor, curves with many keys are drawn without buttons", async () => {
    const count = 1000;
    const many = withCurves(curve("magnitude", Array.from({ length: count }, (_, k) => [1 + k / 40, Math.round(500 * Math.sin(k / 30))])));
    await onCurves(many, async (hand, panel) => {
      const { page } = hand;
      assert.deepEqual(await panel.keys(), []);
      const plot = page.getByRole("img", { name: /bulge\.magnitude, 1000 keys/ });
      const { x, y, width, height } = await plot.boundingBox();
      // A key that is drawn only is chosen and moved too.
      await page.mouse.move(x + width / 2, y + height / 3);
      await page.keyboard.down("Control");
      for (let k = 0; k < 2; ++k) await page.mouse.wheel(0, -400);
      await until(async () => (await panel.keys()).length > 0, "buttons of hundreds");
      const handles = await panel.curves.locator("button[data-kind=handle]").count();
      assert.ok(handles > 200 && handles < 1000, `${handles} handles`);
      for (let k = 0; k < 4; ++k) await page.mouse.wheel(0, -400);
      await page.keyboard.up("Control");
      await until(async () => { const { length } = await panel.keys(); return length > 0 && length < 50; }, "buttons when one is near");
      // All of them together, to numbers that are as short as if it were one.
      const [name] = await panel.keys();
      await panel.key(name).click();
      await hand.press("Control+a");
      await hand.drag(panel.key(name), 0, -23);
      await until(async () => (await hand.command.text()) !== many, "moved");
      for (const [, value] of await keysOf(hand, "bulge.magnitude")) assert.match(String(value), /^-?\d+(\.\d)?$/);
      await hand.undo(many);
      await hand.settled();
      await panel.tool("Fit").click();
      await becomes(panel.keys, []);
      await page.mouse.click(x + width / 2, y + 4);
      await hand.press("Control+a", "Delete");
      await until(async () => /<radial [^>]*magnitude="0"/.test(await hand.command.text()), "all are deleted: a constant");
    });
  });
}
