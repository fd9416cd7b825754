// Tests of files in the page of `pliant edit`: beginning, saving, what is left by a crash, and what is written; a part of
// edit_tests.mjs.

import assert from "node:assert/strict";
import { existsSync, readFileSync, readdirSync } from "node:fs";
import path from "node:path";

import { becomes, until } from "./edit_command.mjs";

export function editFileTests({ test, run, near, pictures, scene, editing, onScene, opened, command }) {
  const changed = (value) => scene.replace('"500"', `"${value}"`);
  const changing = (value) => ({ op: "set", path: "crease.magnitude", value: String(value) });

  test("in the editor, a file that changed on the disk is loaded, kept out, or left alone", async () => {
    await editing(scene, {}, async (hand) => {
      const { command: made, dialog } = hand;
      const asked = dialog("File changed", "alertdialog");
      const answer = (name) => asked.getByRole("button", { name, exact: true }).click();
      // Without changes here it is loaded, as a step.
      made.write(changed(1));
      await hand.says(changed(1));
      await until(async () => (await hand.state()).endsWith("saved"), hand.state);
      assert.equal(await asked.isVisible(), false);
      await hand.undo(scene);
      // Load.
      made.write(changed(2));
      await asked.waitFor();
      await hand.page.screenshot({ path: path.join(pictures, "edit-file-changed.png") });
      await answer("Load");
      await hand.says(changed(2));
      await becomes(() => asked.isVisible(), false);
      await hand.undo(scene);
      // Keep mine, which the next Save writes.
      made.write(changed(3));
      await asked.waitFor();
      await answer("Keep mine");
      await becomes(() => asked.isVisible(), false);
      assert.deepEqual([await made.text(), made.read()], [scene, changed(3)]);
      await hand.button("Save").click();
      await becomes(made.read, scene, "save");
      // Save as…
      await made.operate(changing(7));
      await hand.followed();
      made.write(changed(4));
      await asked.waitFor();
      await answer("Save as…");
      const saving = dialog("Save as");
      await saving.getByRole("textbox", { name: "File" }).fill("other.xml");
      await hand.press("Enter");
      await becomes(() => existsSync(made.path("other.xml")) && made.read("other.xml"), changed(7), "save as");
      await becomes(() => saving.isVisible(), false);
      assert.equal(made.read(), changed(4));
      assert.equal(await asked.isVisible(), false);
      await becomes(() => hand.page.title(), "other.xml – pliant");
    });
  });

  test("in the editor, what a killed command had is restored or discarded", async () => {
    const made = command();
    made.write(scene);
    for (const [answer, text] of [["Restore", changed(8)], ["Discard", scene]]) {
      await made.start("scene.xml");
      await made.operate(changing(8));
      await until(() => existsSync(made.path("state/pliant/edit")) && readdirSync(made.path("state/pliant/edit")).some((name) => name.endsWith(".json") && readFileSync(made.path(`state/pliant/edit/${name}`), "utf8").includes('\\"8\\"')), "the journal");
      await made.end("SIGKILL");
      const hand = await opened(made, await made.start("scene.xml"));
      const asked = hand.dialog("Unsaved changes", "alertdialog");
      await asked.waitFor();
      await hand.page.screenshot({ path: path.join(pictures, "edit-unsaved.png") });
      await hand.press("Escape");
      assert.equal(await asked.isVisible(), true, "it needs an answer");
      await asked.getByRole("button", { name: answer }).click();
      await becomes(() => asked.isVisible(), false);
      await hand.says(text);
      assert.equal((await made.document()).undo !== "", answer === "Restore");
      if (answer === "Restore") await hand.undo(scene);
      assert.deepEqual(hand.page.complaints, []);
      // Leaving what is not saved asks.
      if (answer === "Restore") {
        await hand.row("poke").click();
        await hand.press("Control+Shift+z");
        await hand.says(text);
        await hand.followed();
        const asks = new Promise((resume) => hand.page.once("dialog", (told) => resume(told.type()) || told.accept()));
        await hand.page.close({ runBeforeUnload: true });
        assert.equal(await asks, "beforeunload");
      }
      await hand.page.context().close();
      await made.end();
    }
    assert.equal(made.read(), scene);
  });

  test("in the editor, a page that loses its command says so and is read-only, and a saved one is left without a word", async () => {
    const made = command();
    made.write(scene);
    const hand = await opened(made, await made.start("scene.xml"));
    await hand.settled();
    await hand.choose("poke");
    let asked = 0;
    hand.page.on("dialog", (told) => ++asked && told.accept());
    // A request that does not get through is no end.
    const isLost = async () => /ended.*read-only/.test(await hand.state());
    await hand.page.context().setOffline(true);
    await hand.press("i");
    await until(isLost, hand.state);
    await hand.page.context().setOffline(false);
    await until(async () => !(await isLost()), hand.state);
    await becomes(() => hand.alert("ended").isVisible(), false);
    await hand.button("Add").click();
    await hand.entry("Mesh…").click();
    await hand.dialog("Add a mesh").waitFor();
    await made.end("SIGKILL");
    await until(isLost, hand.state);
    assert.equal(await hand.dialog("Add a mesh").isVisible(), false);
    await hand.page.screenshot({ path: path.join(pictures, "edit-ended.png") });
    for (const name of ["Undo", "Redo", "Save", "Export…", "Auto-key"]) assert.equal(await hand.button(name).isDisabled(), true, name);
    assert.equal(await hand.properties.evaluate((each) => each.closest("[inert]") !== null || [...each.children].every((child) => child.inert)), true);
    assert.equal(await hand.page.getByRole("group", { name: "Keys" }).evaluate((each) => each.inert), true);
    // What is here plays on.
    await hand.view.focus();
    await hand.press("Control+z", "Control+a", "i", "Delete", "Control+s");
    await hand.press("ArrowRight");
    assert.equal(await hand.frame(), 2);
    assert.equal(await hand.page.getByRole("alert").filter({ hasText: "ended" }).textContent(), "The command has ended: this page is read-only×");
    assert.equal(made.read(), scene);
    // The browser itself tells what it cannot reach; the page adds nothing.
    assert.deepEqual(hand.page.complaints.filter((told) => !/net::ERR_|Failed to load/.test(told)), []);
    await hand.page.goto("about:blank");
    assert.equal(asked, 0);
    await hand.page.context().close();
  });

  test("in the editor, somebody without a scene begins with a starter, and it plays", async () => {
    const begin = (made) => made.write("<scene version=\"1\" end=\"3\"><surface name=\"s\"><grid/></surface></scene>", "old <b>&amp;.xml");
    await editing(null, { words: [], begin }, async (hand) => {
      const { page, command: made } = hand;
      const starters = page.getByRole("list", { name: "Starters" });
      const listed = run("new").split("\n");
      const { starters: known } = await made.get("starters");
      await becomes(() => starters.getByRole("button").count(), known.length);
      for (const { name } of known) assert.ok(listed.some((line) => line.includes(name)), name);
      await until(() => starters.getByRole("img", { includeHidden: true }).or(starters.locator("img")).evaluateAll((all) => all.length > 0 && all.every((each) => each.complete && each.naturalWidth > 0)), "pictures");
      await page.getByRole("list", { name: "Scenes" }).getByRole("button", { name: "old <b>&amp;.xml" }).waitFor();
      // Keys do not open what is not shown here.
      await hand.press("d", "c", "ArrowRight");
      assert.deepEqual(await page.evaluate(() => ["display", "curves"].map((id) => document.getElementById(id).hidden)), [true, true]);
      await page.screenshot({ path: path.join(pictures, "edit-first.png") });
      await hand.button("Open a mesh…").click();
      await hand.dialog("Open a mesh").waitFor();
      await hand.press("Escape");
      const materials = page.getByRole("combobox", { name: "Material" });
      const names = (await made.get("starters")).materials.map(({ name }) => name);
      assert.deepEqual(await materials.getByRole("option").evaluateAll((all) => all.map((each) => each.value)), ["", ...names]);
      await starters.getByRole("button", { name: /^trampoline/ }).click();
      await becomes(made.text, run("new", "trampoline"), "a starter");
      await becomes(() => starters.isVisible(), false);
      await hand.settled();
      // The surface is selected, and its handle is where the force is.
      assert.deepEqual(await hand.selected(), ["mat"]);
      await hand.handle("Move mat").click();
      await becomes(hand.selected, ["ball"]);
      await hand.button("Play").click();
      await until(async () => (await hand.frame()) > 4, "it plays");
      await hand.button("Pause").click();
      // The first save asks for a name.
      await hand.press("Control+s");
      const saving = hand.dialog("Save as");
      await saving.getByRole("textbox", { name: "File" }).fill("../up.xml");
      await hand.press("Enter");
      await saving.getByRole("alert").filter({ hasText: "up.xml" }).waitFor();
      await saving.getByRole("textbox", { name: "File" }).fill("old <b>&amp;.xml");
      await hand.press("Enter");
      await saving.getByRole("button", { name: "Overwrite" }).waitFor();
      await saving.getByRole("textbox", { name: "File" }).fill("mine.xml");
      await hand.press("Enter");
      await becomes(() => existsSync(made.path("mine.xml")) && made.read("mine.xml"), run("new", "trampoline"), "save");
      await becomes(() => page.title(), "mine.xml – pliant");
      // The starters again, and back.
      await hand.button("New…").click();
      await becomes(hand.focused, "Back to mine.xml");
      assert.deepEqual([await starters.isVisible(), await hand.tree.isVisible(), await hand.button("Save").isVisible()], [true, false, false]);
      await page.screenshot({ path: path.join(pictures, "edit-new.png") });
      await hand.press("Control+z", "Delete", "Escape");
      await becomes(() => starters.isVisible(), false);
      assert.deepEqual([await made.text(), await hand.tree.isVisible()], [run("new", "trampoline"), true]);
    });
  });

  test("in the editor, names and messages are text", async () => {
    const name = "<img src=x>&amp;.xml";
    await editing(null, { words: [name], begin: (made) => made.write(scene, name) }, async (hand) => {
      await becomes(() => hand.page.title(), `${name} – pliant`);
      await hand.page.getByRole("heading", { level: 1 }).filter({ hasText: name }).waitFor();
      await hand.choose("poke");
      await hand.type("falloff", "smooth", "combobox").catch(() => {});
      await hand.type("magnitude", "<b>9</b>");
      await hand.properties.getByRole("alert").filter({ hasText: "<b>9</b>" }).waitFor();
      assert.equal(await hand.page.locator("#viewer b, #viewer img").count(), 0);
    });
  });

  test("in the editor, the motion of a surface is set by sliders", async () => {
    await onScene(async (hand) => {
      const { command: made } = hand;
      await hand.choose("sheet");
      const group = hand.properties.getByRole("group", { name: "Motion" });
      const slider = (name) => group.getByRole("slider", { name });
      const value = async (name) => Number.parseFloat(await slider(name).getAttribute("aria-valuetext"));
      const known = async () => (await value("Peak")) > 0;
      await until(known, "a peak");
      const motion = async () => made.get(`motion?revision=${await hand.revision()}&surface=sheet`);
      near(await value("Peak"), (await motion()).peak, 0.01 * (await motion()).peak, "Peak");
      await slider("Peak").focus();
      for (let k = 0; k < 30; ++k) await hand.page.keyboard.down("ArrowRight");
      await hand.page.keyboard.up("ArrowRight");
      await until(async () => (await made.text()) !== scene, "Peak");
      const wanted = await value("Peak");
      await until(async () => Math.abs((await motion()).peak - wanted) < 0.05 * wanted, "another peak");
      assert.match(await made.text(), /name="poke".*magnitude="(?!3000")/);
      await hand.page.screenshot({ path: path.join(pictures, "edit-motion.png") });
      await hand.undo(scene);
      assert.equal((await made.document()).undo, "", "one step");
      // A drag by pointer, taken back.
      await until(known, "a peak");
      await hand.settled();
      await hand.drag(slider("Settling"), 12, 0, {
        before: async () => {
          await until(async () => (await made.text()) !== scene, "Settling");
          await hand.press("Escape");
          await hand.says(scene);
          const { x, y } = await hand.middle(slider("Settling"));
          await hand.page.mouse.move(x + 30, y);
        },
      });
      await hand.settled();
      assert.deepEqual([await made.text(), (await made.document()).undo], [scene, ""]);
      // A key that is let go does not end what the pointer holds.
      await until(known, "a peak");
      await hand.drag(slider("Settling"), 24, 0, {
        before: async () => {
          await until(async () => (await made.text()) !== scene, "Settling");
          await hand.press("Shift");
          const { x, y } = await hand.middle(slider("Settling"));
          await hand.page.mouse.move(x + 36, y);
        },
      });
      await hand.followed();
      await hand.undo(scene);
      assert.equal((await made.document()).undo, "", "one step");
      const { materials } = await made.get("starters");
      await group.getByRole("combobox", { name: "Material" }).selectOption(materials[0].name);
      await until(async () => (await made.text()) !== scene, "Material");
      await becomes(() => group.getByRole("combobox", { name: "Material" }).inputValue(), materials[0].name);
      await hand.undo(scene);
      // What cannot be told, since nothing moves it, says why.
      await made.operate({ op: "delete", objects: ["fingers", "prod", "poke", "bulge", "crease"] });
      await until(() => slider("Peak").isDisabled(), "no peak");
      await until(async () => (await group.textContent()).includes((await motion()).reason) && (await motion()).reason !== "", "a reason");
    });
  });

  test("in the editor, an export is that of bake, and can be stopped", async () => {
    const long = scene.replace('columns="21" rows="21"', 'columns="101" rows="101"').replace('end="24"', 'end="2000"');
    await onScene(async (hand) => {
      const { command: made, page } = hand;
      await made.operate(changing(9));
      await hand.button("Export…").click();
      const dialog = hand.dialog("Export");
      const control = (name, role = "textbox") => dialog.getByRole(role, { name, exact: true });
      assert.deepEqual([await control("File").inputValue(), await control("Frames").inputValue()], ["scene.glb", "1:24"]);
      await control("File").fill("out.npy");
      await control("Frames").fill("3:9");
      await control("Space", "combobox").selectOption("object");
      await control("Surface", "combobox").selectOption("sheet");
      await control("Export", "button").click();
      await dialog.getByText("out.npy is written").waitFor();
      assert.equal(await control("Progress", "progressbar").evaluate((each) => each.value === each.max), true);
      await page.screenshot({ path: path.join(pictures, "edit-export.png") });
      made.write(changed(9), "now.xml");
      run("bake", made.path("now.xml"), "-o", made.path("now.npy"), "--frames", "3:9", "--space", "object", "--surface", "sheet", "--quiet");
      assert.ok(readFileSync(made.path("out.npy")).equals(readFileSync(made.path("now.npy"))));
      assert.equal(made.read(), scene);
      await control("File").fill("out.xyz");
      await hand.press("Enter");
      await dialog.getByRole("alert").filter({ hasText: "xyz" }).waitFor();
      for (const [frames, answer] of [["many", 'Frames "many": must be'], ["1-2-3", 'Frames "1-2-3": must be'], ["40", "40 to 40"], ["2:41", "2 to 41"], [" 2 42 ", "2 to 42"], ["2-43", "2 to 43"], ["2 .. 44", "2 to 44"], ["-5 - -1", "-5 to -1"], ["-4--1", "-4 to -1"], ["-3 -1", "-3 to -1"]]) {
        await control("Frames").fill(frames);
        await hand.press("Enter");
        await dialog.getByRole("alert").filter({ hasText: answer }).waitFor();
      }
      await hand.press("Escape");
      assert.equal(await hand.focused(), "Export…");
    });
    await editing(long, { words: ["scene.xml", "--threads", "1"] }, async (hand) => {
      const { command: made } = hand;
      // Playback waits for what is not there.
      await hand.goTo(1);
      await hand.button("Play").click();
      for (let k = 0; k < 4; ++k) {
        const [frame, ready] = await hand.page.evaluate(() => [window.pliant.playback.frame, Math.max(1, ...window.pliant.edit.scene.ready.map(([, last]) => last))]);
        assert.ok(frame <= ready, `frame ${frame} of ${ready}`);
        await hand.drawn();
      }
      assert.match(await hand.state(), /^\d+ of 2000 frames/);
      await hand.button("Pause").click();
      await hand.button("Export…").click();
      const dialog = hand.dialog("Export");
      await dialog.getByRole("textbox", { name: "File" }).fill("long.npy");
      await hand.press("Enter");
      const stop = dialog.getByRole("button", { name: "Stop" });
      await until(async () => /^[1-9]\d* of 2000$/.test(await dialog.getByText(/ of 2000$/).textContent()), "progress");
      await stop.click();
      await dialog.getByText("Stopped").waitFor();
      assert.deepEqual(readdirSync(made.folder).sort(), ["scene.xml", "state"]);
    });
  });

  test("in the editor, the text is shown with the lines of what is selected", async () => {
    await onScene(async (hand) => {
      const { page, command: made } = hand;
      await hand.button("Text").click();
      const lines = page.getByRole("list", { name: "Lines" }).getByRole("listitem");
      await becomes(() => lines.evaluateAll((all) => all.map((each) => each.textContent).join("\n")), scene.trimEnd());
      // No other name has that in it.
      assert.equal(await page.getByRole("button", { name: "Text" }).count(), 1);
      assert.equal(await page.getByRole("region", { name: "Text", exact: true }).isVisible(), true);
      const marked = () => lines.evaluateAll((all) => all.filter((each) => each.ariaCurrent === "true").map((each) => each.textContent.trim()));
      await hand.choose("bulge");
      await becomes(async () => (await marked()).map((line) => line.slice(0, 8)), ["<radial ", "<animate", "</radial"]);
      await hand.choose("poke");
      await made.operate({ op: "set", path: "poke.magnitude", value: "1" });
      await until(async () => (await marked())[0]?.includes('magnitude="1"'), marked);
      await page.screenshot({ path: path.join(pictures, "edit-text.png") });
      assert.equal(await page.getByRole("list", { name: "Lines" }).evaluate((each) => each.isContentEditable), false);
      await page.getByRole("list", { name: "Lines" }).focus();
      await hand.press("Escape");
      assert.deepEqual([await lines.count(), await hand.focused()], [0, "Text"]);
    });
  });
}
