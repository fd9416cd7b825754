// Tests of recordings in the page of `pliant edit`; a part of edit_tests.mjs. Time passes as a test says.

import assert from "node:assert/strict";
import path from "node:path";

import { becomes, until } from "./edit_command.mjs";

/** The keys of the channel of an object, as the text has them. */
function keysOf(text, object, attribute) {
  const begin = text.indexOf(`name="${object}"`);
  const animate = text.slice(text.indexOf(`<animate attribute="${attribute}"`, begin)).match(/<animate[^]*?<\/animate>/)[0];
  return [...animate.matchAll(/<key ([^>]*)\/>/g)].map(([, words]) => Object.fromEntries([...words.matchAll(/(\w+)="([^"]*)"/g)].map(([, name, value]) => [name, name === "frame" ? Number(value) : value])));
}

const range = (first, last) => Array.from({ length: last - first + 1 }, (_, k) => first + k);
const framesOf = (keys) => keys.map(({ frame }) => frame);
const values = (keys) => keys.map(({ value }) => Number(value));

export function editRecordTests({ test, near, pictures, scene, editing, onScene, bakedFrames }) {
  /** What one does with a page that records. */
  class Studio {
    constructor(hand) {
      Object.assign(this, { hand, page: hand.page });
      this.bar = this.page.getByRole("group", { name: "Recording", exact: true });
      this.tolerance = this.page.getByRole("spinbutton", { name: "Tolerance" });
      this.speed = this.page.getByRole("combobox", { name: "Recording speed" });
    }

    /** From here on the clock stands still, and all that is seen while something is recorded is kept. */
    begin = async (frame, tolerance = "0") => {
      await this.page.evaluate(() => {
        const { recorder } = window.pliant.edit.editor;
        window.clock = performance.now();
        performance.now = () => window.clock;
        window.seen = [];
        const look = () => {
          const { revision, frame, exact, positions } = window.pliant.edit.shown();
          if (recorder.isRunning && exact && !window.seen.some((each) => each.revision === revision && each.frame === frame)) window.seen.push({ revision, frame, positions: Object.fromEntries(Object.entries(positions).map(([name, each]) => [name, [...each]])) });
          window.looking = requestAnimationFrame(look);
        };
        look();
      });
      await this.hand.goTo(frame);
      if ((await this.hand.pressed(this.hand.button("Record"))) === "false") await this.hand.button("Record").click();
      await this.say(tolerance);
      await this.hand.settled();
    };

    end = async () => {
      if ((await this.hand.pressed(this.hand.button("Record"))) === "true") await this.hand.press("r");
      await this.page.evaluate(() => {
        delete performance.now;
        cancelAnimationFrame(window.looking);
      });
    };

    /** Types the tolerance. */
    say = async (tolerance) => {
      await this.tolerance.fill(tolerance);
      await this.tolerance.press("Enter");
      await this.tolerance.evaluate((field) => field.blur());
    };

    frames = () => this.page.evaluate(() => window.pliant.edit.editor.recorder.frames);
    isRunning = () => this.page.evaluate(() => window.pliant.edit.editor.recorder.isRunning);
    account = () => this.bar.locator("output").textContent();

    /** Lets frames pass, until the newest one is on the screen or time has ended. */
    pass = async (frames, speed = 1) => {
      await this.page.evaluate((time) => (window.clock += time), (1000 * (frames + 0.01)) / 24 / speed);
      await until(() => this.page.evaluate(() => {
        const { shown, editor } = window.pliant.edit;
        const { frame, exact } = shown();
        return !editor.recorder.isRunning || (exact && frame === editor.recorder.frames[1]);
      }), "the newest frame");
      await this.hand.drawn();
    };

    /** Drags an element by way of some places, at each of which frames pass; `before` is done before it is let go. */
    drag = async (locator, ways, { frames = 1, speed = 1, before = () => {} } = {}) => {
      const { x, y } = await this.hand.middle(locator);
      await this.page.mouse.move(x, y);
      await this.page.mouse.down();
      for (const [dx, dy] of ways) {
        await this.page.mouse.move(x + dx, y + dy);
        await this.pass(frames, speed);
      }
      await before();
      await this.page.mouse.up();
    };

    /** Waits for the step of a recording. */
    made = async (name) => {
      await becomes(async () => (await this.hand.command.document()).undo, `record ${name}`);
      await until(async () => !(await this.isRunning()), "the end of a recording");
      await this.hand.settled();
    };

    /** What was seen, from a revision on, is what the text plays, to the bit. */
    isPlayed = async (text, least, since = 0) => {
      const seen = (await this.page.evaluate(() => window.seen)).filter(({ revision }) => revision >= since);
      const frame = bakedFrames(this.hand.command, text, "sheet");
      for (const each of seen) assert.deepEqual(each.positions.sheet, frame(each.frame), `frame ${each.frame}`);
      assert.ok(new Set(seen.map((each) => each.frame)).size >= least, `${seen.length} pictures`);
    };
  }

  const inStudio = (body) =>
    onScene(async (hand) => {
      const studio = new Studio(hand);
      await hand.settled();
      await body(studio, hand);
      await studio.end();
    });

  const ways = (count, to) => range(1, count).map((k) => [(to[0] * k) / count, to[1] * Math.sin(k)]);

  test("in the editor, a handle is recorded while time runs, and what one saw is what plays", async () => {
    await inStudio(async (studio, hand) => {
      await hand.choose("poke");
      assert.equal(await studio.bar.isVisible(), false);
      await studio.begin(5);
      assert.deepEqual([await hand.pressed(hand.button("Record")), await studio.bar.isVisible(), await studio.tolerance.inputValue()], ["true", true, "0"]);
      await studio.drag(hand.handle("Move poke"), [...ways(6, [60, 20]), ...ways(2, [40, -10])], {
        before: async () => {
          await becomes(async () => (await hand.state()).split(" · ").slice(0, 2), ["recording poke.center", "frame 13"]);
          // What passes without a picture is recorded too.
          await studio.pass(3);
          assert.deepEqual(await studio.frames(), [5, 16]);
          assert.equal(await hand.frame(), 16);
          await hand.page.screenshot({ path: path.join(pictures, "edit-recording.png") });
        },
      });
      await studio.made("poke.center");
      const text = await hand.command.text();
      const keys = keysOf(text, "poke", "center");
      assert.deepEqual(framesOf(keys), range(5, 16));
      assert.ok(keys.every(({ interpolation, ...others }) => interpolation === "linear" && Object.keys(others).length === 2));
      // The hand moved right after the frame began; a frame has the value from its beginning.
      assert.equal(keys[0].value, "1 0 1.5");
      assert.equal(new Set(keys.slice(0, 9).map(({ value }) => value)).size, 9);
      assert.equal(new Set(keys.slice(8).map(({ value }) => value)).size, 1);
      assert.equal(await hand.value("Move poke"), keys.at(-1).value);
      assert.equal(text.replace(/<point name="poke"[^]*?<\/point>/, ""), scene.replace(/<point name="poke".*\/>/, ""));
      await hand.press("Control+s");
      await until(async () => hand.command.read() !== scene, "save");
      assert.equal(hand.command.read(), text);
      await studio.isPlayed(hand.command.read(), 9);
      await becomes(studio.account, "poke.center 5–16: 12 keys of 12 frames");
      await hand.undo(scene);
      assert.equal((await hand.command.document()).undo, "");
      await becomes(studio.account, "");
    });
  });

  test("in the editor, a field is recorded, and another tolerance makes the same step again", async () => {
    await inStudio(async (studio, hand) => {
      const { page } = hand;
      await hand.choose("poke");
      await studio.begin(1, "0.02");
      await studio.drag(hand.field("magnitude"), [...ways(12, [60, 0]), ...ways(5, [-20, 0])]);
      await studio.made("poke.magnitude");
      const { raw, first, last, before, path } = await page.evaluate(() => window.pliant.edit.editor.recorder.recorded[0]);
      assert.deepEqual([path, first, last, before, raw.length, raw[0]], ["poke.magnitude", 1, 18, null, 18, [3000]]);
      const size = Math.max(...raw.flat()) - Math.min(...raw.flat());
      const apart = () => page.evaluate((raw) => Math.max(...raw.map(([value], k) => Math.abs(value - window.pliant.edit.editor.numbersOf("poke.magnitude", k + 1)[0]))), raw);
      const count = async () => keysOf(await hand.command.text(), "poke", "magnitude").length;
      const counts = [];
      for (const tolerance of [0.02, 0.3, 0, 0.1]) {
        if (tolerance !== 0.02) {
          const revision = await hand.revision();
          await studio.say(String(tolerance));
          await until(async () => (await hand.revision()) > revision, "the tolerance");
          await hand.settled();
        }
        assert.ok((await apart()) <= tolerance * size * (1 + 1e-9), `${await apart()} at ${tolerance} of ${size}`);
        counts.push(await count());
        await becomes(studio.account, `poke.magnitude 1–18: ${counts.at(-1)} keys of 18 frames`);
      }
      assert.ok(counts[1] < counts[3] && counts[3] <= counts[0] && counts[0] < counts[2] && counts[2] === 18, counts.join(" "));
      assert.equal((await hand.command.document()).undo, "record poke.magnitude");
      // Of its scrub the newest one counts, and Escape takes it back.
      await hand.drag(studio.tolerance, 30, 0, { before: () => hand.press("Escape"), steps: 6 });
      await becomes(() => studio.tolerance.inputValue(), "0.1");
      await becomes(count, counts[3]);
      await hand.settled();
      await hand.undo(scene);
      assert.equal((await hand.command.document()).undo, "", "all was one step");
      // Without the step it is for the next recording.
      await hand.press("Control+Shift+z");
      await becomes(async () => (await hand.command.document()).undo, "record poke.magnitude");
      await hand.settled();
      const redone = await hand.command.text();
      await studio.say("0");
      await hand.settled();
      assert.equal(await hand.command.text(), redone);
      assert.equal(await studio.account(), "");
    });
  });

  test("in the editor, Escape takes a recording back, and the end of the frames and Space end it", async () => {
    await inStudio(async (studio, hand) => {
      const { page, handle, press } = hand;
      await hand.choose("poke");
      await hand.type("magnitude", "10");
      await until(async () => (await hand.command.text()) !== scene, "a value");
      await hand.undo(scene);
      const { redo } = await hand.command.document();
      await studio.begin(5);
      for (const locator of [handle("Move poke"), hand.field("magnitude")]) {
        await studio.drag(locator, ways(3, [40, 0]), {
          before: async () => {
            assert.notEqual(await hand.command.text(), scene);
            await press("Escape");
            await hand.says(scene);
          },
        });
        await hand.settled();
        const document = await hand.command.document();
        assert.deepEqual([document.undo, document.redo, await hand.frame(), await studio.account()], ["", redo, 5, ""]);
      }
      // A click is none, and what is held still needs two keys.
      await handle("Move poke").click();
      await until(async () => !(await studio.isRunning()), "the end of a click");
      await hand.settled();
      assert.deepEqual([await hand.command.text(), (await hand.command.document()).redo], [scene, redo]);
      await studio.say("0.01");
      await studio.drag(handle("Move poke"), [[0, 0]], { frames: 6 });
      await studio.made("poke.center");
      assert.deepEqual(framesOf(keysOf(await hand.command.text(), "poke", "center")), [5, 11]);
      await hand.undo(scene);
      await studio.say("0");
      await hand.goTo(5);
      await hand.settled();
      // The last frame ends it, whatever the hand does then.
      const after = async (locator, name, last, end) => {
        await studio.drag(locator, ways(3, [40, 0]), {
          before: async () => {
            await end();
            await studio.made(name);
            const text = await hand.command.text();
            const { x, y } = await hand.middle(locator);
            await page.mouse.move(x + 50, y + 30);
            await studio.pass(1);
            assert.equal(await hand.command.text(), text);
          },
        });
        await hand.settled();
        assert.deepEqual(framesOf(keysOf(await hand.command.text(), "poke", name.split(".")[1])), range(5, last));
        assert.deepEqual([await hand.frame(), await page.evaluate(() => window.pliant.playback.isPlaying)], [last, false]);
        await hand.undo(scene);
        assert.equal((await hand.command.document()).undo, "");
        await hand.goTo(5);
        await hand.settled();
      };
      for (const [locator, name] of [[handle("Move poke"), "poke.center"], [hand.field("magnitude"), "poke.magnitude"]]) {
        await after(locator, name, 24, () => studio.pass(100));
        await after(locator, name, 8, async () => {
          await page.keyboard.down("Space");
          await page.keyboard.down("Space");
          await page.keyboard.up("Space");
        });
      }
      // At the last frame there is one key.
      await hand.goTo(24);
      await hand.settled();
      await studio.drag(handle("Force radius of poke"), [[0, 12]]);
      await studio.made("poke.forceRadius");
      assert.deepEqual(framesOf(keysOf(await hand.command.text(), "poke", "forceRadius")), [24]);
      await hand.undo(scene);
    });
  });

  test("in the editor, one records at half and quarter speed, and by the keyboard alone", async () => {
    await inStudio(async (studio, hand) => {
      const { page, press } = hand;
      await hand.choose("poke");
      await studio.begin(3);
      for (const [label, speed] of [["½×", 0.5], ["¼×", 0.25]]) {
        await studio.speed.selectOption({ label });
        await studio.drag(hand.handle("Move poke"), ways(4, [40, 10]), { speed });
        await studio.made("poke.center");
        assert.deepEqual(framesOf(keysOf(await hand.command.text(), "poke", "center")), range(3, 7), label);
        await hand.undo(scene);
        await hand.goTo(3);
        await hand.settled();
      }
      await studio.speed.selectOption({ label: "1×" });
      // A held arrow key, at a handle and in a field.
      for (const [locator, name, key] of [[hand.handle("Move poke"), "poke.center", "ArrowRight"], [hand.field("magnitude"), "poke.magnitude", "ArrowUp"]]) {
        await locator.focus();
        await page.keyboard.down(key);
        await studio.pass(1);
        for (let k = 0; k < 3; ++k) {
          await page.keyboard.down(key);
          await studio.pass(2);
        }
        assert.equal(await page.evaluate(() => (window.pliant.playback.play(), window.pliant.playback.isPlaying)), false, "nothing plays by itself");
        await page.keyboard.up(key);
        await studio.made(name);
        const keys = keysOf(await hand.command.text(), "poke", name.split(".")[1]);
        assert.deepEqual(framesOf(keys), range(3, 10));
        // A frame has the value from its beginning.
        assert.deepEqual(keys.map(({ value }) => [...new Set(keys.map((each) => each.value))].indexOf(value)), [0, 1, 2, 2, 3, 3, 4, 4].map((k) => Math.min(k, 4)).slice(0, keys.length), name);
        await hand.undo(scene);
        await hand.goTo(3);
        await hand.settled();
      }
      // A touch leaves one key, with what it did.
      await hand.field("magnitude").focus();
      await press("ArrowUp");
      await studio.made("poke.magnitude");
      assert.deepEqual(keysOf(await hand.command.text(), "poke", "magnitude"), [{ frame: 3, value: "3030", interpolation: "linear" }]);
      await hand.undo(scene);
    });
  });

  test("in the editor, a recording leaves what was there before it and beside it", async () => {
    const curve = '<animate attribute="center"><key frame="1" value="1 0 1"/><key frame="20" value="-1 0.5 -1"/></animate>';
    const text = scene.replace('center="1 0 1.5"', "").replace('magnitude="3000"/>\n  <radial', `magnitude="3000">${curve}</point>\n  <radial`);
    await editing(text, {}, async (hand) => {
      const studio = new Studio(hand);
      await hand.settled();
      await hand.choose("poke");
      const curveOf = (channel) => hand.page.evaluate((path) => Array.from({ length: 24 }, (_, k) => window.pliant.edit.editor.numbersOf(path, k + 1)), channel);
      const before = await curveOf("poke.center");
      await studio.begin(8);
      // One component: the others keep their motion.
      await studio.drag(hand.field("center x"), ways(5, [30, 0]));
      await studio.made("poke.center");
      const first = await hand.command.text();
      const keys = keysOf(first, "poke", "center");
      assert.deepEqual(framesOf(keys), [1, ...range(8, 13), 20]);
      const after = await curveOf("poke.center");
      for (const frame of range(1, 24)) {
        // Before it all is as it was, but for rounding where the curve is divided.
        if (frame <= 8) near(Math.hypot(...after[frame - 1].map((each, k) => each - before[frame - 1][k])), 0, 1e-14, `frame ${frame}`);
        if (frame > 8 && frame <= 13) assert.deepEqual(after[frame - 1].slice(1), before[frame - 1].slice(1), `frame ${frame}`);
        if (frame > 8 && frame <= 13) assert.notEqual(after[frame - 1][0], before[frame - 1][0]);
      }
      await studio.isPlayed(first, 5);
      // Another channel over the first one.
      const center = first.match(/<animate attribute="center">[^]*?<\/animate>/)[0];
      await studio.page.evaluate(() => (window.seen = []));
      await hand.goTo(4);
      await hand.settled();
      await studio.drag(hand.handle("Magnitude of poke"), ways(8, [20, -20]));
      await studio.made("poke.magnitude");
      const second = await hand.command.text();
      assert.ok(second.includes(center));
      assert.deepEqual(framesOf(keysOf(second, "poke", "magnitude")), range(4, 12));
      await studio.isPlayed(second, 8);
      await becomes(studio.account, "poke.magnitude 4–12: 9 keys of 9 frames, over poke.center 8–13");
      // The same one again, in the middle of what was recorded.
      await studio.page.evaluate(() => (window.seen = []));
      await hand.goTo(10);
      await hand.settled();
      await studio.drag(hand.handle("Move poke"), ways(5, [-30, 10]));
      await studio.made("poke.center");
      const third = await hand.command.text();
      assert.deepEqual(framesOf(keysOf(third, "poke", "center")), [1, ...range(8, 15), 20]);
      assert.deepEqual(keysOf(third, "poke", "center").slice(0, 3), keys.slice(0, 3));
      await studio.isPlayed(third, 5);
      for (const back of [second, first, text]) await hand.undo(back);
      assert.equal((await hand.command.document()).undo, "");
      await studio.end();
    });
  });

  test("in the editor, curves that cannot be divided are recorded, and several objects at once", async () => {
    const curve = '<animate attribute="magnitude" after="repeat"><key frame="1" value="0" interpolation="elasticOut"/><key frame="10" value="900"/></animate>';
    const text = scene.replace('<animate attribute="magnitude"><key frame="1" value="0"/><key frame="8" value="900"/><key frame="16" value="0"/></animate>', curve);
    await editing(text, {}, async (hand) => {
      const studio = new Studio(hand);
      await hand.settled();
      await hand.choose("bulge");
      await studio.begin(4);
      const revision = await hand.revision();
      await studio.drag(hand.field("magnitude"), ways(4, [30, 0]));
      await studio.made("bulge.magnitude");
      assert.deepEqual(framesOf(keysOf(await hand.command.text(), "bulge", "magnitude")), [1, ...range(4, 8), 10]);
      // The segment in which it begins has another end now.
      await studio.isPlayed(await hand.command.text(), 4, revision + 1);
      await hand.undo(text);
      await hand.choose("poke", "crease");
      await hand.goTo(6);
      await hand.settled();
      await studio.page.evaluate(() => (window.seen = []));
      await studio.drag(hand.field("magnitude"), ways(4, [30, 0]));
      await studio.made("poke.magnitude, crease.magnitude");
      const both = await hand.command.text();
      const [poke, crease] = ["poke", "crease"].map((name) => keysOf(both, name, "magnitude"));
      assert.deepEqual([framesOf(poke), framesOf(crease)], [range(6, 10), range(6, 10)]);
      // Each has its own value until the hand gives one.
      assert.deepEqual([values(poke)[0], values(crease)[0]], [3000, 500]);
      assert.deepEqual(values(poke).slice(1), values(crease).slice(1));
      await studio.isPlayed(both, 4);
      await becomes(studio.account, "poke.magnitude, crease.magnitude 6–10: 5, 5 keys of 5 frames");
      await hand.undo(text);
      assert.equal((await hand.command.document()).undo, "");
      await studio.end();
    });
  });

  test("in the editor, what cannot be recorded says so, and a refusal takes a recording back", async () => {
    const text = scene
      .replace('center="1 0 1.5"', "")
      .replace('magnitude="3000"/>\n  <radial', 'magnitude="3000"><path attribute="center"><waypoint at="1 0 1"/><waypoint at="0 0 0"/><waypoint at="1 0 -1"/><animate attribute="progress"><key frame="1" value="0"/><key frame="20" value="1"/></animate></path></point>\n  <radial');
    await editing(text, {}, async (hand) => {
      const studio = new Studio(hand);
      const { page } = hand;
      await hand.settled();
      await hand.choose("sheet");
      await studio.begin(3);
      await hand.drag(hand.field("columns"), 20, 0);
      await hand.properties.getByRole("alert").filter({ hasText: "sheet.columns cannot have keys, and is not recorded" }).waitFor();
      await hand.choose("poke");
      await hand.drag(hand.handle("Move poke"), 20, 0);
      await hand.alert("poke.center is moved by a path").waitFor();
      assert.equal(await studio.isRunning(), false);
      // What the command refuses in the end is taken back as a whole.
      const refused = { contentType: "application/vnd.pliant.refusal+json", body: JSON.stringify({ status: 422, errors: [{ message: "not now" }] }) };
      await studio.drag(hand.handle("Magnitude of poke"), ways(3, [20, -20]), {
        before: () => page.route("**/operations", (route) => (route.request().postDataJSON().cancel ? route.continue() : route.fulfill(refused))),
      });
      await hand.alert("not now").waitFor();
      await hand.says(text);
      await page.unroute("**/operations");
      assert.deepEqual([(await hand.command.document()).undo, await studio.account()], ["", ""]);
      // What is no share is no tolerance.
      await studio.tolerance.fill("2");
      await studio.tolerance.press("Enter");
      await studio.bar.getByRole("alert").filter({ hasText: "Tolerance must be from 0 to 1" }).waitFor();
      await studio.tolerance.press("Escape");
      assert.equal(await studio.tolerance.inputValue(), "0");
      await studio.end();
    });
  });

  test("in the editor, recordings are made in windows of all sizes, without a jump", async () => {
    await inStudio(async (studio, hand) => {
      const { page } = hand;
      await hand.choose("poke");
      await studio.begin(1, "0.01");
      for (const [width, height] of [[360, 640], [390, 844], [3840, 2160], [1280, 800], [1000, 600]]) {
        await page.setViewportSize({ width, height });
        await hand.drawn();
        const places = () => page.evaluate(() => ["view", "timeline", "play", "undo", "save"].map((id) => { const { x, y, right, bottom } = document.getElementById(id).getBoundingClientRect(); return [id, x, y, right, bottom]; }));
        const before = await places();
        const box = await studio.bar.boundingBox();
        assert.ok(box.x >= 0 && box.x + box.width <= width, `${width}: ${JSON.stringify(box)}`);
        const isRecorded = [360, 1280].includes(width);
        if (isRecorded) {
          await studio.drag(hand.handle("Force radius of poke"), ways(2, [0, 20]), { frames: 4 });
          await studio.made("poke.forceRadius");
          assert.deepEqual(await places(), before, `${width}`);
        }
        assert.equal(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth), false);
        for (const colorScheme of ["light", "dark"]) {
          await page.emulateMedia({ colorScheme });
          await hand.drawn();
          await page.screenshot({ path: path.join(pictures, `edit-record-${width}-${colorScheme}.png`) });
        }
        if (isRecorded) await hand.undo(scene);
        await hand.press("r");
        assert.equal(await studio.bar.isVisible(), false);
        assert.deepEqual(await places(), before, `${width} off`);
        await hand.press("r");
        await hand.goTo(1);
        await hand.settled();
      }
    });
  });
}
