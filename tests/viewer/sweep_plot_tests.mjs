// Tests of what the page of a sweep says: numbers, axes, colours, reasons; a part of
// sweep_tests.mjs.

import assert from "node:assert/strict";
import { readdirSync, readFileSync, writeFileSync } from "node:fs";

/** The pixels of a PNG, and its size. */
export async function pixelsOfPng(view, png) {
  const { data, ...size } = await view.evaluate(async (base64) => {
    const image = new Image();
    image.src = `data:image/png;base64,${base64}`;
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [image.width, image.height];
    const context = canvas.getContext("2d", { willReadFrequently: true });
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    let text = "";
    for (let k = 0; k < data.length; k += 1 << 14) text += String.fromCharCode(...data.subarray(k, k + (1 << 14)));
    return { width: image.width, height: image.height, data: text };
  }, png.toString("base64"));
  return { ...size, data: Buffer.from(data, "latin1") };
}

export function sweepPlotTests({ test, withPage, near, run, inFolder, sweepPage, page, small, readsPixels, whole, settled }) {
  test("texts of values and ticks tell them apart", async () => {
    const url = sweepPage("apart", small("apart"), ["sheet.damping=1000.01,1000.02,1000.03", "scene.seed=1000001..1000003", "poke.magnitude=0.5:2.5:5"]);
    await withPage(url, {}, async (view) => {
      assert.deepEqual(await view.evaluate(() => window.pliant.sweep.paths.map(({ shortTexts }) => shortTexts)), [
        ["1000.01", "1000.02", "1000.03"], ["1000001", "1000002", "1000003"], ["0.5", "1", "1.5", "2", "2.5"]]);
      for (const width of [700, 1000, 1600]) {
        await view.setViewportSize({ width, height: 900 });
        await view.locator("#plots").scrollIntoViewIfNeeded();
        await settled(view);
        const axes = await view.evaluate(() => window.pliant.plots.plots.slice(0, 3).flatMap(({ element }) => ["x", "y"].map((axis) =>
          [...element.querySelectorAll(`[aria-label="${axis}-axis tick label"] text`)].map((label) => {
            const [x, y] = label.getAttribute("transform").match(/[\d.-]+/g).map(Number);
            return [axis === "x" ? x : y, Number(label.textContent.replaceAll(",", ""))];
          }))));
        for (const ticks of axes) {
          assert.ok(ticks.length > 0 && ticks.length < width / 50, `${ticks.length} at ${width}`);
          assert.equal(new Set(ticks.map(([, number]) => number)).size, ticks.length);
          // Places and numbers have one ratio.
          for (let k = 2; k < ticks.length; ++k) near((ticks[k][1] - ticks[0][1]) / (ticks[1][1] - ticks[0][1]), (ticks[k][0] - ticks[0][0]) / (ticks[1][0] - ticks[0][0]), 1e-2, `${ticks}`);
        }
      }
      assert.deepEqual(await view.locator(".tile .line b").evaluateAll((all) => all.slice(0, 2).map(({ textContent }) => textContent)), ["1000.01", "1000001"]);
    });
  });

  test("values below zero at equal ratios have a logarithmic axis, and extreme ones an axis at all", async () => {
    const url = sweepPage("negative", small("negative"), ["poke.magnitude=-1:-1000:4:log", "sheet.damping=1e-300,1e-150,1,1e10"]);
    await withPage(url, {}, async (view) => {
      await view.locator("#plots").scrollIntoViewIfNeeded();
      await settled(view);
      // Rows with different values, as shares of the plot's width.
      const places = await view.evaluate(() => window.pliant.plots.plots.slice(0, 2).map((plot) =>
        [0, 1, 2, 3].map((k) => plot.placeAt(plot.spec.x.indexOf([...new Set(plot.spec.x)][k])).left / plot.place.clientWidth)));
      for (const each of places) for (const place of each) assert.ok(place > 0 && place < 1, `${place}`);
      const [first, ...rest] = places[0];
      rest.forEach((place, k) => near(place - first, (k + 1) * (rest[0] - first), 1e-6, "a step"));
      assert.ok(first > 0.9);
    });
  });

  test("a take that burst hides no other, wherever it is in the sweep", async () => {
    const url = sweepPage("burst", small("burst"), ["poke.magnitude=1e15,800,900,1000"]);
    await withPage(url, {}, async (view) => {
      assert.match(await view.locator("#sheet-note").textContent(), /1 take so much larger than the rest is not fitted/);
      const [giant, ...others] = await view.evaluate(() => window.pliant.sweep.shapes.map(({ mostDisplaced }) => mostDisplaced));
      assert.ok(giant > 1e6);
      near(await view.evaluate(() => window.pliant.studio.peak), Math.max(...others), 0, "the top colour");
      await whole(view);
      await readsPixels(view);
      const bright = await view.locator(".tile canvas").evaluateAll((canvases) => canvases.map((canvas) => {
        const data = window.pixelsOf(canvas);
        let count = 0;
        for (let k = 0; k < data.length; k += 4) count += data[k] > data[k + 2] + 40 ? 1 : 0; // yellow
        return count;
      }));
      for (const count of bright.slice(1)) assert.ok(count > 50, `${bright}`);
    });
  });

  test("a picture of small takes has all of its scale, and one of large takes has large letters", async () => {
    const url = sweepPage("lettered", small("lettered"), ["poke.magnitude=900"]);
    await withPage(url, {}, async (view) => {
      const inks = {};
      for (const side of [32, 100, 1200]) {
        run("sweep", "view", "lettered", "--png", inFolder("lettered.png"), "--size", `${side}x${side}`, "--quiet");
        const { width, height, data } = await pixelsOfPng(view, readFileSync(inFolder("lettered.png")));
        const at = (x, y) => [...data.subarray(4 * (y * width + x), 4 * (y * width + x) + 3)];
        const text = side < 1000 ? 11 : 48;
        assert.deepEqual([width, height], [Math.max(side, 18 * text), side + 2 * text + (side < 1000 ? 14 : 62) + 6 * text]);
        // Both ends of the scale, and nothing in the margin.
        const inRow = (x, colour) => Array.from({ length: 6 * text }, (_, k) => at(x, height - 1 - k)).filter((each) => each.every((part, k) => Math.abs(part - colour[k]) < 12)).length;
        assert.ok(inRow(text + 1, [0x68, 0x77, 0x8c]) > 4, `the low end at ${side}`);
        assert.ok(inRow(16 * text - 2, [0xff, 0xe0, 0x8a]) > 4, `the high end at ${side}`);
        for (let k = 0; k < 6 * text; ++k) assert.deepEqual(at(width - 1, height - 1 - k), [255, 255, 255]);
        // The rows that the number of the take has.
        let [first, last] = [Infinity, -1];
        for (let y = side; y < side + 2 * text; ++y) {
          for (let x = 0; x < Math.min(side, 3 * text) - 1; ++x) if (at(x, y)[0] < 90) [first, last] = [Math.min(first, y), y];
        }
        inks[side] = last - first + 1;
      }
      assert.ok(inks[100] >= 7 && inks[100] <= 11 && inks[1200] > 3 * inks[100], JSON.stringify(inks));
    });
  });

  test("a browser without WebGL shows plots and table", async () => {
    const url = sweepPage("blind", small("blind"), ["poke.magnitude=100,900", "sheet.damping=1,5"]);
    const before = () => {
      const { getContext } = HTMLCanvasElement.prototype;
      HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
        return kind.includes("webgl") ? null : getContext.call(this, kind, ...more);
      };
    };
    await withPage(url, { before, height: 900 }, async (view) => {
      assert.match(await view.locator("#sheet-note").textContent(), /cannot draw the takes, since it has no WebGL 2/);
      assert.equal(await view.locator(".tile canvas").first().isVisible(), false);
      assert.equal(await view.locator("#legend").isVisible(), false);
      await view.locator(".tile").nth(3).click();
      assert.equal(await view.locator("#details .picture").isVisible(), false);
      assert.match(await view.locator("#details code").textContent(), / 3 -o take3\.glb$/);
      assert.equal(await view.locator("#table tr.kept td").first().textContent(), "3");
      await readsPixels(view);
      await view.locator(".plot").first().scrollIntoViewIfNeeded();
      await settled(view);
      const colours = await view.locator(".plot canvas").first().evaluate((canvas) => new Set(new Uint32Array(window.pixelsOf(canvas).buffer)).size);
      assert.ok(colours > 20, `${colours} colours`);
    });
  });

  test("takes that failed are told with their reasons, the most frequent first", async () => {
    const url = sweepPage("reasons", small("reasons"), ["sheet.c=-5,0,-6", "poke.magnitude=1,2,1e200"], { code: 1 });
    await withPage(url, { width: 820 }, async (view) => {
      assert.deepEqual(await view.locator("#messages .message").evaluateAll((all) => all.map((each) => each.querySelector("span").textContent.replace(/:.*(c is|peak)/, ": $1").replace(/, but.*/, ""))),
        ["take 0 and 2 more failed: c is -5", "take 6 and 2 more failed: c is -6", "take 5 failed: peak is too large for a number"]);
      // How many there are is in the head of a narrow window too.
      const summary = view.locator("#summary");
      assert.equal(await summary.textContent(), "9 takes · 2 done · 7 failed");
      assert.ok(await summary.evaluate((element) => element.clientWidth > 0 && element.scrollWidth <= element.clientWidth));
      // Those without a picture are told once, not each.
      run("sweep", "run", inFolder("reasons.xml"), "-o", inFolder("unseen"), "--vary", "sheet.damping=1..5", "--quiet");
      const log = readdirSync(inFolder("unseen/log")).map((name) => inFolder(`unseen/log/${name}`));
      for (const file of log) writeFileSync(file, readFileSync(file, "utf8").replace(/"peak":[^,]*/g, '"peak":0.5'));
    });
    await withPage(page("unseen", [], 1), {}, async (view) => {
      const texts = await view.locator("#messages .message.error span").allTextContents();
      assert.equal(texts.length, 4);
      assert.match(texts[0], /^take 0 has no picture: its peak is /);
      assert.equal(texts[3], "takes have no picture for 2 more reasons; point at one to see it");
    });
  });

  test("keys alone choose takes, turn the camera, sort and copy", async () => {
    const url = sweepPage("keyed", small("keyed"), ["sheet.damping=1:40:40"]);
    await withPage(`${url}#take=3`, { width: 1000, height: 500 }, async (view) => {
      const kept = () => view.evaluate(() => window.pliant.pointing.keptRow);
      assert.equal(await kept(), 3);
      await view.evaluate(() => (location.hash = "take=7"));
      await view.waitForFunction(() => window.pliant.pointing.keptRow === 7);
      await view.keyboard.press("ArrowRight");
      assert.equal(await kept(), 8);
      assert.match(await view.locator("#said").textContent(), /^take 8, damping 9, peak 0\.\d+, peakFrame \d+, .*settle \d+$/);
      // The picture of a take that keys choose comes into the window.
      for (let k = 0; k < 25; ++k) await view.keyboard.press("ArrowRight");
      const box = await view.locator(".tile.pointed").boundingBox();
      assert.ok(box.y > 0 && box.y + box.height < 501, `${box.y}`);
      // In the table, arrows up and down do so, and the others show its other columns.
      await view.locator("#table").focus();
      await view.keyboard.press("ArrowUp");
      assert.equal(await kept(), 32);
      await view.keyboard.press("ArrowRight");
      await view.waitForFunction(() => document.getElementById("table").scrollLeft > 0);
      assert.equal(await kept(), 32);
      const pictures = () => view.evaluate(() => [".tile.pointed canvas", "#details canvas"].map((each) => document.querySelector(each).toDataURL()));
      await whole(view);
      await settled(view);
      let before = await pictures();
      const turned = async (how) => {
        await how();
        await view.waitForTimeout(300);
        const after = await pictures();
        for (const k of [0, 1]) assert.notEqual(after[k], before[k], `${k}`);
        before = after;
      };
      for (const key of ["ArrowLeft", "ArrowUp", "ArrowRight", "ArrowDown"]) await turned(() => view.keyboard.press(`Shift+${key}`));
      assert.equal(await kept(), 32);
      // A drag turns both as well; one that ends elsewhere does not swallow the next click.
      await view.locator(".tile").nth(32).scrollIntoViewIfNeeded();
      const tile = await view.locator(".tile").nth(32).boundingBox();
      await turned(async () => {
        await view.mouse.move(tile.x + 30, tile.y + 30);
        await view.mouse.down();
        await view.mouse.move(20, 15, { steps: 5 });
        await view.mouse.up();
      });
      await view.locator(".tile").nth(31).focus();
      await view.keyboard.press("Enter");
      assert.equal(await kept(), 31);
      // Both orders of each column are in the list.
      const head = view.locator("#table th button").first();
      await head.focus();
      await view.keyboard.press("Enter");
      assert.equal(await view.locator("#order").evaluate((list) => list.selectedOptions[0].text), "take, falling");
      await view.keyboard.press("Enter");
      assert.equal(await view.locator("#order").evaluate((list) => list.selectedOptions[0].text), "take");
      await view.keyboard.press("c");
      await view.waitForFunction(() => /Copied|Press Ctrl/.test(document.getElementById("said").textContent));
      // What has the focus shows it.
      for (const place of ["#theme", ".tile", "#order", "#table", "#table th button"]) {
        await view.locator(place).first().focus();
        await view.keyboard.press("Tab");
        const { width, style } = await view.evaluate(() => ({ width: parseFloat(getComputedStyle(document.activeElement).outlineWidth), style: getComputedStyle(document.activeElement).outlineStyle }));
        assert.ok(width >= 2 && style === "solid", `after ${place}`);
      }
    });
  });

  test("plots say what their axes and colours are", async () => {
    const url = sweepPage("shaded", small("shaded"), ["poke.magnitude=1:1000:10:log", "sheet.damping=1:5:9"]);
    await withPage(url, { width: 1000, height: 900 }, async (view) => {
      assert.deepEqual(await view.locator(".plot figcaption small").allTextContents(),
        ["scene units", "frame", "scene units", "scene units", "scene units/s", "scene units²/s²", "frame"].flatMap((unit) => [`[${unit}]`, `[${unit}]`]));
      assert.equal(await view.locator(".plot [role=img]").nth(1).getAttribute("aria-label"), "peak [scene units]: the largest displacement, over sheet.damping");
      assert.deepEqual(await view.locator(".plots .column span").allTextContents(), ["damping 1 5", "magnitude 1 1000"]);
      // More lines than the palette has colours have shades in the order of their values, which stand out from the panel.
      for (const theme of ["dark", "light"]) {
        await view.evaluate((name) => window.pliant.themes.choose(name), theme);
        const { shades, panel } = await view.evaluate(() => ({
          shades: window.pliant.plots.plots[0].spec.lines.map(({ colour }) => colour(window.pliant.themes.palette)), panel: window.pliant.themes.palette.panel }));
        const light = (parts) => parts.map((part) => part / 255).map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4)).reduce((sum, part, k) => sum + part * [0.2126, 0.7152, 0.0722][k], 0);
        const ground = light([1, 3, 5].map((k) => parseInt(panel.slice(k, k + 2), 16)));
        const lights = shades.map((shade) => light(shade.match(/\d+/g).map(Number)));
        assert.equal(new Set(shades).size, 9);
        // Hues differ where the lightness hardly does.
        for (let k = 2; k < 9; ++k) assert.ok(lights[k] > lights[k - 2], `${theme} ${lights}`);
        for (const each of lights) assert.ok((Math.max(each, ground) + 0.05) / (Math.min(each, ground) + 0.05) >= 3, `${theme}: ${each} on ${ground}`);
      }
      // The line of the take that is pointed at is drawn again, thicker, through its mark.
      await view.locator(".plot").first().scrollIntoViewIfNeeded();
      await settled(view);
      await view.evaluate(() => window.pliant.pointing.keep(8, "test"));
      const { d, stroke, colour, at } = await view.evaluate(() => {
        const { spec, element, places } = window.pliant.plots.plots[0];
        const path = [...element.querySelectorAll("svg:last-child path")].pop();
        return { d: path.getAttribute("d"), stroke: path.getAttribute("stroke"), colour: spec.lines[8].colour(window.pliant.themes.palette), at: [...places.slice(16, 18)] };
      });
      assert.equal(stroke, colour);
      assert.match(d, /^M[^ML]+(L[^ML]+){9}$/);
      assert.ok(d.startsWith(`M${at[0]} ${at[1]}`), `${d}, ${at}`);
      await view.keyboard.press("Escape");
      assert.equal(await view.locator(".plot svg:last-child *").count(), 0);
      // Heat maps over decades have a logarithmic scale as well, which can be chosen.
      await view.locator("#kind span").nth(1).click();
      const shares = () => view.evaluate(() => {
        const [map] = window.pliant.plots.plots;
        return Array.from({ length: 10 }, (_, k) => map.shareOf(map.means[9 * k]));
      });
      (await shares()).forEach((share, k, all) => near(share - all[0], (k * (all[9] - all[0])) / 9, 1e-2, `step ${k}`));
      await view.locator("#measure-scale").selectOption("linear");
      const [, second, ...rest] = await shares();
      assert.ok(second < 0.01 && rest[7] > 0.9);
      assert.match(await view.locator(".plot [role=img]").first().getAttribute("aria-label"), /^peak \[scene units\]: .*, across sheet\.damping, up poke\.magnitude, from \S+ to \S+$/);
    });
  });

  test("a take that does not move hides no decades of the others", async () => {
    const url = sweepPage("still", small("still"), ["poke.magnitude=0,1,10,100,1000", "sheet.damping=1,5"]);
    await withPage(url, { height: 900 }, async (view) => {
      assert.match(await view.locator("#plots-note").textContent(), /Logarithmic axes have no place for zeros\.$/);
      await view.locator("#plots-part").scrollIntoViewIfNeeded();
      await settled(view);
      const places = await view.evaluate(() => [0, 2, 4, 6, 8].map((row) => window.pliant.plots.plots[0].placeAt(row)?.top));
      assert.equal(places[0], undefined);
      for (let k = 2; k < 5; ++k) near(places[k] - places[k - 1], places[2] - places[1], 0.1, "a decade");
      await view.evaluate(() => window.pliant.pointing.keep(0, "test"));
      await settled(view);
      assert.equal(await view.locator(".plot").first().locator("svg circle").count(), 0);
      assert.equal(await view.locator(".plot").first().locator("figcaption b").textContent(), "0");
      await view.locator("#measure-scale").selectOption("linear");
      await settled(view);
      assert.ok(await view.evaluate(() => window.pliant.plots.plots[0].placeAt(0).top) > 0);
      assert.doesNotMatch(await view.locator("#plots-note").textContent(), /zeros/);
    });
  });
}
