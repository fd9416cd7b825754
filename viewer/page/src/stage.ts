// Camera, light and floor; draws only after changes.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

import type { Palette } from "./theme";

const restTurn = THREE.MathUtils.degToRad(32);
const restTilt = THREE.MathUtils.degToRad(28);

/**
 * A photographer's three-point lighting. `from` is the direction of the lamp in the camera's frame:
 * x to the right, y up, z towards the camera.
 */
const lamps = [
  // The key light hits a sheet seen from the front or from above at a low angle, with half of its
  // effect. So a slope towards it is as much brighter as a slope away from it is darker.
  { from: [-0.95, 0.55, 0.42], colour: 0xfff6ea, strength: 3.9 },
  // The rim light, from behind on the other side, shows edges of parts that turn away.
  { from: [0.75, 0.5, -0.7], colour: 0xe4edff, strength: 1.5 },
  // The fill light brightens the shadows of the key light.
  { from: [0.6, 0.05, 0.8], colour: 0xdde7ff, strength: 0.5 },
];
const ambient = 0.75;

/** Puts the camera and the lamps into the scene. They move with it, so that no side is ever dark. */
export function light(scene: THREE.Scene, camera: THREE.Camera): void {
  for (const { from, colour, strength } of lamps) {
    const lamp = new THREE.DirectionalLight(colour, strength);
    lamp.position.fromArray(from);
    camera.add(lamp, lamp.target);
  }
  scene.add(camera, new THREE.AmbientLight(0xffffff, ambient));
}

export const axes = { x: new THREE.Vector3(1, 0, 0), y: new THREE.Vector3(0, 1, 0), z: new THREE.Vector3(0, 0, 1) };
export type Axis = keyof typeof axes;

/** Turns a scene whose vertical is y into one whose vertical is `up`. */
function uprightTo(up: THREE.Vector3): THREE.Quaternion {
  return new THREE.Quaternion().setFromUnitVectors(axes.y, up);
}

/** The way to the camera where y is up: turned about the vertical and tilted up, in degrees. */
export function wayOf(turn?: number, tilt?: number): THREE.Vector3 {
  const a = turn === undefined ? restTurn : THREE.MathUtils.degToRad(turn);
  const b = tilt === undefined ? restTilt : THREE.MathUtils.degToRad(tilt);
  return new THREE.Vector3(Math.sin(a) * Math.cos(b), Math.sin(b), Math.cos(a) * Math.cos(b));
}

/** Near and far enough for a box. */
export function bound(camera: THREE.PerspectiveCamera, box: THREE.Box3): void {
  const size = Math.max(box.getSize(new THREE.Vector3()).length(), 1e-12);
  camera.near = size / 500;
  camera.far = size * 50;
  camera.updateProjectionMatrix();
}

/** Looks at the box from `way`, where y is up, so that its corners fill the picture up to a margin. */
export function fit(camera: THREE.PerspectiveCamera, box: THREE.Box3, from: THREE.Vector3): void {
  const center = box.getCenter(new THREE.Vector3());
  const upright = uprightTo(camera.up);
  const way = from.clone().applyQuaternion(upright);
  const side = camera.up.clone().cross(way);
  if (side.lengthSq() < 1e-9) side.set(1, 0, 0).applyQuaternion(upright);
  side.normalize();
  const over = way.clone().cross(side);
  const tanV = Math.tan(THREE.MathUtils.degToRad(camera.fov / 2));
  const tanH = tanV * camera.aspect;
  let distance = 0;
  for (let k = 0; k < 8; ++k) {
    const corner = new THREE.Vector3(k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y, k & 4 ? box.max.z : box.min.z).sub(center);
    const depth = corner.dot(way);
    distance = Math.max(distance, depth + Math.abs(corner.dot(side)) / tanH, depth + Math.abs(corner.dot(over)) / tanV);
  }
  camera.position.copy(center).addScaledVector(way, 1.04 * Math.max(distance, 1e-12));
  camera.lookAt(center);
}

/** A round size for cells of which about twenty make the extent. */
export function roundCell(extent: number): number {
  const power = 10 ** Math.floor(Math.log10(extent / 10));
  return [1, 2, 5, 10].map((k) => k * power).find((each) => each >= extent / 20)!;
}

/** A grid of squares of a round size under a box. */
export function floorUnder(placed: THREE.Box3, up: THREE.Vector3, axisColour: string, colour: string): THREE.GridHelper {
  const upright = uprightTo(up);
  const box = placed.clone().applyMatrix4(new THREE.Matrix4().makeRotationFromQuaternion(upright.clone().invert()));
  const size = box.getSize(new THREE.Vector3());
  const extent = 1.5 * Math.max(size.x, size.z, 0.3 * size.y, 1e-9);
  const cell = roundCell(extent);
  const count = 2 * Math.ceil(extent / cell / 2);
  const grid = new THREE.GridHelper(count * cell, count, axisColour, colour);
  const center = box.getCenter(new THREE.Vector3());
  grid.position.set(Math.round(center.x / cell) * cell, box.min.y - 0.02 * size.length(), Math.round(center.z / cell) * cell).applyQuaternion(upright);
  grid.quaternion.copy(upright);
  return grid;
}

export class Stage {
  readonly scene = new THREE.Scene();
  readonly camera = new THREE.PerspectiveCamera(35, 1, 0.1, 1000);
  readonly renderer: THREE.WebGLRenderer;
  controls: OrbitControls;
  /** The box that the camera frames. */
  aim = new THREE.Box3(new THREE.Vector3(-1, -1, -1), new THREE.Vector3(1, 1, 1));
  private floor = new THREE.Group();
  private box = new THREE.Box3(new THREE.Vector3(-1, -1, -1), new THREE.Vector3(1, 1, 1));
  private isStale = true;
  private isPinned = false;
  private floorColours = ["#888888", "#444444"];
  private readonly listeners: (() => void)[] = [];

  constructor(readonly canvas: HTMLCanvasElement) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
    light(this.scene, this.camera);
    this.scene.add(this.floor);
    this.controls = this.newControls();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement!);
    this.resize();
    const loop = () => {
      requestAnimationFrame(loop);
      this.controls.update();
      if (this.isStale) this.draw();
    };
    requestAnimationFrame(loop);
  }

  invalidate(): void {
    this.isStale = true;
  }

  draw(): void {
    this.isStale = false;
    this.renderer.render(this.scene, this.camera);
    for (const listener of this.listeners) listener();
  }

  /** Draws, and returns the picture once it is finished: meanwhile the next one can be drawn. */
  async drawPixels(): Promise<ImageData> {
    this.draw();
    const { width, height } = this.canvas;
    const context = this.renderer.getContext() as WebGL2RenderingContext;
    const buffer = context.createBuffer();
    const picture = new ImageData(width, height);
    context.bindBuffer(context.PIXEL_PACK_BUFFER, buffer);
    context.bufferData(context.PIXEL_PACK_BUFFER, picture.data.length, context.STREAM_READ);
    context.readPixels(0, 0, width, height, context.RGBA, context.UNSIGNED_BYTE, 0);
    context.bindBuffer(context.PIXEL_PACK_BUFFER, null);
    const end = context.fenceSync(context.SYNC_GPU_COMMANDS_COMPLETE, 0)!;
    context.flush();
    while (context.getSyncParameter(end, context.SYNC_STATUS) !== context.SIGNALED) await new Promise((resume) => setTimeout(resume));
    const upwards = new Uint8Array(picture.data.length);
    context.bindBuffer(context.PIXEL_PACK_BUFFER, buffer);
    context.getBufferSubData(context.PIXEL_PACK_BUFFER, 0, upwards);
    context.bindBuffer(context.PIXEL_PACK_BUFFER, null);
    context.deleteBuffer(buffer);
    context.deleteSync(end);
    const row = 4 * width;
    for (let y = 0; y < height; ++y) picture.data.set(upwards.subarray(y * row, (y + 1) * row), (height - 1 - y) * row);
    return picture;
  }

  /** Calls `listener` after each drawing. */
  onDraw(listener: () => void): void {
    this.listeners.push(listener);
  }

  /** Sets the box that everything is in. */
  bound(box: THREE.Box3): void {
    this.box = box.clone();
    bound(this.camera, box);
    this.boundControls();
    this.buildFloor();
  }

  /** The axis that is upright in the picture; y at first. Call `look` after it. */
  set up(axis: Axis) {
    if (this.camera.up.equals(axes[axis])) return;
    this.camera.up.copy(axes[axis]);
    this.controls.dispose();
    this.controls = this.newControls(); // which take the upright axis once
    this.boundControls();
    this.buildFloor();
  }

  /** Fits everything into the view, from the camera's present direction. */
  frameAll(): void {
    const toCamera = this.camera.position.clone().sub(this.controls.target).applyQuaternion(uprightTo(this.camera.up).invert());
    if (toCamera.lengthSq() === 0) toCamera.set(0, 0, 1);
    this.lookFrom(toCamera.normalize());
  }

  /** Resets the view, or turns it about the vertical and tilts it; in degrees. */
  look(turn?: number, tilt?: number): void {
    this.lookFrom(wayOf(turn, tilt));
  }

  /** Fixes the size of the picture, independent of the page, and fits the view to it. */
  pin(width: number, height: number): void {
    const { width: before, height: above } = this.canvas;
    if (this.isPinned && before === width && above === height) return; // a new buffer for each picture takes time
    this.isPinned = true;
    this.resizeTo(width, height, 1);
    this.frameAll();
  }

  private resizeTo(width: number, height: number, ratio: number): void {
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.invalidate();
  }

  colour(palette: Palette): void {
    this.scene.background = new THREE.Color(palette.background);
    this.floorColours = [palette.floorAxis, palette.floor];
    this.buildFloor();
    this.invalidate();
  }

  set hasFloor(isShown: boolean) {
    this.floor.visible = isShown;
    this.invalidate();
  }

  private resize(): void {
    if (this.isPinned) return;
    const place = this.canvas.parentElement!.getBoundingClientRect();
    if (place.width === 0 || place.height === 0) return;
    this.resizeTo(place.width, place.height, Math.min(devicePixelRatio, 2));
    // Draw at once: resizing erased the picture.
    this.draw();
  }

  private lookFrom(way: THREE.Vector3): void {
    this.controls.target.copy(this.aim.getCenter(new THREE.Vector3()));
    fit(this.camera, this.aim, way);
    this.controls.update();
    this.invalidate();
  }

  private newControls(): OrbitControls {
    const controls = new OrbitControls(this.camera, this.canvas);
    controls.enableDamping = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    controls.dampingFactor = 0.12;
    controls.addEventListener("change", () => this.invalidate());
    return controls;
  }

  private boundControls(): void {
    const size = Math.max(this.box.getSize(new THREE.Vector3()).length(), 1e-12);
    this.controls.minDistance = size / 100;
    this.controls.maxDistance = size * 12;
  }

  private buildFloor(): void {
    this.floor.clear();
    this.floor.add(floorUnder(this.box, this.camera.up, this.floorColours[0], this.floorColours[1]));
  }
}
