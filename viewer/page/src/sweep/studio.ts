// Draws takes one at a time: one camera, one light and one scale of colours for all.

import * as THREE from "three";

import { displacementRamp } from "../ramp";
import { bends } from "../relief";
import { axes, bound, fit, floorUnder, light, wayOf, type Axis } from "../stage";
import { paintNumbers, sizeOf, surfaceMaterial, turnNormals } from "../surface_look";
import type { Palette } from "../theme";
import type { Sweep, TakeShape } from "./sweep";

interface TakeMesh {
  mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshStandardMaterial>;
  displaced: Float32Array;
  /** The number of the top colour that its colours have; -1: it has none yet. */
  peak: number;
}

export class Studio {
  private readonly canvas = document.createElement("canvas");
  /** null: the browser has no WebGL 2. */
  private readonly renderer: THREE.WebGLRenderer | null;
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(35, 1, 0.1, 1000);
  private readonly material = surfaceMaterial();
  private readonly meshes = new Map<TakeShape, TakeMesh>();
  private readonly indices = new Map<number, { index: THREE.BufferAttribute; edges: Uint32Array }>();
  private readonly box = new THREE.Box3();
  private readonly largest: number;
  private floor: THREE.GridHelper | null = null;
  private chosenPeak: number | null = null;
  private turned: number | undefined;
  private tilted: number | undefined;

  constructor(sweep: Sweep) {
    const context = this.canvas.getContext("webgl2", { antialias: true });
    this.renderer = context && new THREE.WebGLRenderer({ canvas: this.canvas, context });
    // Otherwise the page waits for the shaders, which are those of the viewer.
    if (this.renderer) this.renderer.debug.checkShaderErrors = false;
    light(this.scene, this.camera);
    // Giants reach out of the picture, and have the top colour.
    const fitted = sweep.shapes.filter(({ isGiant }) => !isGiant);
    for (const { low, high } of fitted) this.box.expandByPoint(new THREE.Vector3(...low)).expandByPoint(new THREE.Vector3(...high));
    if (this.box.isEmpty()) this.box.set(new THREE.Vector3(-1, -1, -1), new THREE.Vector3(1, 1, 1));
    bound(this.camera, this.box);
    const { values } = sweep.measures.find(({ name }) => name === "peak")!;
    this.largest = Math.max(0, ...fitted.map(({ row }) => values[row]));
  }

  get canDraw(): boolean {
    return this.renderer !== null;
  }

  /** The number of the top colour. */
  get peak(): number {
    return this.chosenPeak ?? this.largest;
  }

  /** null: the largest displacement, over all frames, of the takes that are fitted into the pictures. */
  setPeak(peak: number | null): void {
    this.chosenPeak = peak;
  }

  colour(palette: Palette): void {
    this.scene.background = new THREE.Color(palette.background);
    if (this.floor) this.scene.remove(this.floor);
    this.floor = floorUnder(this.box, this.camera.up, palette.floorAxis, palette.floor);
    this.scene.add(this.floor);
  }

  /** The axis that is upright in the pictures. Call `colour` after it. */
  set up(axis: Axis) {
    this.camera.up.copy(axes[axis]);
  }

  /** The camera's place, in degrees; none: as at first. */
  look(turn?: number, tilt?: number): void {
    [this.turned, this.tilted] = [turn, tilt];
  }

  /** Turns the camera by some degrees. */
  turnBy(turn: number, tilt: number): void {
    const way = wayOf(this.turned, this.tilted);
    const nowTurned = THREE.MathUtils.radToDeg(Math.atan2(way.x, way.z));
    const nowTilted = THREE.MathUtils.radToDeg(Math.asin(way.y));
    this.look(nowTurned + turn, Math.min(Math.max(nowTilted + tilt, -89), 89));
  }

  /** Draws a take into a rectangle of a canvas; nothing if it cannot draw. [px of the canvas] */
  draw(shape: TakeShape, context: CanvasRenderingContext2D, left: number, top: number, width: number, height: number): void {
    if (!this.renderer) return;
    if (this.canvas.width !== width || this.canvas.height !== height) this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    fit(this.camera, this.box, wayOf(this.turned, this.tilted));
    const take = this.take(shape);
    this.paint(take);
    this.scene.add(take.mesh);
    this.renderer.render(this.scene, this.camera);
    this.scene.remove(take.mesh);
    context.drawImage(this.canvas, left, top);
  }

  private take(shape: TakeShape): TakeMesh {
    const there = this.meshes.get(shape);
    if (there) return there;
    const { triangles } = shape;
    const { positions, displaced } = shape.unpack();
    let shared = this.indices.get(shape.mesh);
    if (!shared) this.indices.set(shape.mesh, (shared = { index: new THREE.BufferAttribute(triangles, 1), edges: edgesOf(triangles) }));
    const count = positions.length;
    const normals = new Float32Array(count);
    turnNormals(positions, triangles, normals);
    const relief = new Float32Array(count / 3);
    bends(positions, normals, shared.edges, sizeOf(positions), relief, new Uint8Array(count / 3));
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(count), 3));
    geometry.setAttribute("relief", new THREE.BufferAttribute(relief, 1));
    geometry.setIndex(shared.index);
    const mesh = new THREE.Mesh(geometry, this.material);
    mesh.frustumCulled = false;
    const take = { mesh, displaced, peak: -1 };
    this.meshes.set(shape, take);
    return take;
  }

  private paint(take: TakeMesh): void {
    if (take.peak === this.peak) return;
    take.peak = this.peak;
    const colours = take.mesh.geometry.getAttribute("color") as THREE.BufferAttribute;
    paintNumbers(take.displaced, 0, this.peak, displacementRamp, colours.array as Float32Array);
    colours.needsUpdate = true;
  }
}

/** The sides of triangles, each side between two of the same orientation once. */
function edgesOf(triangles: Uint32Array): Uint32Array {
  const edges: number[] = [];
  for (let k = 0; k < triangles.length; k += 3) {
    for (let side = 0; side < 3; ++side) {
      const [a, b] = [triangles[k + side], triangles[k + ((side + 1) % 3)]];
      if (a < b) edges.push(a, b);
    }
  }
  return Uint32Array.from(edges);
}
