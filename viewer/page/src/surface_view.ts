// One surface in the scene graph: shape, shading, colours.

import * as THREE from "three";

import { matrixBetween, type ShownSurface } from "./bake";
import { bends } from "./relief";
import { displacementRamp, signedRamp, velocityRamp, type Ramp } from "./ramp";
import { dotMaterial, meanLength, paintNumbers, pinMaterial, sizeOf, surfaceMaterial, turnNormals } from "./surface_look";
import type { Palette } from "./theme";

export type Style = "shaded" | "lines" | "wireframe";
export type Colour = "plain" | "displacement" | "signed" | "velocity";
/** The numbers at the ends of the colours. */
export type Ends = { low: number; high: number };

export const ramps: Record<Exclude<Colour, "plain">, Ramp> = { displacement: displacementRamp, signed: signedRamp, velocity: velocityRamp };

/**
 * p_world = transform · (origin + p), as a three.js matrix; between frames each number is
 * interpolated.
 */
function placement(surface: ShownSurface, index: number, share: number): THREE.Matrix4 {
  const { origin, transforms } = surface.head;
  return matrixBetween(transforms, index, share, new THREE.Matrix4()).multiply(new THREE.Matrix4().makeTranslation(...origin));
}

/** Where an arrow along a normal stands. */
export interface Foot {
  place: THREE.Vector3;
  normal: THREE.Vector3;
}

export class SurfaceView {
  readonly group = new THREE.Group();
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshStandardMaterial>;
  /** Length for each vertex at the frame shown, world space. */
  readonly displacement: Float32Array;
  /** The displacement along the normal of the surface at rest, below 0 against it. */
  readonly signed: Float32Array;
  readonly speed: Float32Array;
  private readonly lines: THREE.LineSegments<THREE.BufferGeometry, THREE.LineBasicMaterial>;
  /** On the held nodes. */
  readonly pins: THREE.Points<THREE.BufferGeometry, THREE.PointsMaterial>;
  /** On the nodes that colliders push at the frame shown. */
  readonly dots: THREE.Points<THREE.BufferGeometry, THREE.PointsMaterial>;
  private readonly dotsBehind: THREE.Points<THREE.BufferGeometry, THREE.PointsMaterial>;
  private readonly offsets: Float32Array;
  private readonly offsetsBefore: Float32Array;
  private readonly restOffsets: Float32Array;
  private readonly restNormals: Float32Array;
  private readonly edgeCounts: Uint8Array;
  private readonly size: number;
  private plain = new THREE.Color();
  private readonly dotRim = new THREE.Color();

  constructor(
    readonly surface: ShownSurface,
    private readonly fps: number,
  ) {
    const count = surface.rest.length;
    this.offsets = new Float32Array(count);
    this.offsetsBefore = new Float32Array(count);
    this.restOffsets = new Float32Array(count);
    this.restNormals = new Float32Array(count);
    turnNormals(surface.rest, surface.triangles, this.restNormals);
    this.displacement = new Float32Array(count / 3);
    this.signed = new Float32Array(count / 3);
    this.speed = new Float32Array(count / 3);
    this.edgeCounts = new Uint8Array(count / 3);
    this.size = sizeOf(surface.rest);

    const geometry = new THREE.BufferGeometry();
    const changing = () => new THREE.BufferAttribute(new Float32Array(count), 3).setUsage(THREE.DynamicDrawUsage);
    geometry.setAttribute("position", changing());
    geometry.setAttribute("normal", changing());
    geometry.setAttribute("color", changing());
    geometry.setAttribute("relief", new THREE.BufferAttribute(new Float32Array(count / 3), 1).setUsage(THREE.DynamicDrawUsage));
    geometry.setIndex(new THREE.BufferAttribute(surface.triangles, 1));
    this.mesh = new THREE.Mesh(geometry, surfaceMaterial());
    this.mesh.name = surface.head.name;

    const wires = new THREE.BufferGeometry();
    wires.setAttribute("position", geometry.getAttribute("position"));
    wires.setAttribute("color", geometry.getAttribute("color"));
    wires.setIndex(new THREE.BufferAttribute(surface.edges, 1));
    this.lines = new THREE.LineSegments(wires, new THREE.LineBasicMaterial({ transparent: true }));
    this.lines.name = `${surface.head.name} mesh`;

    const points = (name: string, vertices: Uint32Array, material: THREE.PointsMaterial) => {
      const some = new THREE.BufferGeometry();
      some.setAttribute("position", geometry.getAttribute("position"));
      some.setIndex(new THREE.BufferAttribute(vertices, 1));
      const made = new THREE.Points(some, material);
      made.name = `${surface.head.name} ${name}`;
      return made;
    };
    this.pins = points("pins", surface.pins, pinMaterial());
    const spacing = meanLength(surface.rest, surface.edges);
    this.dots = points("dots", new Uint32Array(surface.mostTouching), dotMaterial(spacing, this.dotRim));
    // What lies on a solid is behind it from most sides.
    const hidden = Object.assign(dotMaterial(spacing, this.dotRim), { depthTest: false, transparent: true, opacity: 0.4 });
    this.dotsBehind = new THREE.Points(this.dots.geometry, hidden);
    this.dotsBehind.frustumCulled = false;
    this.dots.add(this.dotsBehind);

    this.group.name = `surface ${surface.head.name}`;
    this.group.matrixAutoUpdate = false;
    this.group.add(this.mesh, this.lines, this.pins, this.dots);
    for (const object of [this.mesh, this.lines, this.pins, this.dots]) object.frustumCulled = false; // vertices move
  }

  /** Shows frame `index` plus `share` of the way to the next. */
  show(index: number, share: number): void {
    const { rest } = this.surface;
    this.surface.displacementsAt(index, share, this.offsets);
    const positions = this.mesh.geometry.getAttribute("position") as THREE.BufferAttribute;
    const array = positions.array as Float32Array;
    for (let k = 0; k < array.length; ++k) array[k] = rest[k] + this.offsets[k];
    positions.needsUpdate = true;
    this.group.matrix.copy(placement(this.surface, index, share));
    this.group.matrixWorldNeedsUpdate = true;
    this.mesh.geometry.boundingSphere = null;
    const touching = this.surface.touchingAt(index);
    const dotted = this.dots.geometry.index!;
    (dotted.array as Uint32Array).set(touching);
    dotted.needsUpdate = true;
    this.dots.geometry.setDrawRange(0, touching.length);
    this.turnNormals(array);
    this.measure(index, share);
  }

  /** The farthest that a vertex is displaced against the normal, below 0, and along it, over all frames. */
  farthest(frameCount: number): Ends {
    const ends = { low: 0, high: 0 };
    for (let index = 0; index < frameCount; ++index) {
      this.surface.displacementsAt(index, 0, this.offsets);
      this.measureSigned(index, 0, placement(this.surface, index, 0));
      for (const number of this.signed) {
        if (number < ends.low) ends.low = number;
        if (number > ends.high) ends.high = number;
      }
    }
    return ends;
  }

  /** Colours the vertices by a number. */
  paint(colour: Colour, { low, high }: Ends): void {
    const attribute = this.mesh.geometry.getAttribute("color") as THREE.BufferAttribute;
    const colours = attribute.array as Float32Array;
    if (colour === "plain") {
      for (let k = 0; k < colours.length; k += 3) this.plain.toArray(colours, k);
    } else {
      const numbers = { displacement: this.displacement, signed: this.signed, velocity: this.speed }[colour];
      paintNumbers(numbers, low, high, ramps[colour], colours);
    }
    attribute.needsUpdate = true;
  }

  dress(style: Style, palette: Palette): void {
    this.plain.set(palette.surface);
    this.mesh.material.colorWrite = style !== "wireframe";
    this.mesh.material.depthWrite = style !== "wireframe";
    this.lines.visible = style !== "shaded";
    this.pins.material.color.set(palette.pin);
    for (const dots of [this.dots, this.dotsBehind]) dots.material.color.set(palette.touch);
    this.dotRim.set(palette.background);
    const { material } = this.lines;
    material.vertexColors = style === "wireframe";
    material.color.set(style === "wireframe" ? 0xffffff : palette.mesh);
    material.opacity = style === "wireframe" ? 0.9 : 0.28;
    material.needsUpdate = true;
  }

  /** A vertex at the frame shown, world space. */
  vertex(index: number, out = new THREE.Vector3()): THREE.Vector3 {
    return out.fromBufferAttribute(this.mesh.geometry.getAttribute("position"), index).applyMatrix4(this.group.matrix);
  }

  /** Up to `count` of the vertices in a sphere, with their unit normals, world space, at the frame shown. */
  feet(center: THREE.Vector3, radius: number, count: number): Foot[] {
    const within: number[] = [];
    const place = new THREE.Vector3();
    for (let k = 0; k < this.displacement.length; ++k) {
      if (this.vertex(k, place).distanceToSquared(center) < radius * radius) within.push(k);
    }
    const normals = this.mesh.geometry.getAttribute("normal");
    const toWorld = new THREE.Matrix3().getNormalMatrix(this.group.matrix);
    const shown = Math.min(count, within.length);
    return Array.from({ length: shown }, (_, n) => {
      const vertex = within[Math.floor(((n + 0.5) * within.length) / shown)];
      return { place: this.vertex(vertex), normal: new THREE.Vector3().fromBufferAttribute(normals, vertex).applyMatrix3(toWorld).normalize() };
    });
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.lines.geometry.dispose();
    this.lines.material.dispose();
    this.pins.geometry.dispose();
    this.pins.material.dispose();
    this.dots.geometry.dispose();
    this.dots.material.dispose();
    this.dotsBehind.material.dispose();
  }

  private turnNormals(p: Float32Array): void {
    const attribute = this.mesh.geometry.getAttribute("normal") as THREE.BufferAttribute;
    const n = attribute.array as Float32Array;
    turnNormals(p, this.surface.triangles, n);
    attribute.needsUpdate = true;
    const relief = this.mesh.geometry.getAttribute("relief") as THREE.BufferAttribute;
    bends(p, n, this.surface.edges, this.size, relief.array as Float32Array, this.edgeCounts);
    relief.needsUpdate = true;
  }

  // Displacement relative to the rest position under the present transform; speed as the mean since
  // the frame before.
  private measure(index: number, share: number): void {
    const m = this.group.matrix.elements;
    const isFirst = index === 0 && share === 0;
    const before = share > 0 ? index : Math.max(index - 1, 0);
    this.surface.displacementsAt(before, 0, this.offsetsBefore);
    this.measureSigned(index, share, this.group.matrix);
    const last = placement(this.surface, before, 0).elements;
    const time = (share > 0 ? share : 1) / this.fps;
    const { rest } = this.surface;
    for (let k = 0; k < rest.length; k += 3) {
      const [dx, dy, dz] = [this.offsets[k], this.offsets[k + 1], this.offsets[k + 2]];
      const [bx, by, bz] = [this.offsetsBefore[k], this.offsetsBefore[k + 1], this.offsetsBefore[k + 2]];
      const [rx, ry, rz] = [this.restOffsets[k], this.restOffsets[k + 1], this.restOffsets[k + 2]];
      let moved = 0, gone = 0;
      for (let row = 0; row < 3; ++row) {
        const offset = m[row] * dx + m[row + 4] * dy + m[row + 8] * dz;
        moved += (offset - (m[row] * rx + m[row + 4] * ry + m[row + 8] * rz)) ** 2;
        const place = offset + m[row] * rest[k] + m[row + 4] * rest[k + 1] + m[row + 8] * rest[k + 2] + m[row + 12];
        const was = last[row] * (rest[k] + bx) + last[row + 4] * (rest[k + 1] + by) + last[row + 8] * (rest[k + 2] + bz) + last[row + 12];
        gone += (place - was) ** 2;
      }
      this.displacement[k / 3] = Math.sqrt(moved);
      this.speed[k / 3] = isFirst ? 0 : Math.sqrt(gone) / time;
    }
  }

  // Of `offsets`. With M from object space to the world and N its inverse transposed, the normal n
  // becomes N n / |N n|, on the same side of the surface if M is a reflection too, and with it
  // (M d) · N n = d · n.
  private measureSigned(index: number, share: number, placed: THREE.Matrix4): void {
    const { rest, triangles, head } = this.surface;
    const { offsets, restOffsets, restNormals: n } = this;
    this.surface.restDisplacementsAt(index, share, restOffsets);
    if (head.restMotion) turnNormals(rest.map((number, k) => number + restOffsets[k]), triangles, n);
    const m = new THREE.Matrix3().getNormalMatrix(placed).elements;
    for (let k = 0; k < n.length; k += 3) {
      const [x, y, z] = [n[k], n[k + 1], n[k + 2]];
      const along = (offsets[k] - restOffsets[k]) * x + (offsets[k + 1] - restOffsets[k + 1]) * y + (offsets[k + 2] - restOffsets[k + 2]) * z;
      const length = Math.hypot(m[0] * x + m[3] * y + m[6] * z, m[1] * x + m[4] * y + m[7] * z, m[2] * x + m[5] * y + m[8] * z);
      this.signed[k / 3] = length > 0 ? along / length : 0;
    }
  }
}
