// Run by browser.mjs in the page: opens a file and reports the positions of its vertices.

import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MDDLoader } from "three/addons/loaders/MDDLoader.js";
import { OBJLoader } from "three/addons/loaders/OBJLoader.js";
import { PLYLoader } from "three/addons/loaders/PLYLoader.js";
import { USDLoader } from "three/addons/loaders/USDLoader.js";
import { USDAParser } from "three/addons/loaders/usd/USDAParser.js";
import initTinyUsdz from "tinyusdz";

const renderer = new THREE.WebGLRenderer({
  canvas: document.querySelector("canvas"),
  antialias: true,
  preserveDrawingBuffer: true,
});

const url_of = (job) => `/files/${encodeURIComponent(job.file)}`;
const numbers = (array) => Array.from(array);

// Renders everything, lit from the side, so that the vertex shader has used the morph targets.
function render(object) {
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0xf4f1ea);
  scene.add(object, new THREE.HemisphereLight(0xffffff, 0x556677, 1.5));
  const sun = new THREE.DirectionalLight(0xffffff, 2.5);
  sun.position.set(-3, 6, 4);
  scene.add(sun);
  const box = new THREE.Box3().setFromObject(object, true);
  const size = box.getSize(new THREE.Vector3()).length();
  const camera = new THREE.PerspectiveCamera(35, 640 / 400, size / 100, size * 10);
  camera.position.copy(box.getCenter(new THREE.Vector3())).add(new THREE.Vector3(0.5, 0.6, 1).multiplyScalar(size));
  camera.lookAt(box.getCenter(new THREE.Vector3()));
  renderer.render(scene, camera);
}

// World positions of a mesh with its morph targets at their present weights.
function positions_of(mesh) {
  const count = mesh.geometry.attributes.position.count;
  const vertex = new THREE.Vector3();
  const result = [];
  for (let k = 0; k < count; ++k) {
    mesh.getVertexPosition(k, vertex).applyMatrix4(mesh.matrixWorld);
    result.push(vertex.x, vertex.y, vertex.z);
  }
  return result;
}

// The meshes of a node are its materials: they share the same vertices.
const first_mesh = (node) => {
  let found = null;
  node.traverse((each) => { if (each.isMesh) found ??= each; });
  return found;
};

async function look_at_gltf(job) {
  const gltf = await new GLTFLoader().loadAsync(url_of(job));
  const nodes = [...gltf.scene.children];
  const mixer = new THREE.AnimationMixer(gltf.scene);
  for (const clip of gltf.animations) {
    const action = mixer.clipAction(clip);
    action.setLoop(THREE.LoopOnce);
    action.clampWhenFinished = true;
    action.play();
  }
  const materials = new Set();
  gltf.scene.traverse((each) => { if (each.isMesh) materials.add(each.material.name); });
  const result = { surfaces: {}, uvs: {}, normals: {}, duration: gltf.animations[0]?.duration, materials: [...materials] };
  for (const time of job.times) {
    mixer.setTime(time);
    gltf.scene.updateMatrixWorld(true);
    for (const node of nodes) {
      const name = node.userData.name ?? node.name;
      (result.surfaces[name] ??= []).push(positions_of(first_mesh(node)));
    }
    if (job.picture && time === job.times[job.picture_at ?? 0]) render(gltf.scene);
  }
  for (const node of nodes) {
    const name = node.userData.name ?? node.name;
    const geometry = first_mesh(node).geometry;
    result.uvs[name] = numbers(geometry.attributes.uv?.array ?? []);
    result.normals[name] = numbers(geometry.attributes.normal.array);
  }
  return result;
}

// The samples that three.js's parser reads, and whether its composer makes meshes of them.
async function look_at_usd(job) {
  const text = await (await fetch(url_of(job))).text();
  const { specsByPath } = new USDAParser().parseData(text);
  const samples = {};
  for (const [path, spec] of Object.entries(specsByPath)) {
    const { timeSamples } = spec.fields;
    if (timeSamples) samples[path] = { times: timeSamples.times, values: timeSamples.values.map((value) => Array.isArray(value) || ArrayBuffer.isView(value) ? numbers(value) : value) };
  }
  const bytes = new TextEncoder().encode(text).buffer;
  const loader = new USDLoader();
  const group = loader.parse(bytes) ?? (await loader.loadAsync(url_of(job)));
  const meshes = [];
  group.traverse((each) => { if (each.isMesh) meshes.push({ name: each.name, triangles: each.geometry.attributes.position.count / 3 }); });
  if (job.picture) render(group);
  return { samples, meshes, layer: specsByPath["/"].fields };
}

let tiny = null;
async function look_at_tinyusdz(job) {
  tiny ??= await initTinyUsdz({ locateFile: () => "/modules/tinyusdz/tinyusdz.wasm" });
  const bytes = new Uint8Array(await (await fetch(url_of(job))).arrayBuffer());
  const loader = new tiny.TinyUSDZLoaderNative();
  const is_loaded = loader.loadFromBinary(bytes, job.file);
  const result = { is_loaded, message: loader.error(), meshes: [] };
  for (let k = 0; is_loaded && k < loader.numMeshes(); ++k) {
    const mesh = loader.getMesh(k);
    result.meshes.push({ points: numbers(mesh.points), counts: numbers(mesh.faceVertexCounts ?? []), indices: numbers(mesh.faceVertexIndices ?? []), keys: Object.keys(mesh) });
  }
  return result;
}

async function look_at_obj(job) {
  const group = await new OBJLoader().loadAsync(url_of(job));
  const meshes = [];
  group.traverse((each) => {
    if (each.isMesh) meshes.push({ name: each.name, positions: numbers(each.geometry.attributes.position.array),
      materials: [each.material].flat().map((material) => material.name), flat: [each.material].flat().map((material) => material.flatShading) });
  });
  return { meshes };
}

async function look_at_ply(job) {
  const geometry = await new PLYLoader().loadAsync(url_of(job));
  return { positions: numbers(geometry.attributes.position.array), uvs: numbers(geometry.attributes.uv?.array ?? []) };
}

async function look_at_mdd(job) {
  const { morphTargets, clip } = await new MDDLoader().loadAsync(url_of(job));
  return { frames: morphTargets.map((target) => numbers(target.array)), duration: clip.duration };
}

const looks = { gltf: look_at_gltf, usd: look_at_usd, tinyusdz: look_at_tinyusdz, obj: look_at_obj, ply: look_at_ply, mdd: look_at_mdd };
window.look = (job) => looks[job.kind](job);
