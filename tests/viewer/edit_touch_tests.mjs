// Tests of the form of the page of `pliant edit`: fingers, windows of all sizes, the keyboard alone; a part of edit_tests.mjs.

import assert from "node:assert/strict";
import { statSync, writeFileSync } from "node:fs";
import path from "node:path";

import { becomes, until } from "./edit_command.mjs";

/** Fingers on a page; each moves from its first to its last place, given as [x, y]. */
async function fingers(page, ...ways) {
  const link = await page.context().newCDPSession(page);
  const touch = (type, share) => link.send("Input.dispatchTouchEvent", { type, touchPoints: share === null ? [] : ways.map(([from, to], id) => ({ id, x: from[0] + share * (to[0] - from[0]), y: from[1] + share * (to[1] - from[1]) })) });
  return {
    down: () => touch("touchStart", 0),
    at: (share) => touch("touchMove", share),
    async move(steps = 8) {
      for (let k = 1; k <= steps; ++k) await touch("touchMove", k / steps);
    },
    up: () => touch("touchEnd", null),
  };
}

/** What is smaller than that on a page, or in labels. */
const small = (page, least) =>
  page.locator("button, select, input, summary, [aria-expanded] > .item > .twisty").evaluateAll((all, [width, height]) =>
    all.map((each) => [each, (each.closest("label") ?? each).getBoundingClientRect()])
      .filter(([each, box]) => box.width > 0 && !each.closest(".timeline-keys") && (box.height < height || box.width < (each.matches(".twisty, [type=checkbox]") ? height : width)))
      .map(([each, box]) => `${each.ariaLabel || each.textContent.trim() || each.className}: ${box.width} x ${box.height}`), least);

export function editTouchTests({ test, run, inFolder, near, pictures, scene, editing, onScene }) {
  const phone = { width: 390, height: 844, hasTouch: true, isMobile: true };

  test("in the editor, a finger does everything in a narrow window", async () => {
    await editing(scene, phone, async (hand) => {
      const { page, button, menu } = hand;
      const spot = async (locator) => { const { x, y } = await hand.middle(locator); return [x, y]; };
      const swipe = async (...ways) => {
        const hands = await fingers(page, ...ways);
        await hands.down();
        await hands.move();
        await hands.up();
      };
      const longPress = async (at) => {
        const hands = await fingers(page, [at, at]);
        await hands.down();
        await menu.waitFor();
        await hands.up();
      };
      await hand.settled();
      assert.equal(await hand.tree.count(), 0);
      await button("Objects").tap();
      assert.equal(await button("Objects").getAttribute("aria-expanded"), "true");
      assert.deepEqual(await small(page, [24, 40]), []);
      await hand.row("poke").tap();
      await becomes(hand.selected, ["poke"]);
      await page.screenshot({ path: path.join(pictures, "edit-narrow-objects.png") });
      await longPress(await spot(hand.row("poke")));
      assert.equal(await hand.entry("Rename").isVisible(), true);
      await page.getByRole("heading", { name: "Objects" }).tap();
      await becomes(() => menu.count(), 0);
      await button("Properties").tap();
      assert.equal(await button("Objects").getAttribute("aria-expanded"), "false");
      await becomes(() => hand.field("magnitude").inputValue(), "3000");
      assert.deepEqual(await small(page, [24, 40]), []);
      await page.screenshot({ path: path.join(pictures, "edit-narrow-properties.png") });
      // A long press is the right click, and what leaves afterwards presses nothing.
      await longPress(await spot(hand.field("magnitude")));
      await page.screenshot({ path: path.join(pictures, "edit-narrow-menu.png") });
      await hand.entry("Reset").tap();
      await until(async () => !(await hand.command.text()).includes('magnitude="3000"/>\n  <radial'), "reset");
      await button("Undo").tap();
      await hand.says(scene);
      await hand.settled();
      // Sideways it scrubs.
      const field = await spot(hand.field("magnitude"));
      await swipe([field, [field[0] + 40, field[1]]]);
      await until(async () => /name="poke".*magnitude="4\d00"/.test(await hand.command.text()), "a scrub");
      await button("Undo").tap();
      await hand.says(scene);
      await hand.settled();
      // Slowly, too: that is no long press.
      const slow = await fingers(page, [field, [field[0] + 12, field[1]]]);
      await slow.down();
      await slow.move(3);
      await page.evaluate(() => new Promise((resume) => setTimeout(resume, 600)));
      assert.equal(await menu.count(), 0);
      await slow.up();
      await until(async () => (await hand.command.text()) !== scene, "a slow scrub");
      await button("Undo").tap();
      await hand.says(scene);
      await button("Properties").tap();
      await hand.settled();
      // A finger drags a handle, which is large enough, and beside it turns the view.
      const move = hand.handle("Move poke");
      const { width, height } = await move.boundingBox();
      assert.ok(width >= 40 && height >= 40, `${width} x ${height}`);
      const from = await spot(move);
      await swipe([from, [from[0] + 40, from[1] + 10]]);
      await until(async () => (await hand.command.text()) !== scene, "a drag");
      await hand.settled();
      assert.equal((await hand.command.text()).replace(/(name="poke" center=)"[^"]*"/, '$1"1 0 1.5"'), scene);
      const to = await spot(move);
      near(Math.hypot(to[0] - from[0] - 40, to[1] - from[1] - 10), 0, 3, "distance from the finger");
      await button("Undo").tap();
      await hand.says(scene);
      await hand.settled();
      // Its menu has the axes.
      await longPress(await spot(move));
      await hand.entry("Drag along x").tap();
      await becomes(() => menu.count(), 0);
      const start = await spot(move);
      await swipe([start, [start[0] + 40, start[1] + 25]]);
      await until(async () => /name="poke" center="(?!1 )\S+ 0 1.5"/.test(await hand.command.text()), "a drag along x");
      await button("Undo").tap();
      await hand.says(scene);
      await hand.settled();
      const camera = () => page.evaluate(() => window.pliant.stage.camera.position.toArray());
      const apart = (a, b) => Math.hypot(...a.map((each, k) => each - b[k]));
      const canvas = await hand.view.boundingBox();
      const [x, y] = [canvas.x + 40, canvas.y + canvas.height - 120];
      const before = await camera();
      await swipe([[x, y], [x + 80, y]]);
      await hand.drawn();
      const turned = await camera();
      assert.ok(apart(before, turned) > 0.1);
      near(Math.hypot(...turned) / Math.hypot(...before), 1, 0.2, "its distance");
      await swipe([[x, y], [x - 30, y]], [[x + 120, y], [x + 220, y]]);
      await hand.drawn();
      assert.ok(apart(turned, await camera()) > 0.1, "two fingers zoom");
      assert.equal(await page.evaluate(() => visualViewport.scale), 1);
      await hand.says(scene);
      assert.deepEqual(await hand.selected().catch(() => ["poke"]), []);
      // Everything is large enough for a finger.
      await button("More").tap();
      await button("Display").tap();
      assert.deepEqual(await small(page, [24, 40]), []);
    });
  });

  test("in the editor, a finger records a handle while time runs", async () => {
    await editing(scene, phone, async (hand) => {
      const { page, button } = hand;
      await hand.settled();
      await button("Objects").tap();
      await hand.row("poke").tap();
      await becomes(hand.selected, ["poke"]);
      await button("Objects").tap();
      await button("More").tap();
      await button("Record").tap();
      const tolerance = page.getByRole("spinbutton", { name: "Tolerance" });
      await tolerance.tap();
      await tolerance.fill("0");
      await tolerance.press("Enter");
      await page.evaluate(() => {
        window.clock = performance.now();
        performance.now = () => window.clock;
        document.activeElement.blur();
      });
      await hand.goTo(5);
      await hand.settled();
      const { x, y } = await hand.middle(hand.handle("Move poke"));
      const finger = await fingers(page, [[x, y], [x + 60, y - 40]]);
      const frames = () => page.evaluate(() => window.pliant.edit.editor.recorder.frames);
      await finger.down();
      for (let k = 1; k <= 4; ++k) {
        await finger.at(k / 4);
        await hand.drawn();
        await page.evaluate(() => (window.clock += 1001 / 24));
        await becomes(frames, [5, 5 + k]);
      }
      await becomes(async () => (await hand.state()).split(" · ")[0], "recording poke.center");
      await page.screenshot({ path: path.join(pictures, "edit-narrow-recording.png") });
      await finger.up();
      await becomes(async () => (await hand.command.document()).undo, "record poke.center");
      await becomes(() => page.getByRole("status", { name: "Recorded" }).textContent(), "poke.center 5–9: 5 keys of 5 frames");
      await hand.settled();
      const keys = [...(await hand.command.text()).match(/name="poke"[^]*?<\/point>/)[0].matchAll(/<key frame="(\d+)" value="([^"]*)"/g)];
      assert.deepEqual(keys.map(([, frame]) => Number(frame)), [5, 6, 7, 8, 9]);
      assert.equal(new Set(keys.map(([, , value]) => value)).size, 5);
      // The handle is under the finger.
      const there = await hand.middle(hand.handle("Move poke"));
      near(Math.hypot(there.x - x - 60, there.y - y + 40), 0, 3, "distance from the finger");
      await button("Undo").tap();
      await hand.says(scene);
      assert.equal((await hand.command.document()).undo, "");
    });
  });

  test("in the editor, everything is reached in windows of all sizes, and nothing sticks out or jumps", async () => {
    await editing(scene, { width: 1280 }, async (hand) => {
      const { page, button } = hand;
      await hand.settled();
      await hand.choose("poke");
      const isInside = async (locator, width, height) => {
        if (!(await locator.isVisible())) return false;
        const box = await locator.boundingBox();
        return box.x >= 0 && box.y >= 0 && box.x + box.width <= width + 0.5 && box.y + box.height <= height + 0.5;
      };
      for (const [width, height] of [[360, 640], [390, 844], [719, 600], [899, 700], [900, 600], [1280, 800], [3840, 2160]]) {
        await page.setViewportSize({ width, height });
        await hand.drawn();
        const what = `${width} x ${height}`;
        const scrolls = () => page.evaluate(() => document.documentElement.scrollWidth > innerWidth);
        assert.equal(await scrolls(), false, what);
        for (const name of ["Undo", "Redo", "Save", "Play"]) assert.equal(await isInside(button(name), width, height), true, `${name} at ${what}`);
        const more = button("More");
        const hasMore = await more.isVisible();
        if (hasMore) await more.click();
        for (const name of ["New…", "Export…", "Auto-key", "Record", "Text", "Curves", "Display", "Frame"]) assert.equal(await isInside(button(name), width, height), true, `${name} at ${what}`);
        if (hasMore) await hand.press("Escape");
        for (const [name, part] of [["Objects", hand.tree], ["Properties", hand.properties]]) {
          const toggle = button(name);
          const isNarrow = await toggle.isVisible();
          assert.equal(isNarrow, width < 900, what);
          if (isNarrow) await toggle.click();
          const box = await part.boundingBox();
          assert.ok(box.x >= 0 && box.x + box.width <= width + 0.5 && box.y < height, `${name} at ${what}`);
          assert.equal(await scrolls(), false, what);
          if (isNarrow) await toggle.click();
        }
        await button(hasMore ? "More" : "Export…").click();
        if (hasMore) await button("Export…").click();
        assert.equal(await isInside(hand.dialog("Export"), width, height), true, what);
        await hand.press("Escape");
        // Messages come and go without a jump.
        const places = () => page.evaluate(() => ["view", "timeline", "play", "undo", "save", "legend"].map((id) => { const { x, y, right, bottom } = document.getElementById(id).getBoundingClientRect(); return [id, x, y, right, bottom]; }));
        const before = await places();
        await page.evaluate(() => window.pliant.edit.editor.say("Something long that the command refuses for a reason that takes many words ".repeat(6)));
        assert.deepEqual(await places(), before, what);
        assert.equal(await scrolls(), false, what);
        await page.evaluate(() => window.pliant.edit.editor.say(""));
        if (width === 1280) {
          await button("Display").click();
          assert.deepEqual(await small(page, [24, 24]), []);
          await button("Display").click();
        }
        if ([390, 1280, 3840].includes(width)) {
          for (const colorScheme of width < 2000 ? ["light", "dark"] : ["dark"]) {
            await page.emulateMedia({ colorScheme });
            await hand.drawn();
            await page.screenshot({ path: path.join(pictures, `edit-${width}-${colorScheme}.png`) });
          }
        }
      }
      await hand.says(scene);
    });
  });

  test("in the editor, the keyboard alone is enough, and shows where it is", async () => {
    await editing(scene, {}, async (hand) => {
      const { page, press } = hand;
      await hand.settled();
      const here = () => page.evaluate(() => {
        const { activeElement: at } = document;
        const name = at.getAttribute("aria-label") ?? at.labels?.[0]?.textContent ?? at.textContent.trim();
        const isShown = [at, at.firstElementChild].some((each) => { if (!each) return false; const { outlineStyle, outlineWidth, boxShadow } = getComputedStyle(each); return (outlineStyle !== "none" && outlineWidth !== "0px") || boxShadow !== "none"; });
        return { name, isShown, isBody: at === document.body };
      });
      const reached = new Map();
      const to = async (name) => {
        for (let k = 0; ; ++k) {
          const now = await here();
          if (!now.isBody) reached.set(now.name, now.isShown);
          if (now.name === name) return;
          assert.ok(k < 150, `${name} is not among ${[...reached.keys()].join(", ")}`);
          await press("Tab");
        }
      };
      await to("sheet");
      for (let k = 0; (await hand.focused()) !== "poke"; ++k) {
        assert.ok(k < 9);
        await press("ArrowDown");
      }
      await becomes(hand.selected, ["poke"]);
      await hand.drawn();
      await to("Move poke");
      await press("ArrowRight");
      await until(async () => (await hand.command.text()) !== scene, "a handle by arrow keys");
      await hand.undo(scene);
      await hand.settled();
      await to("Magnitude of poke");
      await press("ArrowUp");
      await until(async () => /name="poke".*magnitude="(?!3000")/.test(await hand.command.text()), "a magnitude");
      await hand.undo(scene);
      await hand.settled();
      await to("Key magnitude");
      await press("Space");
      await becomes(() => hand.pressed(hand.key("magnitude")), "true");
      await hand.undo(scene);
      await to("magnitude");
      await page.keyboard.type("5*5");
      await press("Enter");
      await hand.says(scene.replace('magnitude="3000"/>\n  <radial', 'magnitude="25"/>\n  <radial'));
      await hand.followed();
      await to("Undo");
      await press("Enter");
      await hand.says(scene);
      // The focus stays, and pressing it once more does nothing.
      await hand.followed();
      await press("Enter");
      await hand.followed();
      assert.deepEqual([await hand.focused(), await hand.command.text()], ["Undo", scene]);
      await to("Export…");
      await press("Enter");
      await hand.dialog("Export").waitFor();
      await press("Escape");
      await to("Text");
      await press("Enter");
      await to("Lines");
      await press("Escape");
      await to("Play");
      assert.deepEqual([...reached].filter(([, isShown]) => !isShown).map(([name]) => name), []);
    });
  });

  test("the page of the editor is at most 1.3 times as large as the viewer's", async () => {
    writeFileSync(inFolder("small.xml"), '<scene version="1" start="1" end="1"><surface name="s"><grid columns="3" rows="3"/></surface></scene>');
    run("view", "small.xml", "-o", "small.html", "--quiet");
    await onScene(async ({ command }) => {
      const { length } = Buffer.from(await (await fetch(command.url)).arrayBuffer());
      assert.ok(length <= 1.3 * statSync(inFolder("small.html")).size, `${length} bytes`);
    });
  });
}
