// Tests of pages of `pliant sweep view`; a part of viewer_test.mjs.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, readdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import path from "node:path";

import { pixelsOfPng, sweepPlotTests } from "./sweep_plot_tests.mjs";

const scene = (attributes = "", grid = 'columns="13" rows="13"') => `<scene version="1" start="1" end="12"><surface name="sheet"><grid ${grid} width="10" depth="10"/>
  <material damping="5" ${attributes}/></surface><point name="poke" center="0 0 0" deformationRadius="4" forceRadius="2.5" magnitude="900"/></scene>`;

export function sweepTests({ test, run, inFolder, example, withPage, readNpy, near, pictures, pliant, folder }) {
  /** Runs a sweep and makes its page. */
  function sweepPage(name, file, vary, { viewOptions = [], code = 0 } = {}) {
    try {
      run("sweep", "run", file, "-o", inFolder(name), ...vary.flatMap((each) => ["--vary", each]), "--quiet");
      assert.equal(code, 0);
    } catch (error) {
      assert.equal(error.status, code); // some takes fail
    }
    return page(name, viewOptions);
  }
  function page(name, options = [], code = 0) {
    const out = inFolder(`${name.replace(/\W/g, "")}.html`);
    try {
      run("sweep", "view", name, "-o", out, "--quiet", ...options); // the name as typed: relative to the folder
      assert.equal(code, 0);
    } catch (error) {
      assert.equal(error.status, code);
    }
    return `file://${out}`;
  }
  function small(name, attributes, grid) {
    writeFileSync(inFolder(`${name}.xml`), scene(attributes, grid));
    return inFolder(`${name}.xml`);
  }
  // Pixels are read from a copy: the page's own canvases are not made for it.
  const readsPixels = (view) => view.evaluate(() => {
    window.pixelsOf = (canvas) => {
      const copy = document.createElement("canvas");
      [copy.width, copy.height] = [canvas.width, canvas.height];
      const context = copy.getContext("2d", { willReadFrequently: true });
      context.drawImage(canvas, 0, 0);
      return context.getImageData(0, 0, copy.width, copy.height).data;
    };
  });
  const whole = (view) => view.waitForFunction(() => document.documentElement.dataset.whole === "true");
  const settled = (view) => view.evaluate(() => new Promise((resume) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(resume, 50)))));

  sweepPlotTests({ test, withPage, near, run, inFolder, sweepPage, page, small, readsPixels, whole, settled });

  test("a sweep of a hundred takes is one page below 20 MB", async () => {
    const url = sweepPage("hundred", example("sheet"), ["sheet.damping=5:100:10:log", "sheet.density=1:4:10"]);
    const { size } = statSync(url.slice("file://".length));
    assert.ok(size < 3e6, `${size} bytes`);
    await withPage(url, { width: 1280, height: 800 }, async (view) => {
      const ready = await view.evaluate(() => performance.getEntriesByName("ready")[0].startTime);
      console.log(`        ready after ${ready.toFixed(0)} ms`); // said, not tested: it is the machine's
      await whole(view);
      await readsPixels(view);
      // No picture is blank, and two at the ends of the sweep differ.
      const sums = await view.locator(".tile canvas").evaluateAll((canvases) => canvases.map((canvas) => {
        const data = window.pixelsOf(canvas);
        const colours = new Set();
        let sum = 0;
        for (let k = 0; k < data.length; k += 4) {
          colours.add((data[k] << 16) | (data[k + 1] << 8) | data[k + 2]);
          sum += data[k] * (k % 9973);
        }
        return { colours: colours.size, sum };
      }));
      assert.equal(sums.length, 100);
      for (const { colours } of sums) assert.ok(colours > 200, `${colours} colours`);
      assert.ok(new Set(sums.map(({ sum }) => sum)).size > 60);
      for (const [width, colorScheme] of [[1280, "dark"], [1920, "light"]]) {
        await view.setViewportSize({ width, height: 1000 });
        await view.emulateMedia({ colorScheme });
        for (const part of colorScheme === "dark" ? ["takes", "plots", "table"] : ["takes", "plots"]) {
          await view.evaluate((id) => document.getElementById(id).scrollIntoView(), `${part}-part`);
          await settled(view);
          await view.screenshot({ path: path.join(pictures, `sweep-${part}-${colorScheme}.png`) });
        }
      }
    });
  });

  test("the colours of takes reach the largest peak of the sweep, at whichever frame they are shown", async () => {
    const url = sweepPage("early", small("early"), ["poke.magnitude=900,1500"], { viewOptions: ["--frame", "1"] });
    await withPage(url, {}, async (view) => {
      const { peaks, shown, high } = await view.evaluate(() => ({
        peaks: [...window.pliant.sweep.measures[0].values],
        shown: window.pliant.sweep.shapes.map(({ mostDisplaced }) => mostDisplaced),
        high: Number(document.getElementById("legend-high").textContent),
      }));
      assert.ok(Math.max(...shown) < 0.9 * Math.max(...peaks), "the frame is not that of the peak");
      near(high, Math.max(...peaks), 1e-3 * high, "the top colour");
    });
  });

  test("takes stand where a bake has them, coloured by their displacement", async () => {
    // At an angle, and with vertices that a coarser mesh leaves out.
    writeFileSync(inFolder("bent.xml"), scene().replace("<material", '<transform rotate="20 30 0" translate="3 0 100"/><material').replace('center="0 0 0"', 'center="3 0 100"').replace('columns="13" rows="13"', 'columns="121" rows="151"'));
    const url = sweepPage("bent", inFolder("bent.xml"), ["poke.magnitude=900,-200"]);
    run("sweep", "bake", "bent", "1", "-o", "bent.npy");
    const { shape, numbers } = readNpy(inFolder("bent.npy"));
    await withPage(url, {}, async (view) => {
      const { frame, vertices, shown, positions, displaced, most, origin, triangles } = await view.evaluate(() => {
        const { sweep } = window.pliant;
        const take = sweep.shapes[1];
        const { positions, displaced } = take.unpack();
        return { frame: take.frame, vertices: take.vertices, shown: take.shown, positions: [...positions], displaced: [...displaced], most: take.mostDisplaced, origin: sweep.origin, triangles: [...take.triangles] };
      });
      assert.ok(most > 0.1, `${most}`);
      assert.deepEqual([vertices, shape[1]], [121 * 151, 121 * 151]);
      assert.ok(shown <= 15_000 && shown > 5000, `${shown} vertices`);
      assert.ok(triangles.every((corner) => corner < shown) && triangles.length > 3 * shown);
      const at = (f, vertex) => [0, 1, 2].map((k) => numbers[(f * vertices + vertex) * 3 + k]);
      // Each vertex shown is one of the bake at that frame, displaced as far from the first frame, which is at rest.
      const places = new Map();
      const key = (p) => p.map((each) => Math.round(each * 100)).join();
      for (let vertex = 0; vertex < vertices; ++vertex) {
        const place = at(frame - 1, vertex);
        for (const x of [-1, 0, 1]) for (const y of [-1, 0, 1]) for (const z of [-1, 0, 1]) {
          const near = key([place[0] + x / 100, place[1] + y / 100, place[2] + z / 100]);
          places.set(near, [...(places.get(near) ?? []), vertex]);
        }
      }
      const used = new Set();
      for (let k = 0; k < shown; k += 7) {
        const place = [0, 1, 2].map((c) => positions[3 * k + c] + origin[c]);
        const found = (places.get(key(place)) ?? []).find((vertex) => Math.hypot(...at(frame - 1, vertex).map((each, c) => each - place[c])) < 2e-3);
        assert.notEqual(found, undefined, `vertex ${k}`);
        used.add(found);
        const moved = Math.hypot(...at(frame - 1, found).map((each, c) => each - at(0, found)[c]));
        near(displaced[k], moved, 1e-4 * most + 1e-9, `displacement of ${k}`);
      }
      assert.ok(used.size > shown / 8);
    });
  });

  test("a take that is pointed at is seen in all parts, with its command", async () => {
    const name = "it's a <b>sweep";
    const url = sweepPage(name, small("pointed"), ["sheet.damping=1,5,25", "sheet.density=1,2,3,4"]);
    await withPage(url, { width: 1280, height: 900 }, async (view) => {
      await whole(view);
      await readsPixels(view);
      assert.equal(await view.locator("#sweep-name").textContent(), name);
      assert.equal(await view.locator("#summary").textContent(), "12 takes · 12 done");
      await view.locator(".tile").nth(7).hover();
      const marked = async () => ({
        tiles: await view.locator(".tile.pointed .head b").allTextContents(),
        rows: await view.locator("#table tr.pointed td:first-child").allTextContents(),
        title: await view.locator("#details h2").evaluate((element) => element.firstChild.textContent),
      });
      assert.deepEqual(await marked(), { tiles: ["7"], rows: ["7"], title: "Take 7" });
      const command = await view.locator("#details code").textContent();
      assert.equal(command, "pliant sweep bake 'it'\\''s a <b>sweep' 7 -o take7.glb");
      // A shell runs it as it stands.
      execFileSync("/bin/sh", ["-c", command], { cwd: folder, env: { ...process.env, PATH: `${path.dirname(pliant)}:${process.env.PATH}` } });
      assert.ok(readdirSync(folder).includes("take7.glb"));
      // The plots say its number and mark it; at its mark, the pointer finds it again.
      await view.locator("#plots").scrollIntoViewIfNeeded();
      const plot = view.locator(".plot").first();
      await plot.scrollIntoViewIfNeeded();
      await view.evaluate(() => window.pliant.pointing.keep(window.pliant.sweep.row(7), "test"));
      await settled(view);
      const peak = await view.evaluate(() => window.pliant.sweep.measures[0].values[7]);
      near(Number(await plot.locator("figcaption b").textContent()), peak, 1e-5 * peak, "the peak at the plot");
      const mark = await plot.locator("svg circle").last().evaluate((circle) => {
        const box = circle.getBoundingClientRect();
        return { x: box.left + box.width / 2, y: box.top + box.height / 2 };
      });
      // Its point is there, in the fourth colour of the dark theme, as its density is the fourth.
      const point = await plot.locator("canvas").evaluate((canvas, { x, y }) => {
        const box = canvas.getBoundingClientRect();
        const [column, row] = [Math.floor(((x - box.left) / box.width) * canvas.width), Math.floor(((y - box.top) / box.height) * canvas.height)];
        return [...window.pixelsOf(canvas).slice(4 * (row * canvas.width + column), 4 * (row * canvas.width + column) + 3)];
      }, mark);
      assert.deepEqual(point, [0x80, 0xff, 0xff]);
      await view.keyboard.press("Escape");
      await view.mouse.move(mark.x, mark.y);
      assert.equal((await marked()).title, "Take 7");
      // Keys go on in the order of the table.
      await view.mouse.move(5, 300);
      await view.evaluate(() => window.pliant.pointing.keep(window.pliant.sweep.row(7), "test"));
      await view.keyboard.press("ArrowRight");
      assert.equal((await marked()).title, "Take 8");
      await view.keyboard.press("Escape");
      assert.equal((await marked()).title, "All takes");
    });
    await withPage(`${url}#take=4&theme=light`, {}, async (view) => {
      assert.equal(await view.locator("#details h2").evaluate((element) => element.firstChild.textContent), "Take 4");
    });
  });

  test("the table is sorted by any column, and the pictures go along", async () => {
    const url = sweepPage("sorted", small("sorted"), ["sheet.c=-5,0,2", "poke.direction=0 1 0,1 0 0", "sheet.damping=3,20,100"], { code: 1 });
    await withPage(url, { width: 1280, height: 900 }, async (view) => {
      const column = (k) => view.locator(`#table tr[data-row] td:nth-child(${k + 1})`).allTextContents();
      assert.equal(await view.locator("#summary").textContent(), "18 takes · 12 done · 6 failed");
      assert.deepEqual([...new Set(await column(1))].sort(), ["done", "failed"]);
      assert.match((await column(13))[0], /c is -5, but must be greater than/);
      assert.equal((await column(5))[0], "");
      const csv = readFileSync(inFolder("sorted/takes.csv"), "utf8").trim().split("\n").map((line) => line.split(","));
      const titles = await view.locator("#table th").allTextContents();
      assert.deepEqual(titles, csv[0]);
      assert.deepEqual(await column(12), csv.slice(1).map((row) => row[12]));
      for (const [name, k] of [["peak", 5], ["sheet.damping", 4]]) {
        const expected = csv.slice(1).filter((row) => row[1] === "done").map((row) => Number(row[k])).sort((a, b) => a - b);
        const button = view.locator("#table th").nth(k).locator("button");
        for (const isDescending of [false, true]) {
          await button.click();
          const shown = (await column(k)).slice(0, 12).map(Number);
          if (name === "peak") shown.forEach((value, place) => near(value, expected[isDescending ? 11 - place : place], 1e-5 * value, name));
          assert.equal(await view.locator("#table th").nth(k).getAttribute("aria-sort"), isDescending ? "descending" : "ascending");
          const order = await column(0);
          const tiles = await view.locator(".tile .head b").allTextContents();
          assert.deepEqual(tiles, order.filter((take) => tiles.includes(take)));
        }
      }
      await view.locator("#order").selectOption({ label: "settle" });
      assert.equal(await view.locator("#table th").nth(11).getAttribute("aria-sort"), "ascending");
    });
  });

  test("each measure is drawn over each value: lines, points, maps", async () => {
    const url = sweepPage("plotted", small("plotted"), ["sheet.damping=1:100:5:log", "sheet.combine=box,union", "sheet.density=1:4:4"]);
    await withPage(url, { width: 1280, height: 900 }, async (view) => {
      const specs = await view.evaluate(() => window.pliant.plots.plots.map(({ spec }) => ({ title: spec.title, about: spec.about, lines: spec.lines.map(({ rows }) => rows) })));
      assert.equal(specs.length, 7 * 3);
      // 8 lines over the dampings, none over a text, 10 over the densities.
      assert.deepEqual(specs.slice(0, 3).map(({ lines }) => lines.length), [8, 0, 10]);
      for (const rows of specs[0].lines) assert.deepEqual(rows.map((row) => row - rows[0]), [0, 8, 16, 24, 32]);
      // Values at equal ratios are at equal distances.
      await view.locator("#plots").scrollIntoViewIfNeeded();
      await settled(view);
      const places = await view.evaluate(() => [0, 8, 16, 24, 32].map((row) => window.pliant.plots.plots[0].placeAt(row).left));
      places.slice(1).forEach((place, k) => near(place - places[k], places[1] - places[0], 1e-3, "a step"));
      await view.locator("#value-scale").selectOption("linear");
      await settled(view);
      const linear = await view.evaluate(() => [0, 8, 32].map((row) => window.pliant.plots.plots[0].placeAt(row).left));
      assert.ok(linear[1] - linear[0] < 0.1 * (linear[2] - linear[0]), linear);
      await view.locator("#kind span").nth(1).click();
      const maps = await view.evaluate(() => window.pliant.plots.plots.map(({ spec, means, rows }) => ({ across: spec.across, up: spec.up, means: [...means], counts: rows.map((each) => each.length) })));
      assert.equal(maps.length, 7);
      assert.deepEqual([maps[0].across, maps[0].up], [["1", "2", "3", "4"], ["box", "union"]]);
      assert.ok(maps[0].counts.every((count) => count === 5));
      const csv = readFileSync(inFolder("plotted/takes.csv"), "utf8").trim().split("\n").slice(1).map((line) => line.split(","));
      const peaks = csv.filter((row) => row[3] === "union" && row[4] === "2").map((row) => Number(row[5]));
      near(maps[0].means[4 + 1], peaks.reduce((a, b) => a + b) / 5, 1e-12, "the mean of a cell");
      await view.locator("#up").selectOption({ label: "sheet.damping" });
      assert.deepEqual(await view.evaluate(() => window.pliant.plots.plots[0].spec.up), ["1", "3.162", "10", "31.62", "100"]);
      // Each cell of the first map has a colour: those of 20 means, and of text and frame.
      await readsPixels(view);
      await view.waitForFunction(() => new Set(new Uint32Array(window.pixelsOf(document.querySelector(".plot canvas")).buffer)).size > 20);
      await view.screenshot({ path: path.join(pictures, "sweep-maps.png") });
      // Another theme draws all that is seen anew.
      await view.locator("#kind span").first().click();
      await view.locator("#plots").evaluate((plots) => plots.scrollIntoView());
      for (const colorScheme of ["light", "dark"]) {
        await view.emulateMedia({ colorScheme });
        await settled(view);
        const counts = await view.locator(".plot canvas").evaluateAll((canvases) => canvases.slice(0, 3).map((canvas) => {
          const data = window.pixelsOf(canvas);
          const colours = new Set(window.pliant.themes.palette.curves.map((colour) => parseInt(colour.slice(1), 16)));
          let count = 0;
          for (let k = 0; k < data.length; k += 4) if (colours.has((data[k] << 16) | (data[k + 1] << 8) | data[k + 2])) ++count;
          return count;
        }));
        for (const count of counts) assert.ok(count > 10, `${counts} in the ${colorScheme}`);
      }
    });
  });

  test("colours have one scale, whose top is chosen", async () => {
    const url = sweepPage("scaled", small("scaled"), ["poke.magnitude=100,900"]);
    await withPage(url, {}, async (view) => {
      const most = await view.evaluate(() => window.pliant.sweep.shapes.map(({ mostDisplaced }) => mostDisplaced));
      near(await view.evaluate(() => window.pliant.studio.peak), Math.max(...most), 0, "the top");
      assert.ok(most[0] < most[1] / 5);
      const brightest = () => view.locator(".tile canvas").first().evaluate((canvas) => {
        const data = window.pixelsOf(canvas);
        let most = 0;
        for (let k = 0; k < data.length; k += 4) most = Math.max(most, data[k] - data[k + 2]); // yellow less blue
        return most;
      });
      await whole(view);
      await readsPixels(view);
      const before = await brightest();
      await view.locator("#peak").fill(String(most[0]));
      await view.locator("#peak").blur();
      await settled(view);
      await view.waitForTimeout(200);
      assert.ok((await brightest()) > before + 40, `${before} and ${await brightest()}`);
      // A drag turns the camera of all, and chooses no take.
      const picture = () => view.locator(".tile canvas").first().evaluate((canvas) => canvas.toDataURL());
      const straight = await picture();
      const box = await view.locator(".tile").first().boundingBox();
      await view.mouse.move(box.x + 40, box.y + 40);
      await view.mouse.down();
      await view.mouse.move(box.x + 120, box.y + 60, { steps: 4 });
      await view.mouse.up();
      await settled(view);
      await view.waitForTimeout(200);
      assert.notEqual(await picture(), straight);
      assert.equal(await view.evaluate(() => window.pliant.pointing.keptRow), null);
      await view.keyboard.press("f");
      await settled(view);
      await view.waitForTimeout(200);
      assert.equal(await picture(), straight);
    });
  });

  test("names in a sweep are text, whatever they are", async () => {
    const evil = "<img src=x onerror=window.hit=1>";
    mkdirSync(inFolder("a"));
    const files = ["evil.xml", `${evil}.xml`].map((name) => path.join(inFolder("a"), name));
    for (const file of files) writeFileSync(file, scene());
    run("sweep", "run", ...files, "-o", inFolder(evil), "--vary", "sheet.c=-5,0", "--quiet", "--make-only");
    try { run("sweep", "run", inFolder(evil), "--quiet"); } catch { /* two takes fail */ }
    // An error that another program wrote into the log.
    writeFileSync(inFolder(`${evil}/log/z.jsonl`), `{"take":0,"status":"failed","error":"</script>${evil}","seconds":1,"host":"h","time":"2099-11-24T10:45:00.123Z"}\n`);
    await withPage(page(evil), {}, async (view) => {
      assert.equal(await view.locator("#sweep-name").textContent(), evil);
      await view.locator(".tile").first().click();
      assert.match(await view.locator("#details code").textContent(), /^pliant sweep bake '<img/);
      assert.ok((await view.locator("#table td").allTextContents()).includes(`</script>${evil}`));
      assert.ok((await view.locator("#table td").allTextContents()).includes(files[1]));
      await view.evaluate(() => window.pliant.pointing.keep(0, "test"));
      assert.equal(await view.locator("#details .error").textContent(), `</script>${evil}`);
      assert.equal(await view.locator("img").count(), 0);
      assert.equal(await view.evaluate(() => window.hit), undefined);
    });
  });

  test("a hundred thousand takes are one page, and sorted", async () => {
    writeFileSync(inFolder("tiny.xml"), '<scene version="1" start="1" end="1"><surface name="s"><grid columns="5" rows="5"/></surface></scene>');
    run("sweep", "run", inFolder("tiny.xml"), "-o", inFolder("many"), "--vary", "s.damping=1:100", "--vary", "s.density=0.5:3", "--sample", "100000", "--make-only", "--quiet");
    // As if they had been run: the scene at rest, with numbers of our own.
    mkdirSync(inFolder("many/log"), { recursive: true });
    const lines = [];
    for (let take = 0; take < 100_000; ++take) {
      const x = (take * 0.6180339887) % 1;
      const state = take % 90 === 7 ? '"status":"failed","error":"no memory"' : `"status":"done","peak":0,"peakFrame":1,"final":${x},"rms":${x * x},"speed":${1 / (x + 0.01)},"energy":${x},"settle":${1 + (take % 90)},"hash":"${take.toString(16).padStart(32, "0")}"`;
      lines.push(`{"take":${take},${state},"seconds":1,"host":"h","time":"2026-11-24T10:45:00.123Z"}\n`);
    }
    writeFileSync(inFolder("many/log/all.jsonl"), lines.join(""));
    const url = page("many");
    const { size } = statSync(url.slice("file://".length));
    assert.ok(size < 20e6, `${size} bytes`);
    await withPage(url, { width: 1280, height: 900 }, async (view) => {
      await readsPixels(view);
      const rows = await view.evaluate(() => window.pliant.sweep.rowCount);
      assert.ok(rows > 60_000 && rows <= 100_000, `${rows} rows`);
      if (rows < 100_000) assert.equal(await view.locator("#table-note").textContent(), `${rows.toLocaleString("en")} of 100,000 takes, evenly spread; takes.csv has all.`);
      assert.equal(await view.locator(".tile").count(), 100);
      await view.evaluate(() => window.pliant.table.sort(6, true));
      assert.ok((await view.locator("#table tr").count()) < 150);
      await view.locator("#table").evaluate((table) => (table.scrollTop = table.scrollHeight));
      await settled(view);
      assert.match(await view.locator("#table tr[data-row] td.failed").last().textContent(), /failed/); // no number: at the end
      await view.locator(".plot canvas").nth(4).scrollIntoViewIfNeeded();
      await settled(view);
      const colours = await view.locator(".plot canvas").nth(4).evaluate((canvas) => new Set(new Uint32Array(window.pixelsOf(canvas).buffer)).size);
      assert.ok(colours > 20, `${colours} colours`);
    });
  });

  for (const [width, height] of [[360, 740], [820, 1180], [1280, 800], [1920, 1080]]) {
    test(`nothing of a sweep sticks out at ${width} x ${height}`, async () => {
      const url = sweepPage(`laid${width}`, small("laid"), ["sheet.damping=1:100:5", "sheet.c=-5,0,1", "poke.center=0 0 0,1 0 0"], { code: 1 });
      await withPage(url, { width, height }, async (view) => {
        const wide = await view.evaluate(() => {
          const out = [];
          for (const element of document.querySelectorAll("#sweep, header, header > *, .flow, .tools, .tools > *, .tile, .tile canvas, .details, .details > *")) {
            const box = element.getBoundingClientRect();
            if (box.width > 0 && (box.right > innerWidth + 0.5 || box.left < -0.5)) out.push(`${element.tagName}.${element.className} ${element.id} ${box.right}`);
          }
          return { out, flow: document.getElementById("flow").scrollWidth - document.getElementById("flow").clientWidth, page: document.documentElement.scrollHeight - innerHeight };
        });
        assert.deepEqual(wide, { out: [], flow: 0, page: 0 });
        // Texts under pictures do not cover each other.
        const covered = await view.locator(".tile").evaluateAll((tiles) => tiles.filter((tile) => {
          const boxes = [...tile.querySelectorAll(".head > *, .line > *")].map((each) => each.getBoundingClientRect());
          return boxes.some((a, k) => boxes.slice(k + 1).some((b) => a.left < b.right - 0.5 && b.left < a.right - 0.5 && a.top < b.bottom - 0.5 && b.top < a.bottom - 0.5));
        }).length);
        assert.equal(covered, 0);
        await view.screenshot({ path: path.join(pictures, `sweep-${width}.png`) });
      });
    });
  }

  test("everything on the page of a sweep that can be worked has a name", async () => {
    await withPage(sweepPage("named", small("named"), ["sheet.damping=1,5"]), {}, async (view) => {
      const nameless = await view.evaluate(() => [...document.querySelectorAll("button, input, select, a, [tabindex='0']")].filter((element) => {
        const label = element.getAttribute("aria-label") ?? element.getAttribute("aria-labelledby") ?? element.title ?? "";
        const labelled = element.closest("label")?.textContent ?? "";
        return (label + labelled + element.textContent).trim() === "";
      }).map((element) => element.outerHTML));
      assert.deepEqual(nameless, []);
    });
  });

  test("a picture of a sweep has its takes side by side, with a page or without", async () => {
    const file = small("pictured");
    sweepPage("pictured", file, ["sheet.damping=1,5,25", "poke.magnitude=300,900"]);
    run("sweep", "view", "pictured", "--png", inFolder("sheet.png"), "--size", "200x150", "--look", "theme=dark&turn=10", "-o", inFolder("both.html"));
    assert.ok(statSync(inFolder("both.html")).size > 500_000);
    const png = readFileSync(inFolder("sheet.png"));
    const [width, height] = [png.readUInt32BE(16), png.readUInt32BE(20)];
    // Three columns, two rows with 50 pixels for a number and two values, 66 for the colours.
    assert.deepEqual([width, height], [3 * 200, 2 * (150 + 50) + 66]);
    await withPage(`file://${inFolder("both.html")}`, {}, async (view) => {
      const { data } = await pixelsOfPng(view, png);
      const count = (left, top, across, up) => new Set(Array.from({ length: across * up }, (_, k) => data.readUInt32LE(4 * ((top + Math.floor(k / across)) * width + left + (k % across))))).size;
      const tiles = [0, 1, 2, 3, 4, 5].map((k) => [count((k % 3) * 200, Math.floor(k / 3) * 200, 199, 150), count((k % 3) * 200, Math.floor(k / 3) * 200 + 150, 200, 50)]);
      const colours = { tiles, strip: count(0, 400, 250, 66) };
      for (const [picture, words] of colours.tiles) assert.ok(picture > 200 && words > 10, `${picture}, ${words}`);
      assert.ok(colours.strip > 100);
    });
  });
}
