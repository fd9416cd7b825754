// Opens files in headless Chromium with three.js and tinyusdz, and reports the positions of their
// vertices.
//
// usage: node browser.mjs FOLDER CHROMIUM < JOBS
// JOBS is a JSON array of {kind, file, times?, picture?}: file is in FOLDER, kind is gltf, usd,
// tinyusdz, obj, ply or mdd; times are seconds into the animation. Prints a JSON array with the
// results of page.js for each. Servers and browser use this machine only.

import { createServer } from "node:http";
import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";

import puppeteer from "puppeteer-core";

const [folder, chromium] = process.argv.slice(2);
const here = path.dirname(fileURLToPath(import.meta.url));
const roots = { modules: path.join(here, "node_modules"), files: path.resolve(folder), page: here };
const types = { ".js": "text/javascript", ".mjs": "text/javascript", ".wasm": "application/wasm" };

// The icon in the page keeps Chromium from asking for /favicon.ico, which is not here.
const page_html = `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">
<script type="importmap">{"imports": {"three": "/modules/three/build/three.module.js",
  "three/addons/": "/modules/three/examples/jsm/", "tinyusdz": "/modules/tinyusdz/tinyusdz.js"}}</script>
<canvas width="640" height="400"></canvas>
<script type="module" src="/page/page.js"></script>`;

const server = createServer(async (request, response) => {
  const url = new URL(request.url, "http://localhost");
  if (url.pathname === "/") {
    response.writeHead(200, { "Content-Type": "text/html" });
    return response.end(page_html);
  }
  const [, root, ...rest] = url.pathname.split("/").map(decodeURIComponent);
  try {
    const bytes = await readFile(path.join(roots[root], ...rest));
    response.writeHead(200, { "Content-Type": types[path.extname(rest.at(-1))] ?? "application/octet-stream" });
    response.end(bytes);
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));

let input = "";
for await (const chunk of process.stdin) input += chunk;

const browser = await puppeteer.launch({
  executablePath: chromium,
  headless: true,
  args: ["--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
try {
  const page = await browser.newPage();
  const complaints = [];
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => {
    if (["error", "warn"].includes(message.type())) complaints.push(`${message.text()} ${message.location().url ?? ""}`);
  });
  await page.goto(`http://127.0.0.1:${server.address().port}/`);
  await page.waitForFunction(() => window.look !== undefined, undefined, { timeout: 60000 });
  const results = [];
  for (const job of JSON.parse(input)) {
    complaints.length = 0;
    const result = await page.evaluate((each) => window.look(each), job);
    if (job.picture) {
      const canvas = await page.$("canvas");
      await writeFile(job.picture, await canvas.screenshot());
    }
    results.push({ ...result, complaints: [...complaints] });
  }
  console.log(JSON.stringify(results));
} finally {
  await browser.close();
  server.close();
}
