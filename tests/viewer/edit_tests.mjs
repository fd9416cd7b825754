// Tests of the page of `pliant edit`; a part of viewer_test.mjs. What needs no page is in tests/cli/edit_test.py.

import assert from "node:assert/strict";
import path from "node:path";

import { EditCommand, Hand, becomes, until } from "./edit_command.mjs";
import { editCurveTests } from "./edit_curve_tests.mjs";
import { editFileTests } from "./edit_file_tests.mjs";
import { editRecordTests } from "./edit_record_tests.mjs";
import { editTakesTests } from "./edit_takes_tests.mjs";
import { editTouchTests } from "./edit_touch_tests.mjs";
import { editViewTests } from "./edit_view_tests.mjs";

export const scene = `<?xml version="1.0" encoding="UTF-8"?>
<!-- für <alle> -->
<scene version="1" fps="24" start="1" end="24">
  <define name="push" value="300"/>
  <surface name="sheet">
    <grid columns="21" rows="21" width="8" depth="8"/>
    <material  density="40"   damping='20'/>
    <solver dt="0.01"/>
  </surface>
  <group name="fingers" center="0 0 0" deformationRadius="3">
    <point name="prod" center="-1 0 -1" direction="0 1 0" forceRadius="1" magnitude="$push"/>
  </group>
  <point name="poke" center="1 0 1.5" direction="0 1 0" deformationRadius="2.5" forceRadius="1.25" magnitude="3000"/>
  <radial name="bulge" center="-2 0 2" deformationRadius="2" forceRadius="1">
    <animate attribute="magnitude"><key frame="1" value="0"/><key frame="8" value="900"/><key frame="16" value="0"/></animate>
  </radial>
  <line name="crease" from="-2 0 -3" to="2 0 -3" direction="0 -1 0" deformationRadius="1.5" forceRadius="0.5" magnitude="500"/>
  <collider name="ball"><sphere radius="0.5"/><transform translate="0 4 0"/></collider>
</scene>
`;

export function editTests(tools) {
  const { test, run, inFolder, open, readNpy, pictures, pliant, withPage } = tools;
  let count = 0;
  const command = () => new EditCommand(pliant, inFolder(`edit-${++count}`));

  /** Opens the page of a scene, and closes it: nothing was told in its console. `begin`: ahead of the command. */
  async function editing(text, options, body) {
    const { words = ["scene.xml"], begin = () => {}, ...others } = options;
    const made = command();
    if (text !== null) made.write(text);
    await begin(made);
    await withPage(await made.start(...words), { width: 1000, height: 600, ...others }, (page) => body(new Hand(page, made)));
    await made.end();
  }

  // Opening a page takes longer than most of what is done with it.
  let kept = null;

  /** The same of the page of `scene` that others have had before, with no step, nothing selected, and at the first frame. */
  async function onScene(body) {
    if (!kept || kept.page.isClosed()) {
      const made = command();
      made.write(scene);
      kept = await opened(made, await made.start("scene.xml"));
    }
    await body(kept);
    const { command: made, page } = kept;
    while ((await made.document()).undo !== "") await made.post("undo");
    await kept.says(scene);
    if (made.read() !== scene) await made.post("save");
    await kept.followed();
    await page.evaluate(() => {
      document.activeElement.blur();
      window.pliant.edit.editor.selection.set([]);
      window.pliant.playback.goTo(1);
      window.pliant.stage.look();
    });
    assert.deepEqual(page.complaints, []);
  }

  /** A page that must not be silent in the end. */
  async function opened(made, url) {
    const page = await open(url, { width: 1000, height: 600 });
    return new Hand(page, made);
  }

  /** Positions of a surface by frames, as a bake of the text has them, in single precision. */
  function bakedFrames(made, text, surface) {
    made.write(text, "baked.xml");
    run("bake", made.path("baked.xml"), "-o", made.path("baked.npy"), "--surface", surface, "--quiet");
    const { shape, numbers } = readNpy(made.path("baked.npy"));
    return (frame) => [...Float32Array.from(numbers.subarray((frame - 1) * shape[1] * 3, frame * shape[1] * 3))];
  }

  const baked = (made, text, frame, surface) => bakedFrames(made, text, surface)(frame);

  const shared = { ...tools, scene, editing, onScene, opened, baked, bakedFrames, command };
  editViewTests(shared);
  editCurveTests(shared);
  editFileTests(shared);
  editRecordTests(shared);
  editTouchTests(shared);
  editTakesTests(shared);

  // Objects

  test("in the editor, the tree selects, renames, copies and deletes", async () => {
    await onScene(async (hand) => {
      const { page, item, row, press, tree, selected } = hand;
      assert.deepEqual(await tree.getByRole("treeitem").evaluateAll((all) => all.map((each) => each.getAttribute("aria-label"))), ["sheet", "fingers", "prod", "poke", "bulge", "crease", "ball"]);
      assert.equal(await item("fingers").getByRole("treeitem", { name: "prod" }).count(), 1);
      await row("poke").click();
      await row("crease").click({ modifiers: ["Control"] });
      assert.deepEqual(await selected(), ["poke", "crease"]);
      await row("poke").click({ modifiers: ["Control"] });
      assert.deepEqual(await selected(), ["crease"]);
      await row("poke").click();
      await press("ArrowUp", "ArrowUp");
      assert.deepEqual([await selected(), await hand.focused()], [["fingers"], "fingers"]);
      await press("ArrowLeft");
      assert.equal(await item("prod").isVisible(), false);
      await press("ArrowDown");
      assert.deepEqual(await selected(), ["poke"]);
      await press("ArrowUp", "ArrowRight", "ArrowRight");
      assert.deepEqual(await selected(), ["prod"]);
      // Names.
      await row("poke").click();
      await press("F2");
      await page.keyboard.type("jab");
      await press("Enter");
      await hand.says(scene.replace('"poke"', '"jab"'));
      await becomes(hand.focused, "jab");
      assert.deepEqual(await selected(), ["jab"]);
      await press("F2");
      await page.keyboard.type("no");
      await press("Escape");
      await press("F2");
      await page.keyboard.type("crease");
      await press("Enter");
      const refusal = page.getByRole("complementary", { name: "Objects" }).getByRole("alert").filter({ hasText: "crease" });
      await refusal.waitFor();
      await hand.says(scene.replace('"poke"', '"jab"'));
      // What is done elsewhere ends what was said of it.
      await hand.undo(scene);
      await becomes(() => refusal.isVisible(), false);
      // Keys are about what has the focus, not about what was clicked last; and a new name takes the tab stop along.
      await item("bulge").focus();
      await press("F2");
      assert.equal(await hand.focused(), "New name of bulge");
      await press("Escape", "Enter");
      assert.deepEqual(await selected(), ["bulge"]);
      await hand.type("name", "boss", "textbox");
      await becomes(selected, ["boss"]);
      assert.equal(await item("boss").getAttribute("tabindex"), "0");
      await item("boss").focus();
      await hand.undo(scene);
      // Copies.
      await row("poke").click();
      await press("Control+d");
      await becomes(selected, ["poke2"]);
      assert.match(await hand.command.text(), /<point name="poke2" center="1 0 1.5" direction="0 1 0" deformationRadius="2.5" forceRadius="1.25" magnitude="3000"\/>/);
      await press("Delete");
      await hand.says(scene);
      // One step for all that are selected.
      await row("crease").click();
      await row("bulge").click({ modifiers: ["Control"] });
      await press("Delete");
      await becomes(() => tree.getByRole("treeitem").count(), 5);
      await press("Control+z");
      await hand.says(scene);
      await hand.button("Undo").click();
      await until(async () => (await hand.command.document()).undo !== "delete", "Undo");
      await hand.followed();
      await hand.undoAll(scene);
      assert.equal(await hand.button("Undo").isDisabled(), true);
      // What was told of a scene that is not there any more is not shown of the next one.
      let answer;
      const asked = new Promise((resume) => {
        void page.route("**/scene?revision=*", async (route) => {
          const told = await route.fetch();
          await new Promise((go) => resume((answer = go)));
          await route.fulfill({ response: told });
        }, { times: 1 });
      });
      await row("sheet").click();
      await press("Delete");
      await asked;
      await hand.undo(scene);
      answer();
      await hand.settled();
      assert.deepEqual(await page.evaluate(() => window.pliant.edit.session.failures), []);
    });
  });

  test("in the editor, everything can be added by keyboard", async () => {
    const mesh = "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\nf 1/1 2/2 4/4 3/3\n";
    await onScene(async (hand) => {
      const { page, press, menu } = hand;
      hand.command.write(mesh, "one.obj");
      const kinds = ["Point", "Radial", "Line", "Uniform", "Vortex", "Noise", "Inertia", "Group", "Grid", "Mesh…"];
      await hand.button("Add").focus();
      await press("Enter");
      const labels = await menu.getByRole("menuitem").evaluateAll((all) => all.map((each) => each.getAttribute("aria-label")));
      assert.deepEqual(labels.slice(0, kinds.length), kinds);
      await page.screenshot({ path: path.join(pictures, "edit-add.png") });
      await press("Escape");
      assert.equal(await hand.focused(), "Add");
      for (const label of labels) {
        const before = await hand.selected();
        await hand.button("Add").focus();
        await press("Enter");
        for (let k = 0; (await hand.focused()) !== label; ++k) {
          assert.ok(k < labels.length, label);
          await press(label[0]);
        }
        await press("Enter");
        if (label === "Mesh…") {
          const dialog = hand.dialog("Add a mesh");
          await dialog.getByRole("textbox", { name: "Object" }).waitFor();
          // Keys do nothing behind it.
          const frame = await hand.frame();
          await dialog.getByRole("button", { name: "one.obj" }).focus();
          await press("ArrowRight", "c", "Enter");
          await becomes(() => dialog.isVisible(), false);
          assert.deepEqual([await hand.frame(), await page.getByRole("listbox", { name: "Animated channels" }).isVisible()], [frame, false]);
        }
        const [name] = await until(async () => { const names = await hand.selected(); return names.length === 1 && names[0] !== before[0] && names; }, label);
        assert.match(await hand.command.text(), new RegExp(`name="${name}"`), label);
        assert.match(await hand.command.text(), new RegExp(`<${label.toLowerCase().replace("…", "")}\\b`), label);
      }
      const { undo } = await hand.command.document();
      await press("Control+z");
      await until(async () => (await hand.command.document()).redo === undo, "one step for each");
    });
  });

  // Properties

  const roles = ({ type, words, name }) => {
    if (type === "boolean") return "checkbox";
    if (words || type === "one or four words") return "combobox";
    if (["integer", "rate", "vector"].includes(type) || type.includes("number")) return "spinbutton";
    return ["follow", "drivenBy"].includes(name) ? "combobox" : "textbox";
  };

  test("in the editor, each attribute of each object has its control", async () => {
    const more = scene.replace("</scene>", `<uniform name="wind"/><vortex name="swirl"/><noise name="gusts"/><inertia name="weight"/><pressure name="air"/>
      <collider name="rod"><capsule radius="0.1" length="1"/><transform translate="0 5 0"/></collider><collider name="brick"><box size="1 1 1"/><transform translate="0 9 0"/></collider>
      <collider name="ground"><plane/><transform translate="0 -9 0"/></collider></scene>`);
    await editing(more, {}, async (hand) => {
      const { elements } = await hand.command.get("format");
      const { objects } = await hand.command.get("objects");
      let controls = 0;
      for (const { name, kind, attributes } of objects) {
        if (kind === "scene") {
          assert.deepEqual(await hand.selected(), []);
        } else {
          await hand.row(name).click();
          await becomes(hand.selected, [name]);
        }
        const names = {};
        for (const role of ["spinbutton", "combobox", "checkbox", "textbox", "button"]) {
          names[role] = await hand.properties.getByRole(role).evaluateAll((all) => all.map((each) => each.getAttribute("aria-label") ?? ""));
        }
        for (const attribute of attributes) {
          const format = elements.find((each) => each.name === attribute.element).attributes.find((each) => each.name === attribute.name);
          const role = roles(format);
          const parts = format.type === "vector" ? ["x", "y", "z"].map((axis) => `${attribute.name} ${axis}`) : [attribute.name];
          const isAlone = attributes.filter((each) => each.name === attribute.name).length === 1;
          for (const part of parts) {
            // What several elements of an object have is told apart by what stands ahead of it.
            const fits = (label) => (isAlone ? label === part || (parts.length === 1 && label.startsWith(`${part} `)) : ` ${label}`.endsWith(` ${part}`));
            assert.ok(names[role].some(fits), `${name}: no ${role} ${part} among ${names[role].join(", ")}`);
            ++controls;
          }
          if (attribute.components > 0) assert.ok(names.button.some((label) => label.startsWith("Key ") && label.endsWith(attribute.name)), `${name}: no key of ${attribute.name}`);
        }
      }
      assert.ok(controls > 200, `${controls} controls`);
    });
  });

  test("in the editor, fields of every type change what they say", async () => {
    const other = '<fragment><point name="far" center="3 0 3" magnitude="$push"/></fragment>';
    const text = scene.replace("</scene>", '  <include file="part.xml"/>\n</scene>');
    await editing(text, { begin: (made) => made.write(other, "part.xml") }, async (hand) => {
      const { field, type, press, page } = hand;
      const changed = async (from, to, what) => {
        await hand.says(text.replace(from, to), what);
        await hand.undo(text);
      };
      await hand.choose("poke");
      await type("magnitude", "(1 + 2) * 500/2");
      await changed('magnitude="3000"/>\n  <radial', 'magnitude="750"/>\n  <radial', "arithmetic");
      await becomes(() => field("magnitude").inputValue(), "3000");
      // Keys that come before the answer.
      await field("magnitude").fill("8");
      await press("Enter", "Enter", "Control+z");
      await until(async () => (await hand.command.document()).redo !== "", "undo at once");
      await hand.says(text, "one step");
      await hand.followed();
      await field("center z").fill("-0.5");
      await press("Tab");
      await changed('"1 0 1.5"', '"1 0 -0.5"', "a field that is left");
      await field("falloff", "combobox").selectOption("smooth");
      await changed('magnitude="3000"/>\n  <radial', 'magnitude="3000" falloff="smooth"/>\n  <radial', "a word");
      await field("enabled", "checkbox").uncheck();
      await changed('magnitude="3000"/>\n  <radial', 'magnitude="3000" enabled="false"/>\n  <radial', "a boolean");
      // A group of attributes is folded by keys, which do not play.
      await hand.properties.locator("summary").first().focus();
      await press("Space");
      assert.deepEqual([await field("enabled", "checkbox").isVisible(), await hand.button("Play").isVisible()], [false, true]);
      await press("Space");
      await type("targets", "sheet", "textbox");
      await changed('magnitude="3000"/>\n  <radial', 'magnitude="3000" targets="sheet"/>\n  <radial', "names");
      await field("follow", "combobox").selectOption("sheet");
      await until(async () => (await hand.command.text()).includes('follow="sheet"'), "a surface");
      await hand.undo(text);
      await hand.choose("sheet");
      await field("columns").focus();
      await press("ArrowUp");
      await changed('columns="21"', 'columns="22"', "an integer");
      await hand.properties.getByRole("spinbutton", { name: "translate y" }).fill("0.25");
      await press("Enter");
      await until(async () => (await hand.command.text()).includes('translate="0 0.25 0"'), "an attribute of a part that was not there");
      await hand.undo(text);
      // The scene, if nothing is selected.
      await hand.view.focus();
      await hand.tree.click({ position: { x: 5, y: (await hand.tree.boundingBox()).height - 2 } });
      if ((await hand.selected()).length > 0) await hand.row((await hand.selected())[0]).click({ modifiers: ["Control"] });
      await becomes(hand.selected, []);
      await type("fps", "24000/1001");
      await changed('fps="24"', 'fps="24000/1001"', "a ratio");
      // What is written with a `$`, and what stands in another file.
      await hand.choose("prod");
      assert.equal(await field("magnitude").inputValue(), "300");
      assert.equal(await hand.properties.getByText("$push").isVisible(), true);
      assert.equal(await field("deformationRadius").isDisabled(), true, "its group has it");
      await hand.choose("far");
      assert.equal(await field("magnitude").isEditable(), false);
      assert.equal(await field("falloff", "combobox").isDisabled(), true);
      assert.equal(await hand.key("magnitude").isDisabled(), true);
      await hand.properties.getByText("part.xml").first().waitFor();
      assert.match(await hand.item("far").getAttribute("aria-description"), /part\.xml/);
      assert.equal(await hand.handle("Move far").getAttribute("aria-disabled"), "true");
      await hand.drag(hand.handle("Move far"), 30, 10);
      await press("Delete");
      await page.getByRole("alert").filter({ hasText: "part.xml" }).first().waitFor();
      await hand.says(text);
    });
  });

  test("in the editor, numbers step and scrub, each as one step that Escape takes back", async () => {
    await onScene(async (hand) => {
      const { field, page, press } = hand;
      // What is refused while a key is held is taken back as a whole, and the reason stays.
      await field("start").focus();
      await page.keyboard.down("Control");
      for (let k = 0; k < 3; ++k) await page.keyboard.down("ArrowUp");
      await page.keyboard.up("ArrowUp");
      await page.keyboard.up("Control");
      const refusal = hand.properties.getByRole("alert").filter({ hasText: "start" });
      await refusal.waitFor();
      await becomes(() => field("start").inputValue(), "1");
      await hand.settled();
      assert.deepEqual([await hand.command.text(), (await hand.command.document()).undo], [scene, ""]);
      assert.deepEqual([await refusal.isVisible(), await field("start").getAttribute("aria-invalid")], [true, "true"]);
      await press("Escape");
      assert.deepEqual([await refusal.isVisible(), await field("start").getAttribute("aria-invalid")], [false, null]);
      const of = (value) => scene.replace('magnitude="3000"/>\n  <radial', `magnitude="${value}"/>\n  <radial`);
      await hand.choose("poke");
      for (const [keys, value] of [["ArrowUp", 3030], ["ArrowDown", 2970], ["Shift+ArrowUp", 3003], ["Control+ArrowUp", 3300], ["Control+ArrowDown", 2700]]) {
        await field("magnitude").focus();
        await press(keys);
        await hand.says(of(value), keys);
        assert.equal(await field("magnitude").getAttribute("aria-valuenow"), String(value));
        await hand.undo(scene);
      }
      // A held key, and then the last step is still there to be made again.
      await field("magnitude").focus();
      for (let k = 0; k < 5; ++k) await page.keyboard.down("ArrowUp");
      await page.keyboard.up("ArrowUp");
      await hand.says(of(3150));
      await hand.undo(scene);
      const { redo } = await hand.command.document();
      assert.notEqual(redo, "");
      await field("magnitude").focus();
      for (let k = 0; k < 3; ++k) await page.keyboard.down("ArrowDown");
      await until(async () => (await hand.command.text()) !== scene, "a held key");
      await press("Escape");
      await page.keyboard.up("ArrowDown");
      await hand.says(scene);
      assert.equal((await hand.command.document()).redo, redo);
      await becomes(() => field("magnitude").inputValue(), "3000");
      // A scrub.
      await press("Tab");
      await hand.drag(field("magnitude"), 40, 0);
      await until(async () => (await hand.command.document()).undo !== "", "a scrub");
      await hand.settled();
      assert.match(await hand.command.text(), /name="poke".* magnitude="4[0-9]00"\/>/);
      assert.notEqual(await hand.focused(), "magnitude");
      await hand.undo(scene);
      const after = (await hand.command.document()).redo;
      await hand.drag(field("magnitude"), -40, 0, {
        before: async () => {
          await until(async () => (await hand.command.text()) !== scene, "a scrub that goes on");
          await press("Escape");
          await hand.says(scene);
        },
      });
      assert.deepEqual([(await hand.command.document()).redo, await hand.command.text()], [after, scene]);
      // A click sets the cursor; what is typed then has nothing to do with the page's keys.
      await field("magnitude").click();
      assert.equal(await hand.focused(), "magnitude");
      const frame = await hand.frame();
      await press("Control+a", "Home", "End", "ArrowRight", "Space", "i", "Delete", "Backspace", "Escape");
      assert.equal(await hand.frame(), frame);
      await hand.says(scene);
      assert.deepEqual(await hand.selected(), ["poke"]);
    });
  });

  test("in the editor, a refused value keeps the focus and is told beside it", async () => {
    await onScene(async (hand) => {
      const { field, press, page } = hand;
      const revision = await hand.revision();
      await hand.choose("poke");
      const alert = hand.properties.getByRole("alert");
      const places = () => page.evaluate(() => ["view", "timeline", "undo", "play"].map((id) => { const { x, y, width, height } = document.getElementById(id).getBoundingClientRect(); return [x, y, width, height]; }));
      const before = await places();
      for (const [text, word] of [["-1", "forceRadius"], ["1 +", "1 +"], ["many", "many"]]) {
        await hand.type("forceRadius", text);
        await alert.filter({ hasText: word }).waitFor();
        assert.equal(await hand.focused(), "forceRadius");
        assert.equal(await field("forceRadius").getAttribute("aria-invalid"), "true");
        assert.equal(await field("forceRadius").inputValue(), text);
        assert.deepEqual(await places(), before);
      }
      await page.screenshot({ path: path.join(pictures, "edit-refused.png") });
      await press("Escape");
      assert.equal(await field("forceRadius").inputValue(), "1.25");
      assert.equal(await field("forceRadius").getAttribute("aria-invalid"), null);
      assert.equal(await alert.isVisible(), false);
      assert.equal(await hand.revision(), revision);
      // A field that is left with one gives it back.
      await field("forceRadius").fill("-2");
      await press("Tab");
      await alert.filter({ hasText: "forceRadius" }).waitFor();
      await becomes(hand.focused, "forceRadius");
      await hand.type("forceRadius", "1");
      await hand.says(scene.replace('forceRadius="1.25"', 'forceRadius="1"'));
      await becomes(() => alert.isVisible(), false);
      // Once something else is shown, it is about no field of that.
      await field("forceRadius").fill("none");
      await hand.choose("bulge");
      await alert.filter({ hasText: "none" }).waitFor();
      assert.deepEqual([await hand.focused(), await field("forceRadius").inputValue(), await field("forceRadius").getAttribute("aria-invalid")], ["bulge", "1", null]);
      await hand.undo(scene);
      await becomes(() => alert.isVisible(), false);
    });
  });

  test("in the editor, what several have in common changes together", async () => {
    await onScene(async (hand) => {
      const { field } = hand;
      await hand.choose("poke", "crease");
      assert.equal(await hand.properties.getByRole("spinbutton", { name: "center x" }).count(), 0);
      assert.equal(await field("magnitude").inputValue(), "");
      await hand.type("magnitude", "70");
      await hand.says(scene.replace('magnitude="3000"/>\n  <radial', 'magnitude="70"/>\n  <radial').replace('"500"', '"70"'));
      await becomes(() => field("magnitude").inputValue(), "70");
      await hand.undo(scene);
      await hand.key("forceRadius").click();
      await becomes(() => hand.pressed(hand.key("forceRadius")), "true");
      assert.equal((await hand.command.text()).match(/attribute="forceRadius"/g).length, 2);
      await hand.undo(scene);
    });
  });

  test("in the editor, keys are set and deleted at the playhead", async () => {
    await onScene(async (hand) => {
      const { key, field, pressed } = hand;
      const states = async (...expected) => {
        for (const [frame, state] of expected) {
          await hand.goTo(frame);
          await becomes(() => pressed(key("magnitude")), state, `frame ${frame}`);
        }
      };
      await hand.choose("bulge");
      await states([1, "true"], [4, "mixed"], [8, "true"]);
      await becomes(() => field("magnitude").inputValue(), "900");
      await hand.choose("poke");
      assert.equal(await pressed(key("magnitude")), "false");
      await key("magnitude").click();
      await becomes(() => pressed(key("magnitude")), "true");
      await states([10, "mixed"]);
      // Off: an animated channel gets a key, a constant stays one.
      await hand.type("magnitude", "1000");
      await becomes(() => pressed(key("magnitude")), "true");
      await hand.type("forceRadius", "1");
      await until(async () => (await hand.command.text()).includes('forceRadius="1" magnitude'), "a constant");
      await states([8, "true"], [9, "mixed"], [10, "true"]);
      await key("magnitude").click();
      await becomes(() => pressed(key("magnitude")), "mixed");
      await hand.goTo(8);
      await key("magnitude").click();
      await becomes(() => pressed(key("magnitude")), "false");
      await hand.settled();
      await becomes(async () => /<animate attribute="magnitude"/.test((await hand.command.text()).split("<radial")[0]), false);
      // On.
      const auto = hand.button("Auto-key");
      assert.equal(await pressed(auto), "false");
      await auto.click();
      assert.equal(await pressed(auto), "true");
      await hand.type("forceRadius", "0.75");
      await becomes(() => pressed(key("forceRadius")), "true");
      await auto.click();
      await hand.undoAll(scene);
    });
  });

  test("in the editor, an attribute has a menu", async () => {
    await editing(scene, { permissions: ["clipboard-read", "clipboard-write"] }, async (hand) => {
      const { page, field, entry, menu, press } = hand;
      await hand.choose("poke");
      await field("magnitude").click({ button: "right" });
      assert.deepEqual(await menu.getByRole("menuitem").evaluateAll((all) => all.map((each) => each.getAttribute("aria-label"))), ["Reset", "Copy value", "Paste value", "Delete key", "Freeze", "Copy path"]);
      assert.equal(await entry("Freeze").getAttribute("aria-disabled"), "true");
      await page.screenshot({ path: path.join(pictures, "edit-menu.png") });
      await entry("Copy value").click();
      assert.equal(await menu.count(), 0);
      await hand.choose("crease");
      await field("magnitude").focus();
      await press("Shift+F10");
      await entry("Paste value").click();
      await hand.says(scene.replace('"500"', '"3000"'));
      await hand.undo(scene);
      await field("magnitude").focus();
      await press("Shift+F10", "ArrowUp");
      assert.equal(await hand.focused(), "Copy path");
      await press("Enter");
      assert.equal(await page.evaluate(() => navigator.clipboard.readText()), "crease.magnitude");
      await field("magnitude").click({ button: "right" });
      await entry("Reset").click();
      await until(async () => !(await hand.command.text()).includes('magnitude="500"'), "reset");
      await hand.undo(scene);
      await hand.choose("bulge");
      await hand.goTo(8);
      await field("magnitude").click({ button: "right" });
      await entry("Delete key").click();
      await until(async () => !(await hand.command.text()).includes('frame="8"'), "delete");
      await hand.undo(scene);
      await field("magnitude").click({ button: "right" });
      await entry("Freeze").click();
      await until(async () => /<radial [^>]*magnitude="900"/.test(await hand.command.text()), "freeze");
      await hand.undo(scene);
    });
  });

  // The document

  test("in the editor, keys act on the document wherever the focus is", async () => {
    await editing(scene, {}, async (hand) => {
      const { page, press } = hand;
      const { view } = hand;
      await view.focus();
      await press("Control+a");
      await becomes(() => hand.selected().then((all) => all.length), 7);
      await hand.choose("poke");
      await view.focus();
      await hand.goTo(5);
      await press("i");
      await becomes(() => hand.pressed(hand.key("magnitude")), "true");
      for (const name of ["center", "direction", "forceRadius", "deformationRadius"]) assert.equal(await hand.pressed(hand.key(name)), "true", name);
      await press("Control+z");
      await hand.says(scene);
      await press("Control+c", "Control+v");
      await becomes(hand.selected, ["poke2"]);
      await press("Control+x");
      await hand.says(scene);
      await hand.followed();
      await press("Control+v");
      await until(async () => (await hand.command.text()).includes('name="poke2"'), "paste");
      await becomes(hand.selected, ["poke2"]);
      await press("Delete");
      await hand.says(scene);
      await hand.followed();
      await press("Control+z");
      await becomes(async () => (await hand.command.text()).includes('name="poke2"'), true);
      await press("Control+Shift+z");
      await hand.says(scene);
      await hand.followed();
      // What is copied can be pasted when it is gone; groups, colliders and surfaces can be cut, too.
      const names = (text) => [...text.matchAll(/ name="(.*?)"/g)].map(([, name]) => name).sort();
      await hand.choose("crease");
      await view.focus();
      await press("Control+c", "Delete");
      await until(async () => !(await hand.command.text()).includes("crease"), "delete");
      await hand.followed();
      await press("Control+v");
      await becomes(async () => names(await hand.command.text()), names(scene), "crease is back");
      await hand.followed();
      await hand.choose("fingers", "ball", "sheet");
      await view.focus();
      await press("Control+x");
      await becomes(async () => names(await hand.command.text()), ["bulge", "crease", "poke", "push"], "cut");
      await hand.followed();
      await press("Control+v");
      await becomes(async () => names(await hand.command.text()), names(scene), "they are back");
      for (const each of ['<group name="fingers" center="0 0 0" deformationRadius="3">', 'forceRadius="1" magnitude="$push"/>', '<sphere radius="0.5"/>', 'translate="0 4 0"/>', '<solver dt="0.01"/>']) {
        assert.ok((await hand.command.text()).includes(each), each);
      }
      // A group copies its forces.
      await hand.followed();
      await press("Control+a", "Control+c", "Control+v");
      await becomes(async () => names(await hand.command.text()).length, 2 * names(scene).length - 1, "copies of all");
      await hand.undoAll(scene);
      await hand.choose("crease");
      await hand.type("magnitude", "600");
      await hand.says(scene.replace('"500"', '"600"'));
      // What is not of text leaves all keys with Ctrl, and a field of numbers those of undo.
      await hand.followed();
      const speed = page.getByRole("combobox", { name: "Speed" });
      for (const place of [hand.field("magnitude"), speed]) {
        await place.focus();
        await hand.undo(scene);
        await press("Control+y");
        await hand.says(scene.replace('"500"', '"600"'));
        await hand.followed();
      }
      await press("Control+s");
      await becomes(hand.command.read, scene.replace('"500"', '"600"'), "save");
      await until(async () => (await hand.state()).endsWith("saved"), hand.state);
    });
  });
}
