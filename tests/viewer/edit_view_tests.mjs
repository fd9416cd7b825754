// Tests of what is pulled in the page of `pliant edit`: handles over the view and keys on the timeline; a part of edit_tests.mjs.

import assert from "node:assert/strict";
import path from "node:path";

import { becomes, until } from "./edit_command.mjs";

/** Decimals of a number as it is written. */
const decimals = (text) => (text.split(".")[1] ?? "").length;

/** Where the text `now` has the value of an attribute that `before` has, if nothing else differs. */
function onlyChange(before, now, from, attribute) {
  const mark = `${attribute}="`;
  const at = before.indexOf(mark, before.indexOf(from)) + mark.length;
  assert.ok(at >= mark.length && before.indexOf(from) >= 0, from);
  const value = now.slice(at, now.indexOf('"', at));
  assert.equal(now, before.slice(0, at) + value + before.slice(before.indexOf('"', at)), `only ${attribute} of ${from} changes`);
  return value;
}

export function editViewTests({ test, near, pictures, scene, editing, onScene, baked }) {
  const named = (name) => `name="${name}"`;

  /** The length that a pixel shows at a place. */
  const pixelAt = (hand, place) =>
    hand.page.evaluate((at) => {
      const { camera, canvas } = window.pliant.stage;
      const depth = -camera.position.clone().fromArray(at).applyMatrix4(camera.matrixWorldInverse).z;
      return (2 * depth * Math.tan((camera.fov * Math.PI) / 360)) / canvas.clientHeight;
    }, place);

  /** Where a place is seen in the window. */
  const seen = (hand, place) =>
    hand.page.evaluate((at) => {
      const { camera, canvas } = window.pliant.stage;
      const { x, y } = camera.position.clone().fromArray(at).project(camera);
      const box = canvas.getBoundingClientRect();
      return { x: box.x + ((x + 1) / 2) * box.width, y: box.y + ((1 - y) / 2) * box.height };
    }, place);

  /** Directions of the screen in the world. */
  const screen = (hand) => hand.page.evaluate(() => [0, 1, 2].map((column) => window.pliant.stage.camera.matrixWorld.elements.slice(4 * column, 4 * column + 3)));

  const dot = (a, b) => a.reduce((sum, each, k) => sum + each * b[k], 0);

  test("in the editor, a handle moves in the plane of the view, along axes, by tenths, to vertices and over the surface", async () => {
    await onScene(async (hand) => {
      const { handle, drag, page } = hand;
      await hand.settled();
      await hand.choose("poke");
      const move = handle("Move poke");
      const start = [1, 0, 1.5];
      assert.equal(await hand.value("Move poke"), "1 0 1.5");
      const spot = await hand.middle(move);
      const place = await seen(hand, start);
      near(Math.hypot(spot.x - place.x, spot.y - place.y), 0, 1.5, "the handle's distance from its place");
      const pixel = await pixelAt(hand, start);
      const moved = async (dx, dy, options = {}) => {
        await drag(move, dx, dy, options);
        await until(async () => (await hand.command.text()) !== scene, "a drag");
        await hand.settled();
        const text = await hand.command.text();
        const value = onlyChange(scene, text, named("poke"), "center");
        assert.equal(await hand.value("Move poke"), value);
        const now = value.split(" ");
        // One digit more than a pixel shows, and no others.
        for (const [k, each] of now.entries()) if (Number(each) !== start[k]) assert.ok(decimals(each) <= Math.ceil(-Math.log10(pixel)) + 1 && decimals(each) <= 4, `${each}, a pixel is ${pixel}`);
        return now.map((each, k) => Number(each) - start[k]);
      };
      const [right, up, back] = await screen(hand);
      // In the plane of the view, under the pointer.
      const by = await moved(60, -20);
      near(dot(by, back), 0, 2 * pixel, "towards the viewer");
      near(dot(by, right), 60 * pixel, 2 * pixel, "to the right");
      near(dot(by, up), 20 * pixel, 2 * pixel, "upwards");
      const there = await hand.middle(move);
      near(Math.hypot(there.x - spot.x - 60, there.y - spot.y + 20), 0, 2, "the handle's distance from the pointer");
      // The file has these bytes, and no others.
      const text = await hand.command.text();
      await hand.press("Control+s");
      await until(async () => hand.command.read() !== scene, "save");
      assert.equal(hand.command.read(), text);
      onlyChange(scene, hand.command.read(), named("poke"), "center");
      await hand.undo(scene);
      await hand.settled();
      // However short the time is for which a key is down, it counts for the drag in which it is held.
      await page.evaluate(() => (performance.now = () => 0));
      for (const [k, axis] of [[0, "x"], [2, "z"]]) {
        const along = await moved(50, -35, { held: [axis] });
        along.forEach((each, other) => assert.equal(each === 0, other !== k, `${axis}: ${along}`));
        await hand.undo(scene);
        await hand.settled();
      }
      // Pressed once, ahead of the drag.
      await hand.press("y");
      const along = await moved(50, -35);
      assert.deepEqual(along.map((each) => each === 0), [true, false, true]);
      await page.evaluate(() => delete performance.now);
      await hand.undo(scene);
      await hand.settled();
      // Whoever turns to something else has given it up.
      await move.focus();
      await hand.press("x");
      await hand.row("poke").click();
      const tenth = await moved(60, -20, { held: ["Shift"] });
      near(dot(tenth, right), 6 * pixel, 2 * pixel, "to the right by a tenth");
      near(dot(tenth, up), 2 * pixel, pixel, "upwards by a tenth");
      await hand.undo(scene);
      await hand.settled();
      // To vertices, and over the surface, which is flat at first.
      const { positions } = await hand.shown("sheet");
      const atVertex = (await moved(70, -15, { held: ["Control"] })).map((each, k) => each + start[k]);
      const nearest = Math.min(...Array.from({ length: positions.length / 3 }, (_, k) => Math.hypot(...atVertex.map((each, c) => each - positions[3 * k + c]))));
      near(nearest, 0, pixel, "distance from a vertex");
      await hand.undo(scene);
      await hand.settled();
      const over = (await moved(73, -19, { held: ["Alt"] })).map((each, k) => each + start[k]);
      near(over[1], 0, pixel, "height over the sheet");
      assert.ok(Math.hypot(over[0] - start[0], over[2] - start[2]) > 20 * pixel);
      await hand.undo(scene);
      await hand.settled();
      // Arrow keys.
      const reach = await page.evaluate(() => window.pliant.viewer.reach);
      await move.focus();
      for (let k = 0; k < 3; ++k) await page.keyboard.down("ArrowRight");
      await page.keyboard.up("ArrowRight");
      await until(async () => (await hand.command.text()) !== scene, "arrow keys");
      await hand.settled();
      const stepped = onlyChange(scene, await hand.command.text(), named("poke"), "center").split(" ").map((each, k) => Number(each) - start[k]);
      near(dot(stepped, right) / (0.03 * reach), 1, 0.1, "three steps to the right");
      near(dot(stepped, up), 0, 2 * pixel, "upwards");
      await hand.undo(scene);
      assert.equal((await hand.command.document()).undo, "", "each was one step");
      // A key that is still down when all is taken back begins nothing.
      await move.focus();
      for (let k = 0; k < 2; ++k) await page.keyboard.down("ArrowRight");
      await until(async () => (await hand.command.text()) !== scene, "arrow keys");
      await hand.press("Escape");
      await hand.says(scene);
      await page.keyboard.down("ArrowRight");
      await page.keyboard.up("ArrowRight");
      await hand.settled();
      await hand.says(scene);
    });
  });

  test("in the editor, Escape takes a drag back as if it had never been", async () => {
    await onScene(async (hand) => {
      await hand.settled();
      await hand.choose("poke");
      await hand.type("magnitude", "10");
      await until(async () => (await hand.command.text()) !== scene, "a value");
      await hand.undo(scene);
      await hand.settled();
      const { redo } = await hand.command.document();
      const move = hand.handle("Move poke");
      const before = await hand.middle(move);
      await hand.drag(move, 50, 20, {
        before: async () => {
          await until(async () => (await hand.command.text()) !== scene, "a drag");
          await hand.press("Escape");
        },
      });
      await hand.says(scene);
      await hand.settled();
      assert.deepEqual(await hand.middle(move), before);
      assert.deepEqual([(await hand.command.document()).redo, (await hand.command.document()).undo], [redo, ""]);
      await hand.press("Control+Shift+z");
      await hand.says(scene.replace('magnitude="3000"/>\n  <radial', 'magnitude="10"/>\n  <radial'));
      await hand.undo(scene);
      await hand.settled();
      // What is done right after a drag comes after its last value.
      for (let k = 0; k < 3; ++k) {
        await hand.drag(move, 50, 20, { steps: 9 });
        await hand.press("Control+z");
        await until(async () => (await hand.command.document()).redo.includes("center"), "undo at once");
        await hand.says(scene);
        await hand.settled();
        assert.equal((await hand.command.document()).undo, "");
      }
    });
  });

  test("in the editor, radii, directions, magnitudes, ends, groups, surfaces and colliders are pulled", async () => {
    await onScene(async (hand) => {
      const { handle, drag } = hand;
      await hand.settled();
      const pulled = async (object, name, dx, dy, attribute) => {
        if (!(await hand.selected()).includes(object)) await hand.choose(object);
        const before = await hand.value(name);
        await drag(handle(name), dx, dy);
        await until(async () => (await hand.command.text()) !== scene, name);
        await hand.settled();
        const value = attribute ? onlyChange(scene, await hand.command.text(), named(object), attribute) : await hand.value(name);
        assert.equal(await hand.value(name), value);
        assert.notEqual(value, before);
        return value.split(" ").map(Number);
      };
      const back = async () => {
        await hand.undo(scene);
        await hand.settled();
      };
      // Of a radius: away from the middle it grows.
      for (const [attribute, name] of [["deformationRadius", "Deformation radius of poke"], ["forceRadius", "Force radius of poke"]]) {
        await hand.choose("poke");
        const [middle, at] = [await seen(hand, [1, 0, 1.5]), await hand.middle(handle(name))];
        const length = Math.hypot(at.x - middle.x, at.y - middle.y);
        const [radius] = await pulled("poke", name, (20 * (at.x - middle.x)) / length, (20 * (at.y - middle.y)) / length, attribute);
        const pixel = await pixelAt(hand, [1, 0, 1.5]);
        near(radius - (attribute === "forceRadius" ? 1.25 : 2.5), 20 * pixel, 2 * pixel, name);
        await back();
      }
      // What is refused in the end is taken back as a whole, and the reason stays.
      const { page } = hand;
      const refused = { contentType: "application/vnd.pliant.refusal+json", body: JSON.stringify({ status: 422, errors: [{ message: "not so far" }] }) };
      await drag(handle("Move poke"), 20, 0, {
        before: async () => {
          await until(async () => (await hand.command.text()) !== scene, "a drag");
          await page.route("**/operations", (route) => (route.request().postDataJSON().cancel ? route.continue() : route.fulfill(refused)));
          const { x, y } = await hand.middle(handle("Move poke"));
          await page.mouse.move(x + 10, y);
          await hand.alert("not so far").waitFor();
        },
      });
      await hand.says(scene);
      await hand.settled();
      assert.deepEqual([await hand.alert("not so far").isVisible(), (await hand.command.document()).undo], [true, ""]);
      await page.unroute("**/operations");
      const direction = await pulled("poke", "Direction of poke", 40, 15, "direction");
      near(Math.hypot(...direction), 1, 0.02, "length of a direction");
      await back();
      const [weaker] = await pulled("poke", "Magnitude of poke", 0, 15, "magnitude");
      assert.ok(weaker < 3000, `${weaker}`);
      await back();
      await pulled("crease", "Move from of crease", 10, 20, "from");
      await back();
      await pulled("crease", "Move to of crease", 10, 20, "to");
      await back();
      await pulled("fingers", "Move fingers", 25, 10, "center");
      await back();
      await pulled("ball", "Move ball", 25, -10, "translate");
      await back();
      // A surface by its transform, which is not there yet.
      await hand.choose("sheet");
      const before = await hand.shown("sheet");
      const translate = await pulled("sheet", "Move sheet", 15, 10);
      assert.match(await hand.command.text(), new RegExp(`<transform translate="${translate.join(" ")}"/>`));
      const after = await hand.shown("sheet");
      near(after.positions[0] - before.positions[0], translate[0], 1e-5, "its first vertex");
      await back();
      // Of several that are selected each has its handles.
      await hand.choose("poke", "crease");
      for (const name of ["Move poke", "Move to of crease", "Magnitude of crease"]) assert.equal(await handle(name).isVisible(), true, name);
    });
  });

  test("in the editor, what moves a handle makes keys of what is animated, and of constants with Auto-key", async () => {
    const text = scene.replace('center="1 0 1.5"', "").replace('magnitude="3000"/>\n  <radial', 'magnitude="3000">\n    <animate attribute="center"><key frame="1" value="1 0 1"/><key frame="13" value="1 0 -1"/></animate>\n  </point>\n  <radial');
    await editing(text, {}, async (hand) => {
      await hand.settled();
      await hand.choose("poke");
      await hand.goTo(7);
      await becomes(() => hand.value("Move poke"), "1 0 0");
      await hand.settled();
      await hand.drag(hand.handle("Move poke"), 40, 0);
      await until(async () => (await hand.command.text()) !== text, "a drag");
      await hand.settled();
      const keyed = await hand.command.text();
      assert.match(keyed, /<key frame="7" value="[^"]+"\/>/);
      assert.equal(keyed.replace(/<key frame="7" value="[^"]+"\/>/, ""), text);
      assert.equal(await hand.pressed(hand.key("center")), "true");
      await hand.undo(text);
      await hand.settled();
      await hand.button("Auto-key").click();
      await hand.drag(hand.handle("Force radius of poke"), 0, 12);
      await until(async () => /<animate attribute="forceRadius"[^>]*>\s*<key frame="7" value="[^"]+"/.test(await hand.command.text()), "a key of a constant");
      await hand.undo(text);
      assert.equal((await hand.command.document()).undo, "");
    });
  });

  test("in the editor, a click on what is drawn selects it, and a drag beside it turns the view", async () => {
    await onScene(async (hand) => {
      const { page } = hand;
      await hand.settled();
      const click = async (place, options) => {
        const { x, y } = await seen(hand, place);
        await page.mouse.click(x, y, options);
      };
      await click([1, 0, 1.5]);
      await becomes(hand.selected, ["poke"]);
      await click([0, 4, 0]);
      await becomes(hand.selected, ["ball"]);
      // Without forces in its way.
      await hand.press("g");
      await click([1, 0, 1.5]);
      await becomes(hand.selected, ["sheet"]);
      await hand.press("g");
      // A handle lets through what is drawn below it; that of a force is ahead of the surface behind it.
      const press = async (name, ...modifiers) => {
        await hand.drawn();
        await hand.handle(name).click({ modifiers });
      };
      await press("Move sheet");
      await becomes(hand.selected, ["fingers"]);
      await hand.choose("poke", "crease");
      await press("Magnitude of poke", "Control");
      await becomes(hand.selected, ["crease"]);
      await hand.choose("crease", "poke");
      await press("Magnitude of poke");
      await becomes(hand.selected, ["poke"]);
      await hand.choose("sheet");
      const camera = () => page.evaluate(() => window.pliant.stage.camera.position.toArray());
      const before = await camera();
      const { x, y } = await seen(hand, [3.5, 0, -3.5]);
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move(x + 60, y + 20, { steps: 4 });
      await page.mouse.up();
      await hand.drawn();
      const after = await camera();
      assert.ok(Math.hypot(...after.map((each, k) => each - before[k])) > 0.1, `${after}`);
      assert.deepEqual(await hand.selected(), ["sheet"]);
      await hand.says(scene);
      // The menu of what is drawn.
      const ball = await seen(hand, [0, 4, 0]);
      await page.mouse.click(ball.x, ball.y, { button: "right" });
      await hand.entry("Duplicate").waitFor();
      await hand.press("Escape");
      assert.deepEqual(await hand.selected(), ["ball"]);
    });
  });

  test("in the editor, positions after a drag are those of a bake, on every page", async () => {
    await editing(scene, {}, async (hand) => {
      await hand.settled();
      const { page, command } = hand;
      const other = await page.context().newPage();
      await other.setViewportSize({ width: 900, height: 400 });
      const complaints = [];
      const listens = [];
      other.on("request", (request) => request.url().endsWith("/events") && listens.push(request));
      other.on("console", (message) => ["error", "warning"].includes(message.type()) && complaints.push(message.text()));
      await other.goto(command.url);
      await other.waitForFunction(() => document.documentElement.dataset.ready === "true");
      const second = new hand.constructor(other, command);
      // It knows what has been told before.
      await until(async () => (await second.state()).startsWith("24 of 24 frames"), second.state);
      await hand.choose("poke");
      await hand.goTo(16);
      await second.goTo(16);
      await hand.drag(hand.handle("Move poke"), 45, 10);
      await until(async () => (await command.text()) !== scene, "a drag");
      await hand.settled();
      await second.settled();
      const text = await command.text();
      const expected = baked(command, text, 16, "sheet");
      for (const each of [hand, second]) {
        const { revision, frame, exact, positions } = await each.shown("sheet");
        assert.deepEqual([revision, frame, exact], [await hand.revision(), 16, true]);
        assert.deepEqual(positions, expected);
      }
      // What one page does, both show.
      const state = async ({ tree, button }) => [await tree.getByRole("treeitem").evaluateAll((all) => all.map((each) => each.getAttribute("aria-label"))), await button("Undo").getAttribute("aria-description"), await button("Redo").getAttribute("aria-description")];
      const steps = [
        () => second.choose("crease").then(() => second.press("Control+d")),
        () => second.press("Control+z"),
        () => hand.press("Control+z"),
        () => second.press("Control+Shift+z"),
      ];
      for (const step of steps) {
        const before = await hand.revision();
        await step();
        await until(async () => (await hand.revision()) > before, "a step");
        await hand.settled();
        await second.settled();
        assert.deepEqual(await state(second), await state(hand));
        assert.deepEqual(await second.shown("sheet"), await hand.shown("sheet"));
      }
      await second.choose("poke");
      assert.equal(await second.value("Move poke"), await hand.value("Move poke"));
      // A browser opens few connections: one page listens for all, and when it is closed another one does.
      assert.equal(listens.length, 0);
      await page.close();
      await until(() => listens.length === 1, "the other one listens");
      await command.operate({ op: "set", path: "poke.magnitude", value: "5" });
      await second.settled();
      await becomes(() => second.field("magnitude").inputValue(), "5");
      assert.deepEqual(complaints, []);
    });
  });

  test("in the editor, keys are moved on the timeline", async () => {
    const text = scene.replace('forceRadius="0.5" magnitude="500"/>', 'magnitude="500"><animate attribute="forceRadius"><key frame="8" value="0.5"/><key frame="20" value="1"/></animate></line>');
    await editing(text, {}, async (hand) => {
      const { page, button, press } = hand;
      await hand.settled();
      const keys = () => page.getByRole("group", { name: "Keys" }).getByRole("button").evaluateAll((all) => all.map((each) => each.getAttribute("aria-label")));
      const at = (...frames) => frames.map((frame) => `Keys at ${frame}`);
      await becomes(keys, at(1, 8, 16, 20));
      const perFrame = (await hand.middle(button("Keys at 16"))).x - (await hand.middle(button("Keys at 8"))).x;
      const dragged = (frame, by, options) => hand.drag(button(`Keys at ${frame}`), (by * perFrame) / 8, 0, options);
      const moved = (...pairs) => pairs.reduce((now, [from, to]) => now.replaceAll(`frame="${from}"`, `frame="${to}"`), text);
      const back = async () => {
        await hand.undo(text);
        await hand.settled();
        await becomes(keys, at(1, 8, 16, 20));
      };
      // Nothing is selected: keys of all.
      await dragged(8, 3);
      await hand.says(moved([8, 11]));
      await hand.settled();
      await becomes(keys, at(1, 11, 16, 20));
      await back();
      // Those of what is selected.
      await hand.choose("bulge");
      await becomes(keys, at(1, 8, 16));
      await dragged(8, -2);
      await hand.says(text.replace('frame="8" value="900"', 'frame="6" value="900"'));
      await press("Control+z");
      await hand.says(text);
      await hand.settled();
      // All later ones, too.
      await dragged(8, 2, { held: ["Alt"] });
      await hand.says(text.replace('frame="8" value="900"', 'frame="10" value="900"').replace('frame="16"', 'frame="18"'));
      await press("Control+z");
      await hand.says(text);
      await hand.settled();
      // Two at one frame are refused, which is told while it is dragged.
      await dragged(8, 8, { before: () => hand.alert("16").waitFor() });
      await hand.says(text);
      await hand.settled();
      assert.equal(await hand.alert("16").isVisible(), true, "the reason stays");
      await becomes(keys, at(1, 8, 16));
      assert.equal((await hand.command.document()).undo, "");
      // Escape.
      await dragged(8, 3, {
        before: async () => {
          await until(async () => (await hand.command.text()) !== text, "a drag of keys");
          await press("Escape");
        },
      });
      await hand.says(text);
      await hand.settled();
      await becomes(keys, at(1, 8, 16));
      // A mark that was dragged can be pressed; a key that is still down when all is taken back begins nothing.
      await press("Enter");
      assert.deepEqual([await hand.focused(), await hand.frame()], ["Keys at 8", 8]);
      for (let k = 0; k < 2; ++k) await page.keyboard.down("ArrowRight");
      await until(async () => (await hand.command.text()) !== text, "arrow keys");
      await press("Escape");
      await hand.says(text);
      await hand.settled();
      await page.keyboard.down("ArrowRight");
      await page.keyboard.up("ArrowRight");
      await becomes(keys, at(1, 8, 16));
      // Arrow keys, then Delete, then a copy at the playhead.
      await press("ArrowRight");
      await hand.says(text.replace('frame="8" value="900"', 'frame="9" value="900"'));
      await hand.settled();
      assert.equal(await hand.focused(), "Keys at 9");
      await press("Space");
      assert.equal(await hand.frame(), 9);
      await press("Delete");
      await until(async () => !(await hand.command.text()).includes('value="900"'), "delete keys");
      await hand.undoAll(text);
      await hand.settled();
      await button("Keys at 8").click();
      assert.equal(await hand.frame(), 8);
      assert.equal(await hand.pressed(button("Keys at 8")), "true");
      await press("Control+c");
      await hand.goTo(12);
      await press("Control+v");
      await until(async () => /frame="12" value="900"/.test(await hand.command.text()), "paste keys");
      await page.screenshot({ path: path.join(pictures, "edit-timeline.png") });
      await hand.undo(text);
      // A group has those of its members, to which copies go back.
      await hand.command.operate({ op: "animate", channels: ["prod.forceRadius", "prod.center", "fingers.center"], frame: 4 });
      await hand.choose("fingers");
      await hand.settled();
      await becomes(keys, at(4));
      await button("Keys at 4").click();
      await press("Control+c");
      await hand.goTo(12);
      await press("Control+v");
      await hand.settled();
      await becomes(keys, at(4, 12));
      const centers = [...(await hand.command.text()).matchAll(/<key frame="12" value="(\S+ \S+ \S+)"/g)].map(([, value]) => value);
      assert.deepEqual(centers, ["0 0 0", "-1 0 -1"]);
      await hand.undoAll(text);
    });
  });

  test("in the editor, nothing of the lists is made anew while one drags or plays, and the file stays as it is", async () => {
    await onScene(async (hand) => {
      const { page } = hand;
      await hand.settled();
      await hand.choose("poke");
      await hand.properties.getByRole("spinbutton", { name: "center x" }).waitFor();
      await page.evaluate(() => {
        window.replaced = [];
        const observer = new MutationObserver((records) => {
          for (const { removedNodes, addedNodes } of records) for (const node of [...removedNodes, ...addedNodes]) if (node instanceof Element) window.replaced.push(node.outerHTML.slice(0, 200));
        });
        for (const place of [document.querySelector("[role=tree]"), document.querySelector("[role=region][aria-label=Properties]"), document.querySelector("#handles")]) observer.observe(place, { childList: true, subtree: true });
      });
      await hand.drag(hand.handle("Move poke"), 80, 10, { steps: 8, before: () => until(async () => (await hand.command.text()) !== scene, "a drag") });
      await hand.settled();
      await hand.drag(hand.field("magnitude"), 60, 0, { steps: 8 });
      await hand.settled();
      await hand.button("Play").click();
      await until(async () => (await hand.frame()) > 3, "it plays");
      await hand.button("Pause").click();
      assert.deepEqual(await page.evaluate(() => window.replaced), []);
      assert.equal(hand.command.read(), scene);
      // One step each.
      assert.equal((await hand.command.document()).undo, "set poke.magnitude");
      await hand.undoAll(scene);
    });
  });
}
