// Tests pages of `pliant view` and `pliant edit` in headless Chromium: the scene graph, keys and pointer, the page's
// texts, its layout in windows of all sizes.
//
// usage: node viewer_test.mjs PLIANT EXAMPLES PICTURES [--all | NAME…]
// NAME: run only the tests whose names contain it. Without one and without --all those are left out that take long and
// seldom find what others do not: three of four examples, and movies bit by bit. Screenshots go to PICTURES.
// Needs the packages of `script/bootstrap --viewer`. Ends with the line "N passed, N failed".

import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { createServer } from "node:http";
import { mkdirSync, mkdtempSync, readdirSync, readFileSync, renameSync, rmSync, statSync, utimesSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";

import { chromium } from "playwright-core";

import { editTests } from "./edit_tests.mjs";
import { sweepTests } from "./sweep_tests.mjs";

const [pliant, examples, pictures, ...words] = process.argv.slice(2).map((word, k) => (k < 3 ? path.resolve(word) : word));
const only = words.map((word) => (word === "--all" ? "" : word)); // each name contains the empty one
mkdirSync(pictures, { recursive: true });
const folder = mkdtempSync(path.join(tmpdir(), "pliant-viewer-"));
const inFolder = (name) => path.join(folder, name);
const run = (...words) => execFileSync(pliant, words, { cwd: folder, encoding: "utf8", timeout: 300_000 });

const tests = [];
const test = (name, body) => tests.push([name, body]);
const thorough = (name, body) => {
  if (only.length > 0) test(name, body);
};

// Files

/** Reads a float64 array written by NumPy: shape and numbers. */
function readNpy(file) {
  const bytes = readFileSync(file);
  const length = bytes.readUInt16LE(8);
  const shape = bytes.toString("latin1", 10, 10 + length).match(/'shape': \(([^)]*)\)/)[1].split(",").filter((word) => word.trim()).map(Number);
  return { shape, numbers: new Float64Array(bytes.buffer.slice(bytes.byteOffset + 10 + length, bytes.byteOffset + bytes.length)) };
}

/** Values of a channel by frame. */
function curve(scene, channel) {
  const rows = run("curves", scene, "--channel", channel).trim().split("\n").slice(1);
  return new Map(rows.map((row) => row.split(",").slice(1).map(Number)).map(([frame, ...value]) => [frame, value]));
}

const example = (name) => path.join(examples, `${name}.xml`);

function pageOf(scene, ...options) {
  const out = inFolder(`${path.basename(scene, ".xml")}.html`);
  run("view", scene, "-o", out, "--quiet", ...options);
  return `file://${out}`;
}

// Pages

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--in-process-gpu", "--disable-gpu-compositing"],  // which take a third of the time
});

/** In a page: its edges are drawn with steps, which takes a processor three quarters of the time. */
function withoutSmoothEdges() {
  const get = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, options) {
    return get.call(this, kind, kind.startsWith("webgl") ? { ...options, antialias: false } : options);
  };
}

/**
 * Opens a page and checks that it is silent: nothing in its console, no requests to other servers.
 */
async function open(url, { width = 900, height = 600, before, ...options } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: "dark", ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(120_000); // the machine may be busy
  await page.addInitScript(withoutSmoothEdges);
  if (before) await page.addInitScript(before); // runs ahead of the page
  page.complaints = [];
  page.on("pageerror", (error) => page.complaints.push(String(error)));
  page.on("console", (message) => {
    // The renderer's, as a picture of the page is taken.
    if (message.text().includes("GPU stall due to ReadPixels")) return;
    if (["error", "warning"].includes(message.type())) page.complaints.push(message.text());
  });
  page.on("request", (request) => {
    const allowed = ["file:", "data:", "blob:"].includes(new URL(request.url()).protocol) || request.url().startsWith(new URL(url).origin);
    if (!allowed) page.complaints.push(`asks for ${request.url()}`);
  });
  await page.goto(url);
  await page.waitForFunction(() => document.documentElement.dataset.ready === "true");
  return page;
}

async function withPage(url, options, body) {
  const page = await open(url, options);
  await body(page);
  assert.deepEqual(page.complaints, []);
  await page.context().close();
}

const frameOf = (page) => page.evaluate(() => window.pliant.playback.frame);
const goTo = (page, frame) => page.evaluate((to) => window.pliant.playback.goTo(to), frame);

/** World positions of a surface's vertices in the scene graph, and the page's error bound. */
const worldPositions = (page, name) =>
  page.evaluate((wanted) => {
    const { stage, viewer } = window.pliant;
    stage.scene.updateMatrixWorld(true);
    const mesh = stage.scene.getObjectByName(wanted);
    const { array } = mesh.geometry.getAttribute("position");
    const m = mesh.matrixWorld.elements;
    const result = [];
    for (let k = 0; k < array.length; k += 3) {
      for (let row = 0; row < 3; ++row) result.push(m[row] * array[k] + m[row + 4] * array[k + 1] + m[row + 8] * array[k + 2] + m[row + 12]);
    }
    return { positions: result, error: viewer.views.find((view) => view.surface.head.name === wanted).surface.head.error };
  }, name);

/** Position and size of the object of that name, from its world matrix. */
const matricesOf = (page, name) =>
  page.evaluate((wanted) => {
    const { stage } = window.pliant;
    stage.scene.updateMatrixWorld(true);
    const found = [];
    stage.scene.traverse((object) => {
      if (object.name === wanted) found.push({ elements: [...object.matrixWorld.elements], isVisible: object.visible });
    });
    return found;
  }, name);

const near = (actual, expected, tolerance, what) =>
  assert.ok(Math.abs(actual - expected) <= tolerance, `${what}: ${actual} is not ${expected} within ${tolerance}`);

// Tests

const allExamples = [...readdirSync(examples), ...readdirSync(path.join(examples, "thesis")).map((name) => path.join("thesis", name))]
  .filter((name) => name.endsWith(".xml"))
  .map((name) => name.slice(0, -4));

for (const [k, name] of allExamples.entries()) {
  (k % 4 === 0 ? test : thorough)(`every example opens without a complaint: ${name}`, async () => {
    await withPage(pageOf(example(name)), {}, async (page) => {
      const { first, last } = await page.evaluate(() => window.pliant.viewer.bake.head);
      await goTo(page, Math.round(first + 0.4 * (last - first)));
      for (const colorScheme of ["dark", "light"]) {
        await page.emulateMedia({ colorScheme });
        await page.waitForTimeout(100);
        await page.screenshot({ path: path.join(pictures, `${path.basename(name)}-${colorScheme}.png`) });
      }
      for (const frame of [first, last]) {
        await goTo(page, frame);
        const isFinite = await page.evaluate(() => window.pliant.viewer.views.every((view) => view.mesh.geometry.getAttribute("position").array.every(Number.isFinite)));
        assert.ok(isFinite, `frame ${frame}`);
      }
    });
  });
}

test("vertices stand where a bake has them", async () => {
  for (const name of ["sheet", "travelling", "flag", "finger"]) {
    const scene = example(name);
    run("bake", scene, "-o", inFolder(`${name}.npy`), "--quiet");
    await withPage(pageOf(scene), {}, async (page) => {
      const heads = await page.evaluate(() => window.pliant.viewer.bake.head.surfaces.map(({ name: each }) => each));
      const { first, last } = await page.evaluate(() => window.pliant.viewer.bake.head);
      for (const surface of heads) {
        const { shape, numbers } = readNpy(inFolder(heads.length > 1 ? `${name}-${surface}.npy` : `${name}.npy`));
        assert.equal(shape[0], last - first + 1);
        for (const frame of [first, first + 1, Math.round((first + last) / 2), last]) {
          await goTo(page, frame);
          const { positions, error } = await worldPositions(page, surface);
          assert.equal(positions.length, shape[1] * 3);
          const begin = (frame - first) * positions.length;
          const size = positions.reduce((most, each) => Math.max(most, Math.abs(each)), 0);
          const off = positions.reduce((most, each, k) => Math.max(most, Math.abs(each - numbers[begin + k])), 0);
          assert.ok(off <= 1.8 * error + 1e-6 * size, `${name} ${surface} frame ${frame}: off by ${off}, may be ${error}`);
          assert.ok(off < 1e-4 * size);
        }
      }
    });
  }
});

test("circles and vectors are where the channels say", async () => {
  const scene = example("travelling");
  const center = curve(scene, "finger.center");
  const magnitude = curve(scene, "finger.magnitude");
  const strongest = Math.max(...[...magnitude.values()].map(([value]) => Math.abs(value)));
  await withPage(pageOf(scene), {}, async (page) => {
    for (const frame of [1, 8, 30, 57]) {
      await goTo(page, frame);
      for (const [which, radius] of [["deformationRadius", 2.6], ["forceRadius", 1.1]]) {
        const [{ elements }] = await matricesOf(page, `finger ${which}`);
        for (let k = 0; k < 3; ++k) {
          near(elements[12 + k], center.get(frame)[k], 1e-6, `${which} at frame ${frame}`);
          near(Math.hypot(...elements.slice(4 * k, 4 * k + 3)), radius, 1e-6, `${which} along axis ${k}`);
        }
      }
      const tip = await page.evaluate(() => {
        const group = window.pliant.stage.scene.getObjectByName("finger vector");
        window.pliant.stage.scene.updateMatrixWorld(true);
        return group.visible ? [...group.children[1].matrixWorld.elements.slice(12, 15)] : null;
      });
      const share = magnitude.get(frame)[0] / strongest;
      if (share === 0) {
        assert.equal(tip, null);
        continue;
      }
      const direction = [0.3, 0.1, 1];
      direction.forEach((way, k) => {
        const expected = center.get(frame)[k] + ((1.15 * 2.6 * share) / Math.hypot(...direction)) * way;
        near(tip[k], expected, 1e-5, `tip at frame ${frame}`);
      });
    }
  });
});

test("every kind of force has its gizmo", async () => {
  const forces = `
    <point name="a" magnitude="5"/><radial name="b" center="1 2 3" magnitude="-5" deformationRadius="2"/>
    <line name="c" from="-2 1 0" to="2 1 0" magnitude="5"/><line name="d" from="0 0 0" to="0 0 0" direction="0 0 1" magnitude="5"/>
    <uniform name="e" direction="0 -1 0" magnitude="5"/><vortex name="f" axis="0 0 2" pull="0.5" magnitude="5"/>
    <noise name="g" magnitude="5"/><inertia name="h"/>
    <group name="i" center="3 0 0" deformationRadius="4"><point name="j" center="3 0 0" magnitude="2"/></group>
    <point name="k" enabled="false" magnitude="3"/>`;
  writeFileSync(inFolder("kinds.xml"), `<scene version="1" start="1" end="6"><surface name="s"><grid columns="9" rows="9" width="8" depth="8"/>
    <transform><animate attribute="translate"><key frame="1" value="0 0 0"/><key frame="3" value="0 1 0"/><key frame="6" value="0 0 0"/></animate></transform></surface>${forces}</scene>`);
  await withPage(pageOf(inFolder("kinds.xml")), {}, async (page) => {
    await goTo(page, 3);
    const isShown = (name) => page.evaluate((wanted) => window.pliant.stage.scene.getObjectByName(`force ${wanted}`).visible, name);
    for (const name of "abcdefghij") assert.equal(await isShown(name), true, name);
    assert.equal(await isShown("k"), false);
    // The arrows of a radial force that attracts point at its centre.
    const tips = await page.evaluate(() => {
      const found = [];
      window.pliant.stage.scene.traverse((object) => object.name === "b vector" && object.visible && found.push(object.children.map((part) => part.position.toArray())));
      return found;
    });
    assert.equal(tips.length, 6);
    const distance = (p) => Math.hypot(p[0] - 1, p[1] - 2, p[2] - 3);
    for (const [shaft, tip] of tips) assert.ok(distance(tip) < distance(shaft));
    // A capsule has circles at both ends.
    const ends = await matricesOf(page, "c forceRadius");
    assert.deepEqual(ends.map(({ elements }) => elements[12]), [-2, 2]);
    // The group shows the circles of the region; the force in it only its own.
    assert.equal((await matricesOf(page, "i deformationRadius"))[0].elements[0], 4);
    assert.equal((await matricesOf(page, "j deformationRadius"))[0].isVisible, false);
    assert.equal((await matricesOf(page, "h vector"))[0].isVisible, true);
    await page.screenshot({ path: path.join(pictures, "kinds.png") });
  });
});

test("one frame, no force, a surface of nine vertices", async () => {
  writeFileSync(inFolder("least.xml"), '<scene version="1" start="5" end="5"><surface name="s"><grid columns="3" rows="3"/></surface></scene>');
  await withPage(pageOf(inFolder("least.xml")), {}, async (page) => {
    for (const key of ["Space", "ArrowRight", "ArrowDown", "End", "c", "f"]) await page.keyboard.press(key);
    assert.equal(await frameOf(page), 5);
    assert.equal((await worldPositions(page, "s")).positions.length, 27);
  });
});

test("a small scene far from the origin keeps its shape", async () => {
  writeFileSync(inFolder("far.xml"), `<scene version="1" start="1" end="24"><surface name="s"><grid columns="21" rows="21" width="1e-3" depth="1e-3"/>
    <transform translate="1e6 -1e6 3e5"/></surface><point name="a" center="1e6 -1e6 3e5" deformationRadius="6e-4" forceRadius="2e-4" magnitude="0.3"/></scene>`);
  run("bake", inFolder("far.xml"), "-o", "far.npy", "--quiet");
  const { numbers } = readNpy(inFolder("far.npy"));
  await withPage(pageOf(inFolder("far.xml")), {}, async (page) => {
    await goTo(page, 20);
    const { positions } = await worldPositions(page, "s");
    // The doubles of the bakes differ by 1e-10 there.
    const off = positions.reduce((most, each, k) => Math.max(most, Math.abs(each - numbers[19 * 441 * 3 + k])), 0);
    assert.ok(off < 1e-8, `${off}`);
  });
});

test("the rim of a region lies on the surface, along its box", async () => {
  const scene = example("hands");
  run("bake", scene, "-o", "hands.npy", "--regions", "hands.json", "--quiet");
  const told = JSON.parse(readFileSync(inFolder("hands.json"), "utf8")).frames;
  await withPage(pageOf(scene), {}, async (page) => {
    for (const frame of [12, 30, 60]) {
      await goTo(page, frame);
      const drawn = await page.evaluate(() => {
        const { stage, viewer } = window.pliant;
        const { head, nodeVertices } = viewer.views[0].surface;
        const lines = stage.scene.getObjectByName(`${head.name} rim`);
        const at = viewer.views[0].mesh.geometry.getAttribute("position").array;
        const nodes = new Map([...nodeVertices].map((vertex, node) => [[0, 1, 2].map((k) => at[3 * vertex + k]).join(), node]));
        if (!lines.visible) return [];
        const ends = lines.geometry.ends;
        return Array.from({ length: ends.length / 3 }, (_, k) => nodes.get([0, 1, 2].map((c) => ends[3 * k + c]).join()) ?? null).map((node) => node !== null && [node % head.columns, Math.floor(node / head.columns)]);
      });
      assert.ok(!drawn.includes(false), "an end that is no vertex");
      const expected = new Set();
      for (const region of told.find((each) => each.frame === frame).surfaces[0].regions) {
        if (!region.solved) continue;
        const { columns: [i0, i1], rows: [j0, j1] } = region.box;
        for (let i = i0; i <= i1; ++i) for (const j of [j0, j1]) expected.add(`${i},${j}`);
        for (let j = j0; j <= j1; ++j) for (const i of [i0, i1]) expected.add(`${i},${j}`);
      }
      assert.deepEqual(new Set(drawn.map(String)), expected, `frame ${frame}`);
    }
  });
});

/**
 * A flat sheet of triangles without (u,v) over [-2,2]², in two halves with vertices of their own along x = 0, and a
 * vertex in no face: the first one, and the last one.
 */
function writeTriangles(file) {
  const [lines, count] = [["v 0 3 0"], 24];
  const halves = [[0, count / 2], [count / 2, count]].map(([begin, end]) => {
    const first = lines.length;
    for (let j = 0; j <= count; ++j) for (let i = begin; i <= end; ++i) lines.push(`v ${(4 * i) / count - 2} 0 ${(4 * j) / count - 2}`);
    return { first, columns: end - begin + 1 };
  });
  lines.push("v 0 -3 0");
  for (const { first, columns } of halves) {
    for (let j = 0; j < count; ++j) {
      for (let i = 0; i < columns - 1; ++i) {
        const a = first + j * columns + i + 1;
        const [b, c, d] = [a + 1, a + columns, a + columns + 1];
        lines.push(...((i + j) % 2 ? [`f ${a} ${c} ${d}`, `f ${a} ${d} ${b}`] : [`f ${a} ${c} ${b}`, `f ${b} ${c} ${d}`]));
      }
    }
  }
  writeFileSync(file, `${lines.join("\n")}\n`);
}

/** Segments of the lines of that name, six numbers each. */
const segmentsOf = (page, name) =>
  page.evaluate((wanted) => {
    const lines = window.pliant.stage.scene.getObjectByName(wanted);
    const array = lines.geometry.ends;
    return lines.visible ? Array.from({ length: array.length / 6 }, (_, k) => [...array.slice(6 * k, 6 * k + 6)]) : [];
  }, name);

/** Whether each place is the end of an even number of segments. */
const closes = (segments) => {
  const ends = new Map();
  for (const segment of segments) for (const end of [segment.slice(0, 3).join(), segment.slice(3).join()]) ends.set(end, (ends.get(end) ?? 0) + 1);
  return segments.length > 0 && [...ends.values()].every((count) => count % 2 === 0);
};

const trianglesScene = (center) => `<scene version="1" start="1" end="12">
  <surface name="s"><mesh file="triangles.obj" uv="surface"/><material density="0.02" damping="0.2"/></surface>
  <point name="poke" direction="0 1 0" deformationRadius="1" forceRadius="0.5" magnitude="500">${center}</point>
  <point name="idle" center="-1.5 0 -1.5" deformationRadius="0.4" forceRadius="0.2" magnitude="0"/>
  <point name="held" center="2 0 2" deformationRadius="0.15" forceRadius="0" magnitude="0"/>
  </scene>`;
const sliding = '<animate attribute="center"><key frame="1" value="-0.5 0 0"/><key frame="12" value="0.5 0 0.2"/></animate>';

test("the outline of a cut and of what forces push is drawn on the surface, across a seam", async () => {
  writeTriangles(inFolder("triangles.obj"));
  const scene = inFolder("cut.xml");
  writeFileSync(scene, trianglesScene(sliding));
  const center = curve(scene, "poke.center");
  await withPage(pageOf(scene), {}, async (page) => {
    const spacing = 4 / 24;
    for (const frame of [1, 6, 12]) {
      await goTo(page, frame);
      const [x, , z] = center.get(frame);
      const parts = [
        ["s rim", [[x, z, 1], [-1.5, -1.5, 0.4]]],
        ["s force boxes", [[x, z, 0.5]]],
        ["s idle force boxes", [[-1.5, -1.5, 0.2]]],
      ];
      for (const [name, circles] of parts) {
        const segments = await segmentsOf(page, name);
        assert.ok(closes(segments), `${name} at frame ${frame}`);
        const lengths = circles.map(() => 0);
        for (const [ax, , az, bx, , bz] of segments) {
          const off = circles.map(([cx, cz, radius]) => Math.max(...[[ax, az], [bx, bz]].map(([px, pz]) => Math.abs(Math.hypot(px - cx, pz - cz) - radius))));
          const nearest = off.indexOf(Math.min(...off));
          assert.ok(off[nearest] < 0.2 * spacing, `${name} at frame ${frame}: ${ax}, ${az} is off by ${off[nearest]}`);
          lengths[nearest] += Math.hypot(bx - ax, bz - az);
        }
        circles.forEach(([, , radius], k) => near(lengths[k] / (2 * Math.PI * radius), 1, radius < spacing * 2 ? 0.1 : 0.05, `${name} at frame ${frame}`));
      }
    }
    // At the corner only a held node is inside.
    const corner = await segmentsOf(page, "s unsolved");
    assert.ok(closes(corner));
    assert.ok(corner.flat().every((number, k) => (k % 3 === 1 ? number === 0 : number > 1.8)), `${corner}`);
    // It follows the surface: where that is raised, what is pushed is too.
    const heights = (await segmentsOf(page, "s force boxes")).flatMap((segment) => [segment[1], segment[4]]);
    const peak = await page.evaluate(() => Math.max(...window.pliant.viewer.views[0].mesh.geometry.getAttribute("position").array.filter((_, k) => k % 3 === 1).slice(1, -1)));
    assert.ok(Math.min(...heights) > 0.2 * peak && Math.max(...heights) < peak && peak > 0.02, `${heights} of ${peak}`);
    for (const [key, value] of [["regions", "hasRegions"], ["boxes", "hasBoxes"]]) {
      await page.evaluate(([word, name]) => { window.pliant.viewer.display[name] = false; window.pliant.viewer.redress(); }, [key, value]);
    }
    for (const name of ["s rim", "s force boxes", "s idle force boxes"]) assert.deepEqual(await segmentsOf(page, name), [], name);
  });
});

test("pictures have the outline of a cut", async () => {
  writeTriangles(inFolder("triangles.obj"));
  writeFileSync(inFolder("still.xml"), trianglesScene("").replace('magnitude="500"', 'magnitude="500" center="0 0 0"'));
  const take = (name, look) => {
    run("view", inFolder("still.xml"), "--png", name, "--frame", "6", "--size", "480x320", "--quiet", "--look", `gizmos=off&legend=off&tilt=60&colour=plain&${look}`);
    return pixelsOf(name);
  };
  const plain = take("c0.png", "regions=off&boxes=off");
  const [rim, boxes] = [differing(plain, take("c1.png", "boxes=off")), differing(plain, take("c2.png", "regions=off"))];
  assert.ok(rim > 600 && boxes > 300 && boxes < rim, `${rim}, ${boxes} pixels`);
});

test("vertices that are no nodes stand where a bake has them, and regions are drawn on them", async () => {
  writeTriangles(inFolder("triangles.obj"));
  const points = Array.from({ length: 49 }, (_, k) => `${(k % 7) - 3} ${(k % 7) % 6 && k > 6 && k < 42 ? 0.4 : 0} ${Math.floor(k / 7) - 3}`);
  writeFileSync(inFolder("none.xml"), `<scene version="1" start="1" end="6">
    <surface name="net"><nurbs columns="7" rows="7" degreeU="2" degreeV="3"><points>${points.join(" ")}</points></nurbs></surface>
    <surface name="skin" drivenBy="net"><grid columns="12" rows="9" width="5" depth="4"/></surface>
    <surface name="s"><mesh file="triangles.obj" uv="surface"/></surface>
    <point name="p" deformationRadius="2.3" forceRadius="1.2" magnitude="300" center="0 0.4 0" targets="net"/>
    <point name="q" deformationRadius="1" forceRadius="1" magnitude="300" targets="s"/></scene>`);
  run("bake", inFolder("none.xml"), "-o", inFolder("none.npy"), "--quiet");
  await withPage(pageOf(inFolder("none.xml")), {}, async (page) => {
    for (const surface of ["net", "skin", "s"]) {
      const { shape, numbers } = readNpy(inFolder(`none-${surface}.npy`));
      for (const frame of [1, 3, 6]) {
        await goTo(page, frame);
        const { positions, error } = await worldPositions(page, surface);
        assert.equal(positions.length, shape[1] * 3);
        const begin = (frame - 1) * positions.length;
        const off = positions.reduce((most, each, k) => Math.max(most, Math.abs(each - numbers[begin + k])), 0);
        assert.ok(off <= 1.8 * error + 1e-5, `${surface} frame ${frame}: off by ${off}, may be ${error}`);
      }
      const moved = Math.max(...numbers.slice(-3 * shape[1]).map((each, k) => Math.abs(each - numbers[k])));
      assert.ok(moved > 0.01, `${surface} moves by ${moved}`);
    }
    for (const lines of ["net rim", "net force boxes", "s rim"]) assert.ok(closes(await segmentsOf(page, lines)), lines);
    for (const lines of ["skin rim", "skin force boxes"]) assert.deepEqual(await segmentsOf(page, lines), []);
    // All ends of the net's lines lie on its triangles.
    const farthest = await page.evaluate(() => {
      const { stage, viewer } = window.pliant;
      const { array: at } = viewer.views[0].mesh.geometry.getAttribute("position");
      const { triangles } = viewer.views[0].surface;
      const Vector = stage.camera.position.constructor;
      const vertex = (k) => new Vector(...at.slice(3 * k, 3 * k + 3));
      const distance = (p, a, b, c) => {
        const normal = b.clone().sub(a).cross(c.clone().sub(a)).normalize();
        const inside = [[a, b], [b, c], [c, a]].every(([from, to]) => to.clone().sub(from).cross(p.clone().sub(from)).dot(normal) > -1e-5);
        return inside ? Math.abs(p.clone().sub(a).dot(normal)) : Infinity;
      };
      const array = stage.scene.getObjectByName("net rim").geometry.ends;
      let most = 0;
      for (let k = 0; k < array.length; k += 3) {
        let least = Infinity;
        for (let t = 0; t < triangles.length; t += 3) least = Math.min(least, distance(new Vector(...array.slice(k, k + 3)), ...[0, 1, 2].map((c) => vertex(triangles[t + c]))));
        most = Math.max(most, least);
      }
      return most;
    });
    assert.ok(farthest < 1e-5, `${farthest}`);
  });
});

test("the readout names the node of a vertex, if it has one", async () => {
  writeTriangles(inFolder("triangles.obj"));
  writeFileSync(inFolder("named.xml"), `<scene version="1" start="1" end="3"><surface name="s"><mesh file="triangles.obj" uv="surface"/></surface>
    <surface name="net"><nurbs columns="4" rows="4" degreeU="2" degreeV="2"><points>${Array.from({ length: 16 }, (_, k) => `${k % 4} 0 ${Math.floor(k / 4)}`).join(" ")}</points></nurbs>
    <transform translate="4 0 0"/></surface></scene>`);
  await withPage(`${pageOf(inFolder("named.xml"))}#turn=0&tilt=80`, {}, async (page) => {
    const at = async (surface, vertex, aside = 0) => {
      const [x, y] = await page.evaluate(([name, k]) => {
        const { viewer, stage } = window.pliant;
        const seen = viewer.views.find((view) => view.surface.head.name === name).vertex(k).project(stage.camera);
        const box = stage.canvas.getBoundingClientRect();
        return [box.left + ((seen.x + 1) / 2) * box.width, box.top + ((1 - seen.y) / 2) * box.height];
      }, [surface, vertex]);
      await page.mouse.move(x + aside, y);
      await page.waitForFunction((wanted) => document.querySelector("#readout b")?.textContent.startsWith(wanted), `${surface} ${vertex}`);
      return page.locator("#readout b").first().textContent();
    };
    // Vertex 0 is no node. 13 columns of the left half; its last one comes again in the right half.
    assert.equal(await at("s", 1 + 12 * 13 + 5), `s ${1 + 12 * 13 + 5} node ${12 * 13 + 5}`);
    const twin = 1 + 25 * 13 + 12 * 13;
    assert.equal(await at("s", twin, 2), `s ${twin} node ${12 * 13 + 12}`);
    assert.equal(await at("net", 40), "net 40");
  });
});

test("plays at the frame rate, and loops", async () => {
  await withPage(pageOf(example("thesis/fig08-force")), {}, async (page) => {
    const { fps, first, last } = await page.evaluate(() => window.pliant.viewer.bake.head);
    await page.keyboard.press("Space");
    assert.equal(await page.getByRole("button", { name: "Pause" }).count(), 1);
    // The page's clock and its present frame, read after the page's own callback for the same
    // picture. However busy the machine is, the page drops frames instead of being late.
    const sample = () => page.evaluate(() => new Promise((tell) => requestAnimationFrame((time) => tell([time, window.pliant.playback.frame]))));
    const [begin, from] = await sample();
    await page.waitForTimeout(400);
    const [end, to] = await sample();
    const passed = ((end - begin) / 1000) * fps;
    const length = last - first + 1;
    const gone = (((to - from) % length) + length) % length;
    const off = Math.min(Math.abs(gone - (passed % length)), length - Math.abs(gone - (passed % length)));
    assert.ok(off <= 1.001, `${gone} frames in the time of ${passed} (of ${length})`);
    await page.keyboard.press("Space");
    const stopped = await frameOf(page);
    await page.waitForTimeout(150);
    assert.equal(await frameOf(page), stopped);
    // Without the loop, playback ends on the last frame.
    await page.getByRole("button", { name: "Loop" }).click();
    await goTo(page, last - 1);
    await page.getByRole("button", { name: "Play", exact: true }).click();
    await page.getByRole("button", { name: "Play", exact: true }).waitFor();
    assert.equal(await frameOf(page), last);
  });
});

test("keys, buttons and the field go to frames", async () => {
  await withPage(pageOf(example("sheet")), {}, async (page) => {
    const slider = page.getByRole("slider", { name: "Frame" });
    const steps = [
      ["ArrowRight", 2], ["Shift+ArrowRight", 12], ["ArrowLeft", 11], ["End", 96], ["ArrowRight", 96], ["Home", 1], ["ArrowLeft", 1],
      ["ArrowDown", 12], ["ArrowDown", 24], ["ArrowDown", 24], ["ArrowUp", 12], // the keys of poke.magnitude
    ];
    for (const [key, frame] of steps) {
      await page.keyboard.press(key);
      assert.equal(await frameOf(page), frame, key);
      assert.equal(await slider.getAttribute("aria-valuenow"), String(frame));
    }
    assert.match(await slider.getAttribute("aria-valuetext"), /frame 12, 0\.46 s, key/);
    await page.getByRole("button", { name: "One frame forward" }).click();
    assert.equal(await frameOf(page), 13);
    await page.getByRole("button", { name: "First frame" }).click();
    assert.equal(await frameOf(page), 1);
    await page.getByRole("spinbutton", { name: "Frame" }).fill("500");
    await page.keyboard.press("Enter");
    assert.equal(await frameOf(page), 96);
    assert.equal(await page.getByRole("spinbutton", { name: "Frame" }).inputValue(), "96");
  });
});

test("the timeline is scrubbed, with a finger too", async () => {
  await withPage(pageOf(example("sheet")), { hasTouch: true }, async (page) => {
    const box = await page.locator("#timeline").boundingBox();
    const x = (frame) => box.x + 16 + ((frame - 1) / 95) * (box.width - 32);
    const y = box.y + box.height / 2;
    await page.mouse.move(x(20), y);
    await page.mouse.down();
    assert.equal(await frameOf(page), 20);
    for (const frame of [30, 77, 41]) {
      await page.mouse.move(x(frame), y);
      assert.equal(await frameOf(page), frame);
    }
    await page.mouse.move(x(96) + 400, y + 60);
    assert.equal(await frameOf(page), 96);
    await page.mouse.up();
    await page.touchscreen.tap(x(50), y);
    assert.equal(await frameOf(page), 50);
  });
});

test("frames are whole unless asked for more", async () => {
  await withPage(pageOf(example("sheet")), {}, async (page) => {
    const heightAt = async (frame) => {
      await goTo(page, frame);
      return (await worldPositions(page, "sheet")).positions[3 * (30 * 61 + 21) + 1];
    };
    const [ten, eleven] = [await heightAt(10), await heightAt(11)];
    assert.notEqual(ten, eleven);
    assert.equal(await heightAt(10.3), ten);
    await page.keyboard.press("d");
    await page.getByLabel("Interpolate frames").check();
    near(await heightAt(10.25), 0.75 * ten + 0.25 * eleven, 1e-5, "between");
  });
});

test("numbers under the cursor are those of the vertex", async () => {
  const scene = example("travelling");
  await withPage(pageOf(scene), {}, async (page) => {
    run("bake", scene, "-o", "head.npy", "--quiet");
    const { shape, numbers } = readNpy(inFolder("head.npy"));
    await goTo(page, 30);
    // A vertex that faces the camera, and its position on the screen.
    const { vertex, x, y } = await page.evaluate(() => {
      const { viewer, stage } = window.pliant;
      const view = viewer.views[0];
      const toCamera = stage.camera.position.clone().normalize();
      let best = { facing: -1 };
      for (let k = 0; k < view.displacement.length; ++k) {
        const place = view.vertex(k);
        const facing = place.clone().sub(stage.controls.target).normalize().dot(toCamera);
        if (facing <= best.facing) continue;
        const seen = place.project(stage.camera);
        const box = stage.canvas.getBoundingClientRect();
        best = { facing, vertex: k, x: box.left + ((seen.x + 1) / 2) * box.width, y: box.top + ((1 - seen.y) / 2) * box.height };
      }
      return best;
    });
    await page.mouse.move(x, y);
    const readout = page.locator("#readout");
    await readout.getByText("displacement").waitFor();
    const rows = Object.fromEntries(await readout.locator(":scope > span").evaluateAll((all) => all.map((row) => [...row.children].map((each) => each.textContent))));
    assert.match(rows.vertex, new RegExp(`^head ${vertex} \\(\\d+, \\d+\\)$`));
    const at = (frame) => [0, 1, 2].map((k) => numbers[((frame - 1) * shape[1] + vertex) * 3 + k]);
    const length = (a, b) => Math.hypot(...a.map((value, k) => value - b[k]));
    near(Number(rows.displacement), length(at(30), at(1)), 1e-3, "displacement");
    near(parseFloat(rows.velocity), length(at(30), at(29)) * 24, 1e-2, "velocity");
    rows.position.split(", ").forEach((word, k) => near(Number(word), at(30)[k], 1e-3, "position"));
    // The readout follows the vertex, and disappears with the cursor.
    await page.keyboard.press("ArrowRight");
    const later = await readout.textContent();
    assert.ok(later.includes(String(vertex)));
    await page.mouse.move(x, 5);
    await page.waitForFunction(() => document.getElementById("readout").textContent === "");
  });
});

test("styles and colours change what is drawn", async () => {
  await withPage(pageOf(example("sheet")), {}, async (page) => {
    await goTo(page, 12);
    const canvas = page.locator("#view");
    const seen = new Set();
    const look = async (what) => {
      await page.waitForTimeout(150);
      const picture = (await canvas.screenshot()).toString("base64");
      assert.ok(!seen.has(picture), `${what} changes nothing`);
      seen.add(picture);
    };
    await look("the start");
    for (const key of ["w", "w", "v", "v", "g", "t"]) {
      await page.keyboard.press(key);
      await look(key);
    }
  });
});

test("the legend has the peak of the bake", async () => {
  const scene = example("sheet");
  const peak = Number(run("bake", scene, "-o", "peak.npy").match(/peak displacement ([\d.]+)/)[1]);
  await withPage(pageOf(scene), {}, async (page) => {
    near(Number(await page.locator("#legend-high").textContent()), peak, 1e-3, "legend");
    assert.equal(await page.locator("#legend-frames").isVisible(), false);
    await page.keyboard.press("d");
    await page.getByText("Velocity", { exact: true }).click();
    await page.getByText("Velocity [scene units/s]").waitFor();
    await page.getByText("Plain", { exact: true }).click();
    assert.equal(await page.locator("#legend-scale").isVisible(), false);
    assert.deepEqual(await page.locator("#legend-inks span").allTextContents(), ["deforms", "is pushed", "is solved"]);
    await page.evaluate(() => document.activeElement.blur()); // fields keep the keys that they use
    await page.keyboard.press("g");
    assert.equal(await page.locator("#legend").isVisible(), false);
  });
});

test("held nodes have pins that ride on the surface", async () => {
  const scene = (shape, hold) => `<scene version="1" start="1" end="9"><surface name="s">${shape}<material density="0.5" damping="1"/>${hold}
    <transform><animate attribute="translate"><key frame="1" value="0 0 0"/><key frame="9" value="1 2 0"/></animate></transform><solver region="all"/></surface>
    <uniform name="push" magnitude="40" direction="0 1 0" forceRadius="99"/></scene>`;
  const sheet = '<grid columns="9" rows="9" width="8" depth="8"/>';
  const held = [30, 50, 40];
  writeFileSync(inFolder("pins.xml"), scene(sheet, `<hold vertices="${held.join(" ")}"/>`));
  writeFileSync(inFolder("none.xml"), scene(sheet, ""));
  await withPage(pageOf(inFolder("pins.xml")), {}, async (page) => {
    await goTo(page, 9);
    const seen = await page.evaluate(() => {
      const [view] = window.pliant.viewer.views;
      const { pins } = view;
      return { pins: [...view.surface.pins], drawn: pins.visible && pins.geometry.index.count, displaced: [...view.surface.pins].map((k) => view.displacement[k]), most: Math.max(...view.displacement) };
    });
    assert.deepEqual(seen.pins, [...held].sort((a, b) => a - b));
    assert.equal(seen.drawn, held.length);
    assert.ok(Math.max(...seen.displaced) < 1e-3 * seen.most, "a held node is displaced");
    assert.ok((await page.locator("#legend-inks span").allTextContents()).includes("is held"));
    await page.keyboard.press("g");
    assert.equal(await page.evaluate(() => window.pliant.viewer.views[0].pins.visible), false);
  });
  const pink = (name) => {
    run("view", inFolder(`${name}.xml`), "--png", `${name}.png`, "--size", "480x320", "--quiet", "--look", "legend=off&caption=off&theme=light&colour=plain");
    const pixels = pixelsOf(`${name}.png`);
    let count = 0;
    for (let k = 0; k < pixels.length; k += 3) count += pixels[k] > 150 && pixels[k + 1] < 90 && pixels[k + 2] > 50 && pixels[k + 2] < 130;
    return count;
  };
  assert.ok(pink("pins") > 3 * 20, "no pins in the picture");
  assert.equal(pink("none"), 0);
});

/** A moving sheet that a load presses onto a ball and, round it, onto the floor; `colliders` is in their place. */
const pressedScene = (colliders = `<collider name="ball"><sphere radius="3"/><transform translate="0 -3.1 0"/></collider>
  <collider name="floor"><plane/><transform translate="0 -0.3 0"/></collider>`, load = 3000) => `<scene version="1" start="1" end="4">
  <surface name="s"><grid columns="41" rows="41" width="10" depth="10"/><material density="0.002" damping="0.001"/>
    <transform><animate attribute="translate"><key frame="1" value="0 0 0"/><key frame="4" value="0.3 0 0.1"/></animate></transform><solver region="all"/></surface>
  <uniform name="pull" direction="0 -1 0" magnitude="${load}" forceRadius="99"/>${colliders}</scene>`;

test("dots are on the nodes that colliders push, and ride on the surface", async () => {
  const scene = inFolder("pressed.xml");
  writeFileSync(scene, pressedScene());
  run("bake", scene, "-o", "pressed.npy", "--regions", "pressed.json");
  const contacts = JSON.parse(readFileSync(inFolder("pressed.json"), "utf8")).frames.map(({ surfaces }) => Object.fromEntries(surfaces[0].contacts.map(({ collider, nodes }) => [collider, nodes])));
  await withPage(pageOf(scene), {}, async (page) => {
    const dotsAt = async (frame) => {
      await goTo(page, frame);
      const dots = await page.evaluate(() => {
        const [{ dots, mesh }] = window.pliant.viewer.views;
        const { geometry } = dots;
        const isRiding = geometry.getAttribute("position") === mesh.geometry.getAttribute("position") && dots.parent === mesh.parent;
        return { isRiding, isVisible: dots.visible, vertices: [...geometry.index.array.slice(0, geometry.drawRange.count)] };
      });
      assert.ok(dots.isRiding);
      return dots;
    };
    for (const frame of [2, 4, 1, 3]) {
      const { ball = 0, floor = 0 } = contacts[frame - 1];
      const { vertices, isVisible } = await dotsAt(frame);
      assert.equal(vertices.length, ball + floor, `frame ${frame}`);
      assert.equal(isVisible, frame > 1);
      assert.deepEqual(vertices, [...new Set(vertices)].sort((a, b) => a - b));
      const { positions } = await worldPositions(page, "s");
      const places = vertices.map((vertex) => positions.slice(3 * vertex, 3 * vertex + 3));
      const onFloor = places.filter(([, y]) => Math.abs(y + 0.3) < 1e-4);
      assert.equal(onFloor.length, floor);
      // What slides goes along a plane, a little above the ball.
      for (const [x, y, z] of places.filter((place) => !onFloor.includes(place))) near(Math.hypot(x, y + 3.1, z), 3, 0.01, `place on the ball at ${frame}`);
    }
    assert.ok(contacts[2].ball > 4 && contacts[2].floor > 40, "it is not pressed");
    const legend = () => page.locator("#legend-inks span").allTextContents();
    assert.ok((await legend()).includes("touches"));
    await page.keyboard.press("d");
    await page.getByLabel("Colliders", { exact: true }).uncheck();
    assert.equal((await dotsAt(3)).isVisible, false);
    assert.equal((await legend()).includes("touches"), false);
    await page.getByLabel("Colliders", { exact: true }).check();
    assert.equal((await dotsAt(3)).isVisible, true);
    for (const colorScheme of ["dark", "light"]) {
      await page.emulateMedia({ colorScheme });
      await page.waitForTimeout(100);
      await page.screenshot({ path: path.join(pictures, `touching-${colorScheme}.png`) });
    }
  });
  // Without contact, nothing speaks of it.
  writeFileSync(inFolder("apart.xml"), pressedScene('<collider name="ball"><sphere/><transform translate="0 5 0"/></collider>'));
  await withPage(pageOf(inFolder("apart.xml")), {}, async (page) => {
    assert.equal(await page.evaluate(() => "touching" in window.pliant.viewer.bake.head.surfaces[0]), false);
    assert.equal((await page.locator("#legend-inks span").allTextContents()).includes("touches"), false);
  });
});

test("dots are seen on the surface, through a solid, and not crowded", async () => {
  const scene = inFolder("dotted.xml");
  const violet = (look, ...parts) => {
    writeFileSync(scene, pressedScene(...parts));
    run("view", scene, "--png", "dotted.png", "--size", "480x320", "--frame", "4", "--quiet", "--look", `legend=off&caption=off&labels=off&theme=light&colour=plain&gizmos=off&${look}`);
    const pixels = pixelsOf("dotted.png");
    let count = 0;
    for (let k = 0; k < pixels.length; k += 3) count += pixels[k + 2] - pixels[k + 1] > 30 && pixels[k] - pixels[k + 1] > 15;
    return count;
  };
  const dots = violet("tilt=40");
  assert.ok(dots > 100, "no dots in the picture");
  assert.ok(dots < 0.05 * 480 * 320, "they cover the surface");
  assert.equal(violet("tilt=40&colliders=off"), 0);
  // A ball above covers them.
  const above = '<collider name="ball"><sphere radius="2"/><transform><animate attribute="translate"><key frame="1" value="0 2.2 0"/><key frame="4" value="0 0.5 0"/></animate></transform></collider>';
  assert.ok(violet("tilt=80", above, 0) > 4, "no dots behind the ball");
  assert.equal(violet("tilt=80&colliders=off", above, 0), 0);
});

/** A sheet and one collider of each kind, with keys. */
const collidersScene = `<scene version="1" start="1" end="9">
  <surface name="s"><grid columns="9" rows="9" width="10" depth="10"/></surface>
  <collider name="ball" friction="0.5" stick="true"><sphere><animate attribute="radius"><key frame="1" value="1"/><key frame="9" value="2"/></animate></sphere>
    <transform scale="-1 1 1" rotate="10 20 30"><animate attribute="translate"><key frame="1" value="0 3 0"/><key frame="9" value="1 1 2"/></animate></transform></collider>
  <collider name="arm"><capsule radius="0.5"><animate attribute="length"><key frame="1" value="0"/><key frame="9" value="3"/></animate></capsule>
    <transform translate="3 2 1" rotate="0 0 90"/></collider>
  <collider name="crate"><animate attribute="enabled"><key frame="1" value="true"/><key frame="5" value="false"/></animate>
    <box size="1 2 3"/><transform translate="-3 2 1" scale="2 1 1"/></collider>
  <collider name="pad" offset="0.1"><box size="1 2 3" round="0.2"/><transform translate="-3 2 -3" scale="2 1 1"/></collider>
  <collider name="floor"><plane/><transform rotate="0 0 10"><animate attribute="translate"><key frame="1" value="0 -2 0"/><key frame="9" value="4 -2 0"/></animate></transform></collider>
</scene>`;

/** Of each collider that is shown its points in the world, by its name. */
const solidsOf = (page) =>
  page.evaluate(() => {
    const { stage, viewer } = window.pliant;
    stage.draw();
    stage.scene.updateMatrixWorld(true);
    const solids = viewer.colliders.filter(({ group }) => group.visible).map(({ mesh, collider }) => {
      const { array, count } = mesh.geometry.getAttribute("position");
      const m = mesh.matrixWorld.elements;
      const points = Array.from({ length: count }, (_, k) => [0, 1, 2].map((row) => m[row] * array[3 * k] + m[row + 4] * array[3 * k + 1] + m[row + 8] * array[3 * k + 2] + m[row + 12]));
      return [collider.head.name, points];
    });
    return Object.fromEntries(solids);
  });

test("colliders are solids that go with their keys", async () => {
  const scene = inFolder("colliders.xml");
  writeFileSync(scene, collidersScene);
  const [places, radii, lengths] = ["ball.translate", "ball.radius", "arm.length"].map((channel) => curve(scene, channel));
  const floors = curve(scene, "floor.translate");
  await withPage(pageOf(scene), {}, async (page) => {
    const size = (points, axis) => Math.max(...points.map((point) => point[axis])) - Math.min(...points.map((point) => point[axis]));
    for (const frame of [1, 4, 5, 9, 2]) {
      await goTo(page, frame);
      const { ball, arm, crate, pad, floor } = await solidsOf(page);
      const [radius] = radii.get(frame);
      for (const point of ball) near(Math.hypot(...point.map((number, k) => number - places.get(frame)[k])), radius, 1e-5, `ball at ${frame}`);
      near(size(arm, 0), lengths.get(frame)[0] + 1, 1e-4, `arm at ${frame}`); // turned to x
      near(size(arm, 1), 1, 1e-4, `width of the arm at ${frame}`);
      assert.equal(crate !== undefined, frame < 5);
      for (const box of [crate, pad].filter((each) => each)) [2, 2, 3].forEach((length, axis) => near(size(box, axis), length, 1e-5, "box"));
      // The square lies in the plane, near the surface.
      const turn = (10 * Math.PI) / 180;
      const [x] = floors.get(frame);
      assert.equal(floor.length, 4);
      for (const point of floor) near(-Math.sin(turn) * (point[0] - x) + Math.cos(turn) * (point[1] + 2), 0, 1e-4, "floor");
      const middle = [0, 2].map((axis) => floor.reduce((sum, point) => sum + point[axis] / 4, 0));
      assert.ok(Math.hypot(...middle) < 4, `${middle}`);
    }
    // Normals look outwards, and hard edges are hard.
    const looks = await page.evaluate(() =>
      window.pliant.viewer.colliders.slice(0, 4).map(({ mesh }) => {
        const [p, n] = ["position", "normal"].map((name) => mesh.geometry.getAttribute(name).array);
        let least = 1;
        for (let k = 0; k < p.length; k += 3) least = Math.min(least, p[k] * n[k] + p[k + 1] * n[k + 1] + p[k + 2] * n[k + 2]);
        return [least > 0, mesh.material.flatShading];
      }));
    assert.deepEqual(looks, [[true, false], [true, false], [true, true], [true, false]]);
  });
});

/** OBJ text of triangles: a closed prism round y with that many sides and radius 1, between the heights -1 and 1. */
function prism(sides) {
  const all = [...Array(sides).keys()];
  const ring = (y) => all.map((k) => `v ${Math.cos((2 * Math.PI * k) / sides)} ${y} ${Math.sin((2 * Math.PI * k) / sides)}`);
  const faces = all.flatMap((k) => {
    const [low, next] = [k + 1, ((k + 1) % sides) + 1];
    const caps = k < 2 ? [] : [`f 1 ${k} ${low}`, `f ${sides + 1} ${sides + low} ${sides + k}`];
    return [`f ${low} ${sides + low} ${sides + next}`, `f ${low} ${sides + next} ${next}`, ...caps];
  });
  return [...ring(-1), ...ring(1), ...faces, ""].join("\n");
}

test("colliders that are meshes are those of their files, moved by their caches", async () => {
  const scene = inFolder("meshes.xml");
  writeFileSync(inFolder("can.obj"), prism(24));
  writeFileSync(inFolder("post.obj"), prism(4));
  // A cache that makes it larger from frame to frame: .mdd, big endian.
  const still = prism(24).split("\n").filter((line) => line.startsWith("v")).map((line) => line.split(" ").slice(1).map(Number));
  const frames = 4;
  const cache = Buffer.alloc(8 + 4 * frames + 12 * frames * still.length);
  cache.writeInt32BE(frames, 0);
  cache.writeInt32BE(still.length, 4);
  for (let frame = 0; frame < frames; ++frame) {
    cache.writeFloatBE(frame / 24, 8 + 4 * frame);
    still.flat().forEach((number, k) => cache.writeFloatBE((1 + 0.25 * frame) * number, 8 + 4 * frames + 4 * (3 * frame * still.length + k)));
  }
  writeFileSync(inFolder("can.mdd"), cache);
  writeFileSync(scene, `<scene version="1" start="1" end="4"><surface name="s"><grid columns="21" rows="21" width="10" depth="10"/><solver region="all"/></surface>
    <collider name="can"><mesh file="can.obj" cache="can.mdd"/><transform translate="-2 2.5 0"/></collider>
    <collider name="post"><mesh file="post.obj"/><transform scale="-1 0.5 1" rotate="0 20 0"><animate attribute="translate">
      <key frame="1" value="2 1 0"/><key frame="4" value="2 0.2 0"/></animate></transform></collider></scene>`);
  const places = curve(scene, "post.translate");
  await withPage(pageOf(scene), {}, async (page) => {
    for (const frame of [1, 4, 2]) {
      await goTo(page, frame);
      const { can, post } = await solidsOf(page);
      const size = 1 + 0.25 * (frame - 1);
      const rings = can.map(([x, y, z]) => [Math.hypot(x + 2, z) / size, (y - 2.5) / size]);
      for (const [radius, height] of rings) assert.ok(Math.abs(radius - 1) < 1e-4 && Math.abs(Math.abs(height) - 1) < 1e-4, `${radius} ${height}`);
      const [, height] = places.get(frame);
      const turn = (20 * Math.PI) / 180;
      for (const [x, y, z] of post) {
        const across = [Math.cos(turn) * (x - 2) - Math.sin(turn) * z, Math.sin(turn) * (x - 2) + Math.cos(turn) * z];
        near(Math.max(...across.map(Math.abs)), 1, 1e-5, `post at ${frame}`);
        near(Math.abs(y - height), 0.5, 1e-4, `post at ${frame}`);
      }
    }
    // Walls of a can are smooth and its rims hard; all edges of a post are hard. Normals look outwards.
    const normals = await page.evaluate(() =>
      window.pliant.viewer.colliders.map(({ mesh }) => {
        const [p, n] = ["position", "normal"].map((name) => mesh.geometry.getAttribute(name).array);
        return Array.from({ length: p.length / 3 }, (_, k) => [[...p.slice(3 * k, 3 * k + 3)], [...n.slice(3 * k, 3 * k + 3)]]);
      }));
    assert.deepEqual(normals.map(({ length }) => length), [4 * 24, 6 * 4]);
    for (const [p, n] of normals.flat()) {
      const isRim = Math.abs(n[1]) > 0.5;
      near(isRim ? n[1] * Math.sign(p[1]) : n[1], isRim ? 1 : 0, 1e-5, "normal");
      assert.ok(isRim || p[0] * n[0] + p[2] * n[2] > 0.7 * Math.hypot(p[0], p[2]), "it looks inwards");
    }
    for (const [p, n] of normals[0].filter(([, each]) => Math.abs(each[1]) < 0.5)) near((p[0] * n[0] + p[2] * n[2]) / Math.hypot(p[0], p[2]), 1, 1e-3, "wall of the can");
    await goTo(page, 4);
    for (const colorScheme of ["dark", "light"]) {
      await page.emulateMedia({ colorScheme });
      await page.waitForTimeout(100);
      await page.screenshot({ path: path.join(pictures, `meshes-${colorScheme}.png`) });
    }
  });
});

test("colliders are named, listed, and hidden", async () => {
  writeFileSync(inFolder("colliders.xml"), collidersScene);
  const url = pageOf(inFolder("colliders.xml"));
  const shown = async (page) => Object.keys(await solidsOf(page)).join(" ");
  const all = "ball arm crate pad floor";
  await withPage(url, {}, async (page) => {
    assert.equal(await shown(page), all);
    assert.deepEqual((await page.evaluate(() => window.pliant.labels())).sort(), all.split(" ").sort());
    await page.keyboard.press("d");
    const row = (name) => page.locator("#forces li").filter({ hasText: new RegExp(`^${name}`) });
    assert.equal(await row("arm").innerText().then((text) => text.replace(/\s+/g, " ")), "arm capsule solo");
    await row("arm").getByRole("checkbox").uncheck();
    assert.equal(await shown(page), "ball crate pad floor");
    await page.getByRole("button", { name: "Show pad alone" }).click();
    assert.equal(await shown(page), "pad");
    await page.getByRole("button", { name: "Show all forces and colliders" }).click();
    await page.getByLabel("Colliders", { exact: true }).uncheck();
    assert.equal(await shown(page), "");
    assert.deepEqual(await page.evaluate(() => window.pliant.labels()), []);
    // The curve panel has their channels.
    assert.deepEqual(await page.evaluate(() => window.pliant.viewer.bake.head.channels.map(({ path }) => path).sort()),
      ["arm.length", "ball.radius", "ball.translate", "crate.enabled", "floor.translate"]);
    for (const colorScheme of ["dark", "light"]) {
      await page.emulateMedia({ colorScheme });
      await page.getByLabel("Colliders", { exact: true }).check();
      await page.waitForTimeout(100);
      await page.screenshot({ path: path.join(pictures, `colliders-${colorScheme}.png`) });
    }
  });
  for (const [words, expected] of [["colliders=off", ""], ["clean", ""], ["clean&colliders=on", all], ["hide=ball,floor", "arm crate pad"], ["gizmos=off", all]])
    await withPage(`${url}#${words}`, {}, async (page) => assert.equal(await shown(page), expected, words));
  // Without colliders, nothing speaks of them.
  await withPage(pageOf(example("sheet")), {}, async (page) => {
    await page.keyboard.press("d");
    assert.equal(await page.getByLabel("Colliders", { exact: true }).isVisible(), false);
    assert.equal(await page.evaluate(() => "colliders" in window.pliant.viewer.bake.head), false);
  });
});

test("the readout has the values of the collider under the cursor", async () => {
  writeFileSync(inFolder("colliders.xml"), collidersScene);
  await withPage(`${pageOf(inFolder("colliders.xml"))}#frame=5`, {}, async (page) => {
    const at = await page.evaluate(() => {
      const { stage, viewer } = window.pliant;
      const seen = stage.camera.position.clone().setFromMatrixPosition(viewer.colliders[0].group.matrix).project(stage.camera);
      const box = stage.canvas.getBoundingClientRect();
      return [box.left + ((seen.x + 1) / 2) * box.width, box.top + ((1 - seen.y) / 2) * box.height];
    });
    await page.mouse.move(...at);
    await page.waitForFunction(() => document.getElementById("readout").textContent !== "");
    const text = () => page.locator("#readout").innerText().then((words) => words.replace(/\s+/g, " "));
    assert.match(await text(), /^sphere ball position 0\.5\d*, 2\.0\d*, 1\.0\d* deformationRadius 1\.0000 offset 0 friction 0\.50000 stick on radius 1\.5\d*$/);
    await goTo(page, 9);
    assert.match(await text(), /radius 2\.0000$/);
  });
});

test("the camera frames colliders near the surface, while they are drawn", async () => {
  const scene = (height) => `<scene version="1" start="1" end="2"><surface name="s"><grid columns="9" rows="9" width="10" depth="10"/></surface>
    <collider name="ball"><sphere/><transform translate="0 ${height} 0"/></collider></scene>`;
  for (const [height, top] of [[2, 3], [900, 0]]) {
    writeFileSync(inFolder("near.xml"), scene(height));
    await withPage(pageOf(inFolder("near.xml")), {}, async (page) => {
      const aim = () => page.evaluate(() => window.pliant.stage.aim.max.y);
      near(await aim(), top, 1e-5, "top");
      await page.keyboard.press("d");
      await page.getByLabel("Colliders", { exact: true }).uncheck();
      near(await aim(), 0, 1e-5, "top of the sheet");
    });
  }
});

test("the legend of some frames says of which", async () => {
  for (const [frames, words] of [["30:40", "in frames 30 to 40"], ["12", "at frame 12"]]) {
    const peak = Number(run("bake", example("sheet"), "-o", "peak.npy", "--frames", frames).match(/peak displacement ([\d.]+)/)[1]);
    await withPage(pageOf(example("sheet"), "--frames", frames), {}, async (page) => {
      near(Number(await page.locator("#legend-high").textContent()), peak, 1e-3, frames);
      assert.equal(await page.locator("#legend-frames").textContent(), words);
    });
  }
});

/** Largest and smallest number of a surface's vertices along the normal at a frame, and the length that they have. */
const signedAt = async (page, name, frame) => {
  await goTo(page, frame);
  return page.evaluate((wanted) => {
    const { signed, displacement } = window.pliant.viewer.views.find((view) => view.surface.head.name === wanted);
    return { low: Math.min(...signed), high: Math.max(...signed), most: Math.max(...displacement) };
  }, name);
};

/** The colours of the page: the one chosen, and the ends of the legend. */
const coloursOf = (page) =>
  page.evaluate(() => ({
    colour: document.querySelector('input[name="colour"]:checked').value,
    drawn: window.pliant.viewer.display.colour,
    title: document.getElementById("legend-title").textContent,
    ends: ["low", "high"].map((end) => Number(document.getElementById(`legend-${end}`).textContent)),
  }));

test("displacement has a sign where the motion goes both ways", async () => {
  // A sheet pushed up; the same, whose push changes its sign; the same with a way back of a hundredth.
  const sheet = (keys) => `<scene version="1" start="1" end="40"><surface name="s"><grid columns="17" rows="17" width="8" depth="8"/>
    <material density="0.01" damping="0.1"/><solver integrator="backwardEuler"/></surface><point name="p" deformationRadius="3" forceRadius="2"><animate attribute="magnitude">${keys}</animate></point></scene>`;
  const key = (frame, value) => `<key frame="${frame}" value="${value}"/>`;
  for (const [back, colour] of [[0, "displacement"], [-900, "signed"], [-20, "displacement"]]) {
    writeFileSync(inFolder("ways.xml"), sheet(key(1, 0) + key(10, 1000) + key(20, 0) + key(30, back) + key(40, 0)));
    const peak = Number(run("bake", inFolder("ways.xml"), "-o", "ways.npy").match(/peak displacement ([\d.e+-]+)/)[1]);
    // The normal of a sheet is y.
    const { shape: [, vertices], numbers } = readNpy(inFolder("ways.npy"));
    const heights = numbers.filter((_, k) => k % 3 === 1);
    const [low, high] = [Math.min(...heights), Math.max(...heights)];
    const frameWith = (height) => 1 + Math.floor(heights.indexOf(height) / vertices);
    assert.ok(high === peak || Math.abs(high / peak - 1) < 1e-5);
    await withPage(pageOf(inFolder("ways.xml")), {}, async (page) => {
      const first = await coloursOf(page);
      assert.deepEqual([first.colour, first.drawn], [colour, colour]);
      near((await signedAt(page, "s", frameWith(high))).high, high, 1e-3 * peak, "up");
      const down = await signedAt(page, "s", frameWith(low));
      near(down.low, low, 1e-3 * peak, "down");
      if (back === -900) {
        assert.ok(low < -0.5 * peak);
        near(down.most, -down.low, 1e-3 * peak, "down");
      }
      await page.keyboard.press("d");
      await page.getByText("Signed", { exact: true }).click();
      const { title, ends } = await coloursOf(page);
      assert.match(title, /Signed displacement \[scene units\]/);
      near(ends[1], peak, 1e-3 * peak, "top");
      assert.equal(ends[0], -ends[1]);
      // Blue below, red above, neither at rest.
      const hues = await page.evaluate((frames) => {
        const { viewer, playback } = window.pliant;
        const colourAt = (frame) => {
          playback.goTo(frame);
          return [...viewer.views[0].mesh.geometry.getAttribute("color").array.slice(3 * 144, 3 * 144 + 3)];
        };
        return frames.map(colourAt);
      }, [frameWith(high), 1, frameWith(low)]);
      assert.ok(hues[0][0] > 2 * hues[0][2], `${hues[0]}`);
      assert.ok(Math.max(...hues[1]) < 1.3 * Math.min(...hues[1]), `${hues[1]}`);
      if (back === -900) assert.ok(hues[2][2] > 2 * hues[2][0], `${hues[2]}`);
    });
  }
  await withPage(`${pageOf(inFolder("ways.xml"))}#colour=signed`, {}, async (page) => {
    const { colour, drawn } = await coloursOf(page);
    assert.deepEqual([colour, drawn], ["signed", "signed"]);
  });
});

test("outwards is outwards on closed, mirrored and stretched surfaces", async () => {
  const lines = [];
  const [around, along] = [16, 12];
  for (let j = 0; j <= along; ++j) {
    for (let i = 0; i < around; ++i) {
      const [a, b] = [(2 * Math.PI * i) / around, (Math.PI * (j + 0.5)) / (along + 1)];
      lines.push(`v ${Math.sin(b) * Math.sin(a)} ${Math.cos(b)} ${Math.sin(b) * Math.cos(a)}`);
    }
  }
  lines.push("v 0 1 0", "v 0 -1 0");
  const at = (i, j) => 1 + j * around + (i % around);
  for (let i = 0; i < around; ++i) {
    lines.push(`f ${at(i, 0)} ${at(i + 1, 0)} ${around * (along + 1) + 1}`, `f ${at(i + 1, along)} ${at(i, along)} ${around * (along + 1) + 2}`);
    for (let j = 0; j < along; ++j) lines.push(`f ${at(i, j)} ${at(i, j + 1)} ${at(i + 1, j + 1)} ${at(i + 1, j)}`);
  }
  writeFileSync(inFolder("ball.obj"), `${lines.join("\n")}\n`);
  for (const [name, transform] of [["plain", ""], ["mirrored", 'scale="1 1 -1"'], ["stretched", 'scale="-3 0.5 -2" rotate="20 70 -30"'], ["turned", 'scale="-1 -1 -1"']]) {
    writeFileSync(inFolder("ball.xml"), `<scene version="1" start="1" end="8"><surface name="s"><mesh file="ball.obj" uv="surface"/>
      <transform ${transform} translate="4 0 1"/>
      <material density="1" damping="5"/><solver region="all"/></surface>
      <radial name="r" center="4 0 1" forceRadius="8" magnitude="5"/></scene>`);
    for (const sign of [1, -1]) {
      writeFileSync(inFolder("ball.xml"), readFileSync(inFolder("ball.xml"), "utf8").replace(/magnitude="-?5"/, `magnitude="${5 * sign}"`));
      await withPage(pageOf(inFolder("ball.xml")), {}, async (page) => {
        const { low, high, most } = await signedAt(page, "s", 8);
        const [far, back] = sign > 0 ? [high, -low] : [-low, high];
        assert.ok(far > 0.5 * most && most > 0, `${name}: ${low} to ${high} of ${most}`);
        assert.ok(back < 0.1 * most, `${name}: ${low} to ${high} of ${most}`);
      });
    }
  }
});

test("the camera frames the surfaces, and forces only while they are drawn", async () => {
  const scene = (forces) => `<scene version="1" start="1" end="5"><surface name="s"><grid columns="9" rows="9" width="10" depth="10"/></surface>
    <point name="a" deformationRadius="3" forceRadius="2" magnitude="1"/>${forces}</scene>`;
  /** The share of the picture's width that the sheet has. */
  const widthOf = (page) =>
    page.evaluate(() => {
      const { viewer, stage } = window.pliant;
      stage.scene.updateMatrixWorld(true);
      const all = Array.from(viewer.views[0].displacement, (_, k) => viewer.views[0].vertex(k).project(stage.camera));
      const [x, y] = ["x", "y"].map((axis) => all.map((each) => each[axis]));
      if (Math.max(...x, ...y) > 1 || Math.min(...x, ...y) < -1) return 0; // it sticks out
      return Math.max(Math.max(...x) - Math.min(...x), Math.max(...y) - Math.min(...y)) / 2;
    });
  const point = (center, more = "") => `<point name="b" center="${center}" deformationRadius="2" forceRadius="1" magnitude="1" ${more}/>`;
  const look = "gizmos=off";
  writeFileSync(inFolder("aim.xml"), scene(""));
  const url = pageOf(inFolder("aim.xml"));
  let [alone, bare] = [0, 0];
  await withPage(url, {}, async (page) => (alone = await widthOf(page)));
  await withPage(`${url}#${look}`, {}, async (page) => (bare = await widthOf(page)));
  assert.ok(bare >= alone && alone > 0.4 && bare > 0.6, `${bare}, ${alone}`);
  for (const force of [point("50 0 0"), point("0 -70 20"), point("1000 1000 0"), '<line name="b" from="-60 1 0" to="60 1 0" deformationRadius="40" magnitude="1"/>',
    '<point name="b" deformationRadius="2" magnitude="1"><animate attribute="center"><key frame="1" value="0 0 0"/><key frame="5" value="900 0 0"/></animate></point>']) {
    writeFileSync(inFolder("aim.xml"), scene(force));
    await withPage(pageOf(inFolder("aim.xml")), {}, async (page) => near(await widthOf(page), alone, 0.02, force));
  }
  // One that stands beside it is in the picture too, unless it is not drawn.
  writeFileSync(inFolder("aim.xml"), scene(point("6.5 2 0")));
  const beside = pageOf(inFolder("aim.xml"));
  await withPage(beside, {}, async (page) => {
    const wide = await widthOf(page);
    assert.ok(wide < alone - 0.02 && wide > 0.3, `${wide}`);
    await page.keyboard.press("g");
    assert.equal(await widthOf(page), wide); // nothing jumps
    await page.keyboard.press("f");
    near(await widthOf(page), bare, 1e-3, "without forces");
  });
  for (const words of [look, "clean"]) await withPage(`${beside}#${words}`, {}, async (page) => near(await widthOf(page), bare, 1e-3, words));
  for (const words of ["hide=b", "solo=a"]) await withPage(`${beside}#${words}`, {}, async (page) => near(await widthOf(page), alone, 1e-3, words));
  writeFileSync(inFolder("aim.xml"), scene(point("6.5 2 0", 'enabled="false"')));
  await withPage(pageOf(inFolder("aim.xml")), {}, async (page) => near(await widthOf(page), alone, 1e-3, "disabled"));
});

test("each axis can be up", async () => {
  const url = pageOf(example("sheet"));
  for (const [k, up] of ["x", "y", "z"].entries()) {
    for (const words of ["", "&turn=70&tilt=-20", "&tilt=90"]) {
      await withPage(`${url}#up=${up}${words}`, {}, async (page) => {
        // A step along the axis goes straight up in the picture.
        const step = () => page.evaluate((axis) => {
          const { stage } = window.pliant;
          stage.draw();
          const { target } = stage.controls;
          const [from, to] = [0, 1e-3].map((length) => target.clone().setComponent(axis, target.getComponent(axis) + length).project(stage.camera));
          return [to.x - from.x, to.y - from.y];
        }, k);
        const [x, y] = await step();
        assert.ok(Math.abs(x) < 1e-6, `${up}${words}: ${x}, ${y}`);
        if (!words.includes("90")) assert.ok(y > 1e-5, `${up}${words}: ${x}, ${y}`);
        // And so after a drag.
        await page.mouse.move(450, 250);
        await page.mouse.down();
        await page.mouse.move(520, 280, { steps: 3 });
        await page.mouse.up();
        await page.waitForTimeout(300);
        assert.ok(Math.abs((await step())[0]) < 1e-6, `${up}${words}, after a drag`);
      });
    }
  }
});

test("a clean look shows the surfaces only", async () => {
  const shown = (page) => page.evaluate(() => {
    const { stage, viewer, labels } = window.pliant;
    stage.draw();
    const found = [];
    stage.scene.traverseVisible((object) => object.isMesh && object.geometry.getAttribute("position")?.count > 0 && found.push(object.name));
    stage.scene.traverseVisible((object) => object.isLineSegments && found.push("lines"));
    return { found, legend: !document.getElementById("legend").hidden, labels: labels().length, caption: viewer.display.hasCaption };
  });
  const url = pageOf(example("sheet"));
  for (const words of ["clean", "clean=on", "clean&frame=30"]) {
    await withPage(`${url}#${words}`, {}, async (page) => assert.deepEqual(await shown(page), { found: ["sheet"], legend: false, labels: 0, caption: false }, words));
  }
  await withPage(`${url}#clean&legend=on&floor=on`, {}, async (page) => assert.deepEqual(await shown(page), { found: ["sheet", "lines"], legend: true, labels: 0, caption: false }));
  await withPage(`${url}#clean=off`, {}, async (page) => assert.ok((await shown(page)).labels > 0));
});

test("lines on a mirrored surface are drawn as on another", async () => {
  const draw = (scale) => {
    writeFileSync(inFolder("mirror.xml"), `<scene version="1" start="1" end="2"><surface name="s"><grid columns="17" rows="17" width="8" depth="8"/>
      <transform scale="${scale}"/></surface><point name="p" deformationRadius="3" forceRadius="2" magnitude="0.001"/></scene>`);
    const take = (look) => {
      run("view", inFolder("mirror.xml"), "--png", "m.png", "--size", "320x240", "--quiet", "--look", `clean&tilt=60&colour=plain&${look}`);
      return pixelsOf("m.png");
    };
    return differing(take(""), take("regions=on&boxes=on"));
  };
  const plain = draw("1 1 1");
  assert.ok(plain > 300);
  for (const scale of ["1 -1 1", "-1 1 1", "-1 -1 -1"]) near(draw(scale), plain, 0.3 * plain, scale);
});

test("curves are chosen, and go along with the frame", async () => {
  await withPage(pageOf(example("travelling")), {}, async (page) => {
    await page.getByRole("button", { name: "Curves" }).click();
    const options = page.getByRole("listbox", { name: "Animated channels" }).getByRole("option");
    assert.deepEqual(await options.allTextContents(), ["finger.magnitude", "finger.center"]);
    await options.nth(1).click();
    assert.equal(await options.nth(1).getAttribute("aria-selected"), "true");
    assert.match(await page.locator("#curve-view").getAttribute("aria-label"), /finger\.center, 3 keys/);
    const box = await page.locator("#curve-view").boundingBox();
    const track = await page.locator("#timeline").boundingBox();
    await page.mouse.click(track.x + 16 + (39 / 71) * (track.width - 32), box.y + box.height / 2);
    assert.equal(await frameOf(page), 40);
    // One colour per component.
    const colours = await page.evaluate(() => {
      const canvas = document.getElementById("curve-view");
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      const found = new Set();
      for (let k = 0; k < data.length; k += 4) if (data[k + 3] === 255) found.add((data[k] << 16) | (data[k + 1] << 8) | data[k + 2]);
      return window.pliant.themes.palette.curves.slice(0, 3).map((colour) => found.has(parseInt(colour.slice(1), 16)));
    });
    assert.deepEqual(colours, [true, true, true]);
  });
});

/** Positions in the window of the columns of a canvas that have the cursor's colour. */
const cursorIn = (page, id) =>
  page.evaluate((wanted) => {
    const canvas = document.getElementById(wanted);
    const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height }).getContext("2d", { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
    const colour = parseInt(window.pliant.themes.palette.accent.slice(1), 16);
    const counts = new Array(canvas.width).fill(0);
    for (let k = 0; k < data.length; k += 4) {
      const off = Math.abs(data[k] - (colour >> 16)) + Math.abs(data[k + 1] - ((colour >> 8) & 255)) + Math.abs(data[k + 2] - (colour & 255));
      if (data[k + 3] > 40 && off < 30) counts[(k / 4) % canvas.width] += data[k + 3] / 255;
    }
    // The line is the tallest column; it may be between two.
    const most = Math.max(...counts);
    const columns = counts.map((count, k) => [count, k]).filter(([count]) => count > 0.3 * most);
    const middle = columns.reduce((sum, [count, k]) => sum + count * (k + 0.5), 0) / columns.reduce((sum, [count]) => sum + count, 0);
    const box = canvas.getBoundingClientRect();
    return box.left + (middle * box.width) / canvas.width;
  }, id);

for (const [width, height, ratio] of [[1280, 800, 1], [1001, 700, 1.5], [733, 800, 2], [420, 800, 1]]) {
  test(`the curves' frames stand over the timeline's at ${width} x ${height}`, async () => {
    await withPage(pageOf(example("travelling")), { width, height, deviceScaleFactor: ratio }, async (page) => {
      await page.keyboard.press("c");
      await page.waitForTimeout(100);
      for (const frame of [1, 2, 30, 55, 72]) {
        await goTo(page, frame);
        const [above, below] = [await cursorIn(page, "curve-view"), await cursorIn(page, "timeline")];
        near(above, below, 0.75, `frame ${frame}`);
      }
    });
  });
}

test("the value at the cursor is the engine's, for each curve", async () => {
  // Only some of the 400 frames were sampled.
  writeFileSync(inFolder("long.xml"), readFileSync(example("travelling"), "utf8").replace(/end="\d+"/, 'end="400"').replace('file="', `file="${examples}/`));
  const scene = inFolder("long.xml");
  const center = curve(scene, "finger.center");
  await withPage(pageOf(scene, "--frames", "1:400"), {}, async (page) => {
    await page.keyboard.press("c");
    await page.getByRole("option", { name: "finger.center" }).click();
    const told = async () => {
      const [head, ...rows] = await page.locator("#curve-values").evaluate((place) => [place.children[0].textContent, ...[...place.children].slice(1).map((row) => [row.children[1].textContent, Number(row.children[2].textContent), row.className, row.children[0].style.background])]);
      return { frame: Number(head.replace("frame ", "")), rows };
    };
    const check = ({ frame, rows }) => {
      assert.deepEqual(rows.map(([name]) => name), ["finger.center x", "finger.center y", "finger.center z"]);
      rows.forEach(([name, value], k) => near(value, center.get(frame)[k], 1e-6 * Math.max(1, Math.abs(value)), `${name} at frame ${frame}`));
    };
    await goTo(page, 37);
    check(await told());
    assert.equal((await told()).frame, 37);
    // One colour per curve.
    assert.equal(new Set((await told()).rows.map((row) => row[3])).size, 3);
    const box = await page.locator("#curve-view").boundingBox();
    const track = await page.locator("#timeline").boundingBox();
    for (const frame of [13, 21, 43]) {
      await page.mouse.move(track.x + 16 + ((frame - 1) / 399) * (track.width - 32), box.y + 20);
      const now = await told();
      assert.equal(now.frame, frame);
      check(now);
    }
    // The curve under the cursor is marked: move down until one is found.
    let found = "";
    for (let y = 6; y < box.height - 24 && found === ""; y += 4) {
      await page.mouse.move(track.x + 16 + (42 / 399) * (track.width - 32), box.y + y);
      found = (await told()).rows.find((row) => row[2] === "near")?.[0] ?? "";
    }
    assert.match(found, /^finger\.center [xyz]$/);
    await page.mouse.move(5, 5);
    assert.equal((await told()).frame, 37);
  });
});

test("colours of curves differ for every kind of colour vision", async () => {
  await withPage(pageOf(example("sheet")), {}, async (page) => {
    // Machado, Oliveira, Fernandes 2009, at full strength; rows of linear RGB.
    const eyes = {
      all: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
      protan: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
      deutan: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
      tritan: [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]],
    };
    const linear = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
    const times = (rows, v) => rows.map((row) => row.reduce((sum, each, k) => sum + each * v[k], 0));
    const oklab = (rgb) => {
      const lms = times([[0.4122214708, 0.5363325363, 0.0514459929], [0.2119034982, 0.6806995451, 0.1073969566], [0.0883024619, 0.2817188376, 0.6299787005]], rgb.map((v) => Math.min(Math.max(v, 0), 1))).map(Math.cbrt);
      return times([[0.2104542553, 0.793617785, -0.0040720468], [1.9779984951, -2.428592205, 0.4505937099], [0.0259040371, 0.7827717662, -0.808675766]], lms);
    };
    const luminance = (rgb) => 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    for (const theme of ["light", "dark"]) {
      const { curves, panel } = await page.evaluate((wanted) => (window.pliant.themes.choose(wanted), window.pliant.themes.palette), theme);
      for (const [k, colour] of curves.entries()) {
        const [a, b] = [luminance(linear(colour)), luminance(linear(panel))].sort((x, y) => y - x);
        // WCAG 1.4.11 requires 3 : 1 for graphics.
        assert.ok((a + 0.05) / (b + 0.05) >= 3, `${theme} ${colour} on the panel`);
        for (const other of curves.slice(k + 1)) {
          for (const [eye, rows] of Object.entries(eyes)) {
            const [p, q] = [colour, other].map((each) => oklab(times(rows, linear(each))));
            // In OKLab a difference of about 0.02 is visible side by side; lines apart from each
            // other need five times that.
            assert.ok(Math.hypot(...p.map((v, c) => v - q[c])) >= 0.1, `${theme}, ${eye}: ${colour} and ${other}`);
          }
        }
      }
    }
  });
});

test("forces are named, hidden, and shown alone", async () => {
  const scene = `<scene version="1" start="1" end="6"><surface name="s"><grid columns="21" rows="21" width="20" depth="20"/></surface>
    <point name="a" center="-6 0 -6" deformationRadius="3" forceRadius="2" magnitude="50"/><point name="b" center="6 0 -6" deformationRadius="3" forceRadius="2" magnitude="50"/>
    <group name="g" center="0 0 4" deformationRadius="6"><point name="c" center="-3 0 4" magnitude="20"/><point name="d" center="3 0 4" magnitude="20"/></group></scene>`;
  writeFileSync(inFolder("named.xml"), scene);
  const url = pageOf(inFolder("named.xml"));
  const shown = (page) => page.evaluate(() => {
    window.pliant.stage.draw();
    return [...window.pliant.stage.scene.getObjectByName("gizmos").children].filter((each) => each.visible).map((each) => each.name.replace("force ", "")).sort().join("");
  });
  const boxes = (page) => page.evaluate(() => window.pliant.stage.scene.getObjectByName("s force boxes").geometry.ends.length / 6);
  await withPage(url, {}, async (page) => {
    assert.equal(await shown(page), "abcdg");
    assert.deepEqual((await page.evaluate(() => window.pliant.labels())).sort(), ["a", "b", "c", "d", "g"]);
    const all = await boxes(page);
    await page.keyboard.press("d");
    const row = (name) => page.locator("#forces li").filter({ hasText: new RegExp(`^${name}`) });
    await row("a").getByRole("checkbox").uncheck();
    assert.equal(await shown(page), "bcdg");
    assert.ok((await boxes(page)) < all);
    assert.deepEqual((await page.evaluate(() => window.pliant.labels())).sort(), ["b", "c", "d", "g"]);
    assert.match(page.url(), /#hide=a$/);
    await row("g").getByRole("checkbox").uncheck();
    assert.equal(await shown(page), "b");
    await page.getByRole("button", { name: "Show g alone" }).click();
    assert.equal(await shown(page), "cdg");
    await page.getByRole("button", { name: "Show g alone" }).click();
    await page.getByRole("button", { name: "Show all forces" }).click();
    assert.equal(await shown(page), "abcdg");
    assert.doesNotMatch(page.url(), /#/);
    // By keyboard only: one tab stop, arrow keys in the list.
    await row("a").getByRole("checkbox").focus();
    for (const key of ["ArrowDown", "Space"]) await page.keyboard.press(key);
    assert.equal(await shown(page), "acdg");
    for (const key of ["Tab", "Enter"]) await page.keyboard.press(key);
    assert.equal(await shown(page), "b");
    assert.equal(await page.locator("#forces [tabindex='0']").count(), 2);
    await page.keyboard.press("Enter");
    assert.equal(await shown(page), "acdg");
    await page.keyboard.press("n");
    assert.deepEqual(await page.evaluate(() => (window.pliant.stage.draw(), window.pliant.labels())), []);
  });
  for (const [words, expected] of [["hide=a,c", "bdg"], ["solo=c", "c"], ["solo=g&hide=c", "cdg"], ["hide=nobody", "abcdg"]]) {
    await withPage(`${url}#${words}`, {}, async (page) => assert.equal(await shown(page), expected, words));
  }
});

test("names of two hundred forces do not cover each other", async () => {
  await withPage(pageOf(example("rain")), {}, async (page) => {
    await goTo(page, 40);
    const names = await page.evaluate(() => (window.pliant.stage.draw(), window.pliant.labels()));
    const { length } = await page.evaluate(() => window.pliant.viewer.bake.head.forces);
    assert.ok(length > 200);
    assert.ok(names.length >= 5 && names.length <= 60, `${names.length} names`);
    // Forces that push now have labels first; with so many forces the others have none.
    const idle = await page.evaluate(() => window.pliant.viewer.bake.head.forces.filter((force) => force.magnitude && (force.magnitude[39] ?? force.magnitude[0]) === 0).map((force) => force.name));
    assert.deepEqual(names.filter((name) => idle.includes(name)), []);
  });
});

/**
 * Adds `luminances()` to a page: the luminances of the stage's picture, 0 to 1, with its size; row
 * 0 is the bottom.
 */
const installLuminances = (page) =>
  page.evaluate(() => {
    window.luminances = () => {
      const { stage } = window.pliant;
      stage.draw();
      const gl = stage.renderer.getContext();
      const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
      const bytes = new Uint8Array(4 * width * height);
      gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
      const linear = Array.from({ length: 256 }, (_, k) => (k / 255 <= 0.04045 ? k / 255 / 12.92 : ((k / 255 + 0.055) / 1.055) ** 2.4));
      const values = new Float64Array(width * height);
      for (let k = 0; k < values.length; ++k) values[k] = 0.2126 * linear[bytes[4 * k]] + 0.7152 * linear[bytes[4 * k + 1]] + 0.0722 * linear[bytes[4 * k + 2]];
      return { width, height, values };
    };
  });

test("a group's circles lie behind the surface", async () => {
  writeFileSync(inFolder("behind.xml"), `<scene version="1" start="1" end="2"><surface name="s"><grid columns="9" rows="9" width="8" depth="8"/></surface>
    <group name="g" center="0 0 0" deformationRadius="2.5"><point name="a" magnitude="0" center="0 0 0"/></group></scene>`);
  await withPage(`${pageOf(inFolder("behind.xml"))}#boxes=off&regions=off&labels=off&floor=off&turn=0&tilt=80`, {}, async (page) => {
    await installLuminances(page);
    // Seen from above, all three circles are over the sheet.
    const [changed, parts] = await page.evaluate(() => {
      const circles = window.pliant.stage.scene.getObjectByName("force g").children.filter((each) => each.name.endsWith("deformationRadius"));
      const draw = (isShown) => {
        for (const each of circles) each.visible = isShown;
        return window.luminances().values;
      };
      const [without, withCircles] = [draw(false), draw(true)];
      return [without.filter((value, k) => Math.abs(value - withCircles[k]) > 0.01).length, circles.length];
    });
    assert.equal(parts, 1);
    assert.equal(changed, 0);
  });
});

test("a bulge of a tenth of a sheet is plain to see by light alone", async () => {
  writeFileSync(inFolder("bulge.xml"), `<scene version="1" start="1" end="2"><surface name="s"><grid columns="61" rows="61" width="20" depth="20"/>
    <material density="20" damping="400"/></surface><point name="a" center="0 0 0" deformationRadius="5" forceRadius="2" falloff="smooth" magnitude="272000"/></scene>`);
  for (const colorScheme of ["light", "dark"]) {
    await withPage(pageOf(inFolder("bulge.xml")), { colorScheme, width: 1000, height: 700 }, async (page) => {
      await installLuminances(page);
      await goTo(page, 2);
      near(await page.evaluate(() => Math.max(...window.pliant.viewer.views[0].displacement)), 2, 0.1, "a tenth of 20");
      for (const [turn, tilt] of [[32, 28], [0, 90], [0, 60], [-70, 20], [150, 30]]) {
        await page.evaluate((look) => (location.hash = `colour=plain&gizmos=off&boxes=off&regions=off&floor=off&labels=off&${look}`), `turn=${turn}&tilt=${tilt}`);
        await page.waitForTimeout(60);
        // The darker and the brighter tenth of the bulge's flanks; nearly all of the flat part.
        const { low, high, flat } = await page.evaluate(() => {
          const { width, height, values } = window.luminances();
          const { viewer, stage } = window.pliant;
          const view = viewer.views[0];
          const [bulge, plain] = [[], []];
          view.displacement.forEach((moved, k) => {
            const place = view.vertex(k).clone();
            const isRim = Math.max(Math.abs(place.x), Math.abs(place.z)) > 9;
            const { x, y } = place.project(stage.camera);
            const value = values[Math.round(((y + 1) / 2) * height) * width + Math.round(((x + 1) / 2) * width)];
            if (moved > 0.1) bulge.push(value);
            else if (moved < 2e-3 && !isRim) plain.push(value);
          });
          const share = (all, part) => all.sort((a, b) => a - b)[Math.floor(part * (all.length - 1))];
          return { low: share(bulge, 0.1), high: share(bulge, 0.9), flat: [0.05, 0.5, 0.95].map((part) => share(plain, part)) };
        });
        // Michelson's contrast between the flanks. About 0.02 is just visible; ten times that is
        // clear. A light from the front gave 0.17 to 0.19 in all these views except from above.
        assert.ok((high - low) / (high + low) >= 0.25, `${colorScheme}, turned ${turn}, tilted ${tilt}: ${low} to ${high}`);
        // The flat part is between the two flanks, and uniform.
        assert.ok(flat[1] > low && flat[1] < high);
        assert.ok(flat[2] - flat[0] < 0.05);
      }
    });
  }
});

for (const [width, height] of [[360, 640], [768, 1024], [1280, 800], [3840, 2160]]) {
  test(`nothing jumps or sticks out at ${width} x ${height}`, async () => {
    await withPage(pageOf(example("sheet")), { width, height, hasTouch: width < 700 }, async (page) => {
      await page.screenshot({ path: path.join(pictures, `window-${width}.png`) });
      const places = () =>
        page.evaluate(() => {
          const ids = ["view", "timeline", "play", "frame", "loop", "speed", "legend", "frame-all", "help-toggle"];
          return ids.map((id) => {
            const { x, y, right, bottom } = document.getElementById(id).getBoundingClientRect();
            return [id, x, y, right, bottom];
          });
        });
      const before = await places();
      for (const [id, x, y, right, bottom] of before) assert.ok(x >= 0 && y >= 0 && right <= width + 0.5 && bottom <= height + 0.5, `${id} sticks out`);
      assert.equal(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth), false);
      await goTo(page, 96);
      await page.mouse.move(width / 2, height * 0.4);
      await page.waitForTimeout(200);
      await page.keyboard.press("Space");
      await page.waitForTimeout(200);
      await page.keyboard.press("Space");
      assert.deepEqual(await places(), before);
      await page.keyboard.press("c");
      await page.keyboard.press("d");
      await page.waitForTimeout(200);
      await page.screenshot({ path: path.join(pictures, `window-${width}-panels.png`) });
      for (const [id, x, , right, bottom] of await places()) assert.ok(x >= 0 && right <= width + 0.5 && bottom <= height + 0.5, `${id} sticks out`);
    });
  });
}

test("everything that can be worked has a name and takes the focus", async () => {
  await withPage(pageOf(example("sheet")), {}, async (page) => {
    await page.keyboard.press("c");
    await page.keyboard.press("d");
    const nameless = await page.evaluate(() =>
      [...document.querySelectorAll("button, input, select, canvas, [role]")]
        .filter((each) => each.offsetParent !== null && !each.closest("[aria-hidden=true]"))
        .filter((each) => !(each.getAttribute("aria-label") ?? each.labels?.[0]?.textContent ?? each.textContent).trim())
        .map((each) => each.outerHTML),
    );
    assert.deepEqual(nameless, []);
    const reached = new Set();
    for (let k = 0; k < 40; ++k) {
      await page.keyboard.press("Tab");
      reached.add(await page.evaluate(() => document.activeElement.id));
    }
    for (const id of ["frame-all", "theme", "view", "show-gizmos", "channels", "play", "timeline", "frame", "loop", "speed"]) assert.ok(reached.has(id), id);
    await page.setViewportSize({ width: 900, height: 260 });
    await page.keyboard.press("?");
    const keys = page.getByRole("dialog", { name: "Keys" });
    await keys.waitFor();
    const { scrollTop, scrollHeight, clientHeight } = await keys.evaluate((each) => ({ scrollTop: each.scrollTop, scrollHeight: each.scrollHeight, clientHeight: each.clientHeight }));
    assert.ok(scrollTop === 0 && scrollHeight > clientHeight, "it begins at its top");
    await page.keyboard.press("Escape");
    assert.equal(await page.getByRole("dialog").count(), 0);
  });
});

test("light and dark: the system's, then the author's choice", async () => {
  for (const colorScheme of ["dark", "light"]) {
    await withPage(pageOf(example("sheet")), { colorScheme }, async (page) => {
      const theme = () => page.evaluate(() => document.documentElement.dataset.theme);
      assert.equal(await theme(), colorScheme);
      await page.getByRole("button", { name: "Theme" }).click();
      assert.notEqual(await theme(), colorScheme);
    });
  }
});

test("the address sets the look", async () => {
  await withPage(`${pageOf(example("sheet"))}#frame=17&colour=velocity&style=wireframe&gizmos=off&turn=90&tilt=0&theme=light&frame=x`, {}, async (page) => {
    const { display, camera, gizmos } = await page.evaluate(() => ({
      display: window.pliant.viewer.display,
      camera: window.pliant.stage.camera.position.clone().sub(window.pliant.stage.controls.target).normalize().toArray(),
      gizmos: window.pliant.stage.scene.getObjectByName("gizmos").visible,
    }));
    assert.equal(await frameOf(page), 17);
    assert.deepEqual([display.colour, display.style, display.hasGizmos, gizmos], ["velocity", "wireframe", false, false]);
    near(camera[0], 1, 1e-3, "camera");
  });
});

test("a scene's name is text, whatever it is", async () => {
  const name = "a<img src=x onerror=alert(1)>&lt;b.xml";
  writeFileSync(inFolder(name), readFileSync(example("sheet")));
  await withPage(pageOf(inFolder(name)).replace(/[^/]*$/, encodeURIComponent(name.replace(/\.xml$/, ".html"))), {}, async (page) => {
    assert.equal(await page.locator("#scene-name").textContent(), name);
    assert.equal(await page.title(), `${name} – pliant`);
  });
});

test("a page of 10⁴ vertices over 100 frames stays under 5 MB, and loads", async () => {
  writeFileSync(inFolder("large.xml"), `<scene version="1" start="1" end="100"><surface name="s"><grid columns="100" rows="100" width="20" depth="20"/>
    <material density="40" damping="20"/></surface><noise name="n" frequency="0.4" rate="3" deformationRadius="30" forceRadius="30" magnitude="3000"/></scene>`);
  const url = pageOf(inFolder("large.xml"));
  assert.ok(statSync(fileURLToPath(url)).size < 5e6);
  // Printed, not asserted: it depends on the machine and its load.
  const times = [];
  for (let k = 0; k < 3; ++k) {
    await withPage(url, {}, async (page) => times.push(await page.evaluate(() => performance.getEntriesByName("ready")[0].startTime)));
  }
  console.log(`  ready after ${times.map((time) => Math.round(time)).join(", ")} ms`);
});

// The command that serves

async function serve(scene) {
  const command = spawn(pliant, ["view", scene, "--serve"], { stdio: ["ignore", "pipe", "pipe"] });
  const lines = createInterface({ input: command.stdout });
  const url = await new Promise((resolve, reject) => {
    lines.once("line", resolve);
    command.once("exit", () => reject(new Error("it ended")));
  });
  return { url, stop: () => new Promise((resolve) => { command.once("exit", resolve); command.kill("SIGINT"); }) };
}

test("a save changes the page in place", async () => {
  const scene = inFolder("live.xml");
  const text = readFileSync(example("sheet"), "utf8");
  writeFileSync(scene, text);
  const server = await serve(scene);
  try {
    await withPage(server.url, {}, async (page) => {
      await page.waitForFunction(() => window.pliant.viewer.bake !== null);
      await goTo(page, 30);
      await page.evaluate(() => window.pliant.stage.look(77, 11));
      await page.keyboard.press("c");
      const camera = () => page.evaluate(() => window.pliant.stage.camera.position.toArray());
      const [before, peak] = [await camera(), await page.locator("#legend-high").textContent()];
      const times = [];
      for (const [from, to] of [['value="8000"', 'value="12000"'], ['magnitude="3200"', 'magnitude="9000"'], ['end="96"', 'end="60"']]) {
        const shown = await page.evaluate(() => (window.before = window.pliant.viewer.bake, 1));
        assert.equal(shown, 1);
        const saved = Date.now();
        writeFileSync(scene, text.replace(from, to));
        await page.waitForFunction(() => window.pliant.viewer.bake !== window.before, null, { polling: 10 });
        times.push(Date.now() - saved);
      }
      console.log(`  shown after ${times.join(", ")} ms`);
      (await camera()).forEach((number, k) => near(number, before[k], 1e-9, "camera"));
      assert.equal(await frameOf(page), 30);
      assert.equal(await page.locator("#curves").isVisible(), true);
      assert.equal(await page.locator("#summary").textContent(), "60 frames · 24 fps · 3,721 vertices");
      assert.notEqual(peak, "0");

      // The page shows errors with their lines, over its previous content.
      const wrong = text.replace("falloff=", "falof=").replace('density="40"', 'density="forty"');
      writeFileSync(scene, wrong);
      await page.locator(".message.error").first().waitFor();
      const messages = await page.locator(".message.error").allTextContents();
      const lineOf = (word) => wrong.split("\n").findIndex((line) => line.includes(word)) + 1;
      assert.ok(messages.some((each) => each.includes(`line ${lineOf("falof=")}`) && each.includes("falof")), messages.join());
      assert.ok(messages.some((each) => each.includes(`line ${lineOf("forty")}`)), messages.join());
      assert.equal(await frameOf(page), 30);
      await page.screenshot({ path: path.join(pictures, "errors.png") });
      writeFileSync(scene, text);
      await page.waitForFunction(() => document.querySelectorAll(".message.error").length === 0);
    });
  } finally {
    await server.stop();
  }
});

/** What a served page tells of the command and the scene. */
const toldBy = (page) =>
  page.evaluate(() => {
    const { viewer } = window.pliant;
    const canvas = document.getElementById("view");
    window.pliant.stage.draw();
    const gl = canvas.getContext("webgl2");
    const corner = new Uint8Array(4);
    gl.readPixels(2, canvas.height - 3, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, corner);
    return {
      badge: document.getElementById("live").textContent,
      state: document.getElementById("live").dataset.state,
      messages: [...document.querySelectorAll(".message")].map((each) => `${each.className}: ${each.textContent}`),
      frames: viewer.bake?.frameCount ?? null,
      peaks: viewer.bake?.head.surfaces.map((surface) => surface.peakDisplacement) ?? null,
      corner: [...corner],
    };
  });

test("each page shows the last sound animation and the state of the files, whenever it was opened", async () => {
  const home = inFolder("states");
  mkdirSync(home);
  const at = (name) => path.join(home, name);
  const steps = [...Array(7).keys()];
  const corner = (i, j) => `${7 * j + i + 1}/${7 * j + i + 1}`;
  const mesh = [
    ...steps.flatMap((j) => steps.map((i) => `v ${i - 3} 0 ${j - 3}\nvt ${i / 6} ${j / 6}`)),
    ...steps.slice(1).flatMap((j) => steps.slice(1).map((i) => `f ${corner(i - 1, j - 1)} ${corner(i, j - 1)} ${corner(i, j)} ${corner(i - 1, j)}`)),
  ].join("\n");
  const press = (targets, magnitude) => `<point name="poke" targets="${targets}" deformationRadius="3" forceRadius="3" magnitude="${magnitude}"/>`;
  const grid = 'grid columns="9" rows="9"';
  writeFileSync(at("still.xml"), `<scene version="1" start="1" end="6"><surface name="walker"><${grid}/></surface>${press("walker", 90)}</scene>`);
  run("bake", at("still.xml"), "-o", at("walk.npy"), "--quiet");
  const scene = (peak) => `<scene version="1" start="1" end="6">
  <surface name="walker"><${grid} cache="walk.npy"/></surface>
  <surface name="flat"><mesh file="flat.obj"/></surface>
  <include file="forces.xml"/>
  ${press("flat", peak)}
</scene>
`;
  const forces = '<fragment>\n  <point name="push" targets="flat" deformationRadius="2" forceRadius="2" magnitude="5"/>\n</fragment>\n';
  const sound = { "scene.xml": scene("3000"), "forces.xml": forces, "flat.obj": mesh, "walk.npy": readFileSync(at("walk.npy")) };
  for (const [name, text] of Object.entries(sound)) writeFileSync(at(name), text);
  // Broken from the start: a clear page with the error, which comes alive.
  writeFileSync(at("scene.xml"), scene('1" falof="2'));
  const server = await serve(at("scene.xml"));
  const pages = [];
  const openOne = async () => {
    const page = await open(server.url);
    page.setDefaultTimeout(30_000);
    pages.push(page);
    return page;
  };
  try {
    const first = await openOne();
    const has = (page, state) => page.waitForFunction((wanted) => document.getElementById("live").dataset.state === wanted, state);
    /** All pages, one that is loaded again and a new one tell the same. */
    const same = async (what, state) => {
      await openOne();
      await pages[0].reload();
      for (const page of pages) await has(page, state);
      await first.waitForTimeout(150); // whatever is under way has arrived
      const [told, ...others] = await Promise.all(pages.map(toldBy));
      for (const other of others) assert.deepEqual(other, told, what);
      await first.screenshot({ path: path.join(pictures, `serve-${what.replaceAll(" ", "-")}.png`) });
      assert.equal(told.badge, { ready: "live", failed: "error" }[state], what);
      await pages.pop().context().close();
      return told;
    };
    const begun = await same("broken at the start", "failed");
    assert.equal(begun.frames, null);
    assert.match(begun.messages.join(), /^message error: .*scene\.xml, line 5.*falof/);
    assert.deepEqual(begun.corner, [0x15, 0x19, 0x1f, 255]); // the stage of the dark theme
    await openOne();
    writeFileSync(at("scene.xml"), sound["scene.xml"]);
    for (const page of pages) await has(page, "ready");
    const alive = await same("mended", "ready");
    assert.equal(alive.frames, 6);
    assert.ok(!alive.messages.some((each) => each.includes("error")), alive.messages.join());

    const places = { "scene.xml": /scene\.xml, line/, "forces.xml": /forces\.xml, line 2/, "flat.obj": /flat\.obj/, "walk.npy": /walk\.npy/ };
    const wrong = { "scene.xml": scene('1" falof="2'), "forces.xml": forces.replace("magnitude", "magnitud"), "flat.obj": "v 1 2\nf 1 1 1\n", "walk.npy": "no array" };
    for (const [name, place] of Object.entries(places)) {
      const mend = async (how) => {
        how();
        for (const page of pages) await has(page, "ready");
        assert.deepEqual(await toldBy(first), alive, `${name} is back`);
      };
      writeFileSync(at(name), wrong[name]);
      for (const page of pages) await has(page, "failed");
      const broken = await same(`${name} broken`, "failed");
      assert.match(broken.messages.join(), place);
      assert.ok(broken.messages.every((each) => each.startsWith("message error")), broken.messages.join());
      assert.deepEqual([broken.frames, broken.peaks], [alive.frames, alive.peaks]);
      await mend(() => writeFileSync(at(name), sound[name]));
      rmSync(at(name));
      for (const page of pages) await has(page, "failed");
      const gone = await same(`${name} deleted`, "failed");
      assert.match(gone.messages.join(), new RegExp(name.replace(".", "\\.")));
      assert.deepEqual([gone.frames, gone.peaks], [alive.frames, alive.peaks]);
      await mend(() => {
        writeFileSync(at("other"), sound[name]);
        renameSync(at("other"), at(name));
      });
    }
    // Another file under the name, with the same size and the same time of its last change.
    const { atime, mtime, size } = statSync(at("scene.xml"));
    writeFileSync(at("other"), scene("1500"));
    utimesSync(at("other"), atime, mtime);
    utimesSync(at("scene.xml"), atime, mtime);
    await first.waitForTimeout(300);
    await has(first, "ready");
    assert.equal(statSync(at("other")).size, size);
    renameSync(at("other"), at("scene.xml"));
    await first.waitForFunction((peak) => window.pliant.viewer.bake.head.surfaces[1].peakDisplacement < 0.6 * peak, alive.peaks[1]);
    for (const page of pages) assert.deepEqual(page.complaints.filter((each) => !each.includes("404")), []);
  } finally {
    for (const page of pages) await page.context().close();
    await server.stop();
  }
});

test("the address sets the look under --serve too, once", async () => {
  const scene = inFolder("address.xml");
  const text = readFileSync(example("sheet"), "utf8");
  writeFileSync(scene, text);
  const server = await serve(scene);
  try {
    await withPage(`${server.url}#frame=45&theme=light&colour=velocity&gizmos=off&turn=90&tilt=0`, {}, async (page) => {
      await page.waitForFunction(() => window.pliant.viewer.bake !== null);
      const look = () =>
        page.evaluate(() => ({
          theme: document.documentElement.dataset.theme,
          display: [window.pliant.viewer.display.colour, window.pliant.viewer.display.hasGizmos],
          camera: window.pliant.stage.camera.position.clone().sub(window.pliant.stage.controls.target).normalize().toArray(),
        }));
      const { theme, display, camera } = await look();
      assert.equal(await frameOf(page), 45);
      assert.deepEqual([theme, ...display], ["light", "velocity", false]);
      near(camera[0], 1, 1e-3, "camera");
      // A save keeps choices made since.
      await goTo(page, 12);
      await page.evaluate(() => (window.before = window.pliant.viewer.bake));
      writeFileSync(scene, text.replace('value="8000"', 'value="12000"'));
      await page.waitForFunction(() => window.pliant.viewer.bake !== window.before);
      assert.equal(await frameOf(page), 12);
    });
  } finally {
    await server.stop();
  }
});

test("a served page runs nothing but its own, and stands in no frame", async () => {
  const server = await serve(example("sheet"));
  try {
    const page = await open(server.url);
    await page.waitForFunction(() => window.pliant.viewer.bake !== null);
    assert.deepEqual(page.complaints, []);
    const ran = await page.evaluate(async () => {
      const script = document.createElement("script");
      script.textContent = "window.ran = true";
      const image = document.createElement("img");
      image.setAttribute("onerror", "window.ran = true");
      image.src = "data:,";
      document.body.append(script, image);
      await new Promise((done) => setTimeout(done, 300));
      return window.ran ?? false;
    });
    assert.equal(ran, false);
    assert.equal(await page.evaluate(() => fetch("http://localhost:1/").then(() => "asked", (error) => error.name)), "TypeError");
    assert.ok(page.complaints.some((each) => each.includes("Content Security Policy")), page.complaints.join());
    await page.context().close();
  } finally {
    await server.stop();
  }
});

test("a page from elsewhere gets nothing, not even with the address", async () => {
  const server = await serve(example("sheet"));
  const elsewhere = createServer((_, answer) => answer.setHeader("Content-Type", "text/html").end("<!doctype html><title>elsewhere</title>"));
  await new Promise((ready) => elsewhere.listen(0, "127.0.0.1", ready));
  try {
    const { port } = new URL(server.url);
    for (const site of [`http://127.0.0.1:${elsewhere.address().port}/`, `http://localhost:${elsewhere.address().port}/`]) {
      const context = await browser.newContext();
      const page = await context.newPage();
      await page.goto(site);
      const got = await page.evaluate(async ([address, root, path]) => {
        const results = {};
        const ask = (name, ...how) => fetch(...how).then(async (answer) => (results[name] = answer.type === "opaque" ? "opaque" : await answer.text()), () => (results[name] = null));
        await ask("read", `${address}bake`);
        await ask("root", root);
        await ask("blind", `${address}bake`, { mode: "no-cors" });
        // The body contains another request.
        const inner = `GET ${path}bake HTTP/1.1\r\nHost: ${new URL(root).host}\r\n\r\n`;
        await ask("smuggled", root, { method: "POST", mode: "no-cors", body: inner });
        const frame = document.createElement("iframe");
        frame.src = address;
        document.body.append(frame);
        await new Promise((done) => (frame.onload = done));
        results.framed = (() => { try { return frame.contentDocument?.title ?? null; } catch { return null; } })();
        const events = new EventSource(`${address}events`);
        results.events = await new Promise((tell) => { events.onopen = () => tell("open"); events.onerror = () => tell("error"); });
        events.close();
        return results;
      }, [server.url, `http://127.0.0.1:${port}/`, new URL(server.url).pathname]);
      assert.equal(got.read, null);
      assert.equal(got.root, null);
      assert.ok([null, "opaque"].includes(got.blind));
      assert.equal(got.framed, null);
      assert.equal(got.events, "error");
      for (const frame of page.frames().slice(1)) assert.equal(await frame.evaluate(() => document.getElementById("viewer")), null);
      await context.close();
    }
    // And the user's browser still shows the page.
    await withPage(server.url, {}, async (page) => page.waitForFunction(() => window.pliant.viewer.bake !== null));
  } finally {
    elsewhere.close();
    await server.stop();
  }
});

test("pictures have the size and the frame that was asked for", async () => {
  const size = (file) => {
    const bytes = readFileSync(inFolder(file));
    assert.equal(bytes.toString("latin1", 1, 4), "PNG");
    return [bytes.readUInt32BE(16), bytes.readUInt32BE(20)];
  };
  run("view", example("sheet"), "--png", "one.png", "--frame", "12", "--size", "640x360", "--quiet");
  assert.deepEqual(size("one.png"), [640, 360]);
  run("view", example("sheet"), "--png", "other.png", "--frame", "24", "--size", "640x360", "--quiet");
  assert.notDeepEqual(readFileSync(inFolder("one.png")), readFileSync(inFolder("other.png")));
  run("view", example("sheet"), "--png", "again.png", "--frame", "12", "--size", "640x360", "--quiet");
  assert.deepEqual(readFileSync(inFolder("one.png")), readFileSync(inFolder("again.png")));
  run("view", example("sheet"), "--png", "sheet.png", "--contact-sheet", "--size", "200x160", "--quiet");
  assert.deepEqual(size("sheet.png"), [800, 3 * 188 + 76]);
});

test("pictures say which frame they show, and how far it is displaced", async () => {
  const take = (name, look, ...more) => {
    run("view", example("sheet"), "--png", name, "--size", "400x300", "--quiet", "--look", `clean&${look}`, ...more);
    return pixelsOf(name);
  };
  const isIn = (a, b, width, [left, top, right, bottom]) => {
    let [inside, outside] = [0, 0];
    for (let k = 0; k < a.length; k += 3) {
      if (Math.abs(a[k] - b[k]) <= 16) continue;
      const [x, y] = [(k / 3) % width, Math.floor(k / 3 / width)];
      if (x >= left && x < right && y >= top && y < bottom) ++inside;
      else ++outside;
    }
    return [inside, outside];
  };
  const [inside, outside] = isIn(take("c0.png", "", "--frame", "12"), take("c1.png", "caption=on", "--frame", "12"), 400, [0, 0, 260, 40]);
  assert.ok(inside > 200 && outside === 0, `${inside}, ${outside}`);
  // The words are those of the page.
  const peak = run("bake", example("sheet"), "-o", "caption.npy").match(/peak displacement ([\d.]+)/)[1];
  await withPage(pageOf(example("sheet")), {}, async (page) => {
    const most = await page.evaluate(() => Math.max(...Array.from({ length: 96 }, (_, k) => {
      window.pliant.playback.goTo(k + 1);
      const { viewer } = window.pliant;
      const far = Math.max(...viewer.views[0].displacement);
      if (Math.abs(far - viewer.displaced()) > 1e-4 * viewer.ends().high) throw new Error(`frame ${k + 1}: ${far}, not ${viewer.displaced()}`);
      return viewer.displaced();
    })));
    near(most, Number(peak), 1e-5, "peak");
  });
});

// Pictures by other programs

/** Pixels of a frame of a picture or movie, three bytes each. */
function pixelsOf(file, frame = 0) {
  const raw = execFileSync("ffmpeg", ["-v", "error", "-i", inFolder(file), "-vf", `select=eq(n\\,${frame})`, "-frames:v", "1", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"], { maxBuffer: 1e9 });
  return new Uint8Array(raw);
}

const differing = (a, b, least = 24) => {
  assert.equal(a.length, b.length);
  let count = 0;
  for (let k = 0; k < a.length; k += 3) if (Math.max(Math.abs(a[k] - b[k]), Math.abs(a[k + 1] - b[k + 1]), Math.abs(a[k + 2] - b[k + 2])) > least) ++count;
  return count;
};

test("pictures have the legend, and the forces' names", async () => {
  const take = (name, look, ...more) => {
    run("view", example("sheet"), "--png", name, "--size", "640x400", "--quiet", "--look", look, ...more);
    return pixelsOf(name);
  };
  const [plain, legend, labels] = [take("l0.png", "legend=off&labels=off"), take("l1.png", "labels=off"), take("l2.png", "legend=off")];
  // The legend changes pixels only in the lower left corner; names change others too.
  let [corner, elsewhere] = [0, 0];
  for (let k = 0; k < plain.length; k += 3) {
    if (Math.abs(plain[k] - legend[k]) <= 16 && Math.abs(plain[k + 1] - legend[k + 1]) <= 16) continue;
    const [x, y] = [(k / 3) % 640, Math.floor(k / 3 / 640)];
    if (x < 240 && y > 300) ++corner;
    else ++elsewhere;
  }
  assert.ok(corner > 800, `${corner} pixels`);
  assert.equal(elsewhere, 0);
  assert.ok(differing(plain, labels) > 100);
  // Another peak changes the colours; hiding a force changes the picture.
  assert.ok(differing(take("l3.png", "legend=off&labels=off&peak=100", "--frame", "12"), take("l4.png", "legend=off&labels=off", "--frame", "12")) > 500);
  assert.ok(differing(plain, take("l5.png", "legend=off&labels=off&hide=poke,bulge,crease")) > 500);
});

const probe = (file) => {
  const words = ["-v", "error", "-count_frames", "-select_streams", "v:0", "-show_entries", "stream=nb_read_frames,r_frame_rate,width,height,pix_fmt", "-of", "json", inFolder(file)];
  return JSON.parse(execFileSync("ffprobe", words, { encoding: "utf8" })).streams[0];
};

test("movies have the frames, the size and the rate of the scene", async () => {
  writeFileSync(inFolder("ntsc.xml"), readFileSync(example("sheet"), "utf8").replace(/fps="\d+"/, 'fps="24000/1001"'));
  const stills = [12, 16].map((frame) => {
    run("view", inFolder("ntsc.xml"), "--png", "still.png", "--frames", "10:16", "--frame", String(frame), "--size", "322x242", "--quiet");
    return [frame, pixelsOf("still.png")];
  });
  for (const [ending, most] of [["mp4", 24], ["webm", 24], ["gif", 40]]) {
    const out = `m.${ending}`;
    const told = run("view", inFolder("ntsc.xml"), "--movie", out, "--frames", "10:16", "--size", "322x242");
    assert.match(told, new RegExp(`^m\\.${ending}: 7 frames, 322x242 pixels, `));
    const stream = probe(out);
    assert.deepEqual([stream.width, stream.height, Number(stream.nb_read_frames)], [322, 242, 7]);
    if (ending === "gif") {
      // Hundredths of a second.
      const [frames, seconds] = stream.r_frame_rate.split("/").map(Number);
      near(frames / seconds, 24000 / 1001, 1, "rate");
    } else {
      assert.equal(stream.pix_fmt, "yuv420p");
      assert.equal(stream.r_frame_rate, "24000/1001");
    }
    // Frames 12 and 16 match the pictures, up to the codec's losses beside thin lines.
    for (const [frame, still] of stills) {
      const shown = pixelsOf(out, frame - 10);
      const off = still.reduce((sum, value, k) => sum + Math.abs(value - shown[k]), 0) / still.length;
      assert.ok(off < 4, `${ending}, frame ${frame}: ${off} of 255 in the mean`);
      assert.ok(differing(still, shown, 3 * most) < 0.02 * (still.length / 3), `${ending}, frame ${frame}`);
    }
    assert.notDeepEqual(pixelsOf(out, 0), pixelsOf(out, 6));
  }
  assert.deepEqual(readdirSync(folder).filter((name) => name.endsWith(".part")), []);
});

thorough("each frame of a movie is the picture of that frame, to the bit", async () => {
  // A program in ffmpeg's place stores its input.
  const programs = inFolder("programs");
  mkdirSync(programs);
  writeFileSync(path.join(programs, "ffmpeg"), `#!/bin/sh\ncat >"${inFolder("frames.rgba")}"\nfor last; do :; done\necho >"$last"\n`, { mode: 0o755 });
  const env = { ...process.env, PATH: `${programs}:${process.env.PATH}` };
  const [width, height, look] = [322, 242, "colour=velocity&turn=50"];
  for (const [name, first, last] of [["sheet", 9, 20], ["hands", 30, 33]]) {
    const common = ["--size", `${width}x${height}`, "--look", look, "--quiet"];
    execFileSync(pliant, ["view", example(name), "--movie", "whole.mp4", "--frames", `${first}:${last}`, ...common], { cwd: folder, env, timeout: 300_000 });
    const frames = readFileSync(inFolder("frames.rgba"));
    assert.equal(frames.length, (last - first + 1) * 4 * width * height);
    const frameAt = (frame) => frames.subarray((frame - first) * 4 * width * height, (frame - first + 1) * 4 * width * height);
    for (const frame of [first, first + 1, last - 1, last]) {
      run("view", example(name), "--png", "one.png", "--frame", `${frame}`, "--frames", `${first}:${last}`, ...common);
      const one = execFileSync("ffmpeg", ["-v", "error", "-i", inFolder("one.png"), "-f", "rawvideo", "-pix_fmt", "rgba", "-"], { maxBuffer: 1e9 });
      assert.ok(one.equals(frameAt(frame)), `${name}, frame ${frame}`);
    }
    assert.ok(!frameAt(first).equals(frameAt(last)));
  }
});

test("with the command Chromium and ffmpeg end, and their files go", async () => {
  const scratch = inFolder("#scratch ?%41");
  mkdirSync(scratch);
  const processes = () =>
    readdirSync("/proc").filter((name) => {
      try {
        return /^\d+$/.test(name) && ["environ", "cmdline"].some((file) => readFileSync(`/proc/${name}/${file}`, "utf8").includes(scratch));
      } catch {
        return false; // it has ended
      }
    });
  for (const words of [["--movie", "never.mp4"], ["--png", "never.png", "--contact-sheet", "--size", "1000x700"]]) {
    const command = spawn(pliant, ["view", example("sheet"), ...words], { cwd: folder, stdio: "ignore", env: { ...process.env, TMPDIR: scratch } });
    while (command.exitCode === null && processes().length < 8) await new Promise((resume) => setTimeout(resume, 20));
    assert.equal(command.exitCode, null);
    await new Promise((resolve) => { command.once("exit", resolve); command.kill("SIGKILL"); });
    for (let k = 0; k < 500 && (processes().length > 0 || readdirSync(scratch).length > 0); ++k) await new Promise((resume) => setTimeout(resume, 20));
    assert.deepEqual([processes(), readdirSync(scratch)], [[], []]);
    // And a picture can be drawn there.
    execFileSync(pliant, ["view", example("sheet"), words[0], `whole${path.extname(words[1])}`, "--size", "160x100", "--frames", "1:2"], { cwd: folder, env: { ...process.env, TMPDIR: scratch }, timeout: 120_000 });
    assert.deepEqual(readdirSync(scratch), []);
  }
  for (const name of readdirSync(folder).filter((each) => each.endsWith(".part"))) rmSync(inFolder(name));
});

test("a movie that is interrupted leaves nothing", async () => {
  const [out, scratch] = [inFolder("never"), inFolder("scratch")];
  for (const each of [out, scratch]) mkdirSync(each);
  const words = ["view", example("sheet"), "--movie", path.join(out, "never.mp4"), "--size", "640x400"];
  const command = spawn(pliant, words, { stdio: ["ignore", "ignore", "pipe"], env: { ...process.env, TMPDIR: scratch } });
  let errors = "";
  command.stderr.on("data", (text) => (errors += text));
  // ffmpeg starts its file with the first pictures.
  const hasBegun = () => readdirSync(scratch).some((name) => name.startsWith("pliant-view-") && readdirSync(path.join(scratch, name)).includes("movie"));
  while (command.exitCode === null && !hasBegun()) await new Promise((resume) => setTimeout(resume, 20));
  assert.equal(command.exitCode, null, errors);
  const code = await new Promise((resolve) => { command.once("exit", resolve); command.kill("SIGINT"); });
  assert.equal(code, 1);
  assert.match(errors, /^pliant: error: interrupted at frame \d+; no movie was written\n$/);
  assert.deepEqual(readdirSync(out), []);
  assert.deepEqual(readdirSync(scratch).filter((name) => name.startsWith("pliant-view-")), []);
});

sweepTests({ test, run, inFolder, example, withPage, readNpy, near, pictures, pliant, folder });
editTests({ test, run, inFolder, example, open, withPage, readNpy, near, pictures, pliant, folder });

const failures = [];
let passed = 0;
for (const [name, body] of tests) {
  if (only.length > 0 && !only.some((word) => name.includes(word))) continue;
  const begin = Date.now();
  try {
    await body();
    ++passed;
    console.log(`ok      ${name} (${Date.now() - begin} ms)`);
  } catch (error) {
    failures.push(name);
    console.log(`FAILED  ${name}\n${error.stack}`);
    for (const context of browser.contexts()) await context.close();
  }
}
await browser.close();
rmSync(folder, { recursive: true });
for (const name of failures) console.log(`FAILED  ${name}`);
console.log(`${passed} passed, ${failures.length} failed`);
process.exit(failures.length > 0 ? 1 : 0);
