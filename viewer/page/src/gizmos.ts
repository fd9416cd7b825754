// The thesis's feedback for a force (5.2.2): three circles for each of its two volumes, and its
// vector from the centre. The deformation volume is dark or blue, the force volume light or amber
// (fig. 12).

import * as THREE from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";

import { at, between, vectorBetween, type Force, type Track, type Vector } from "./bake";
import type { Label } from "./labels";
import { Segments, SegmentsGeometry } from "./segments";
import type { Foot } from "./surface_view";
import type { Palette } from "./theme";

const segments = 64;

function circlePoints(turn: (a: number) => Vector): number[] {
  const points: number[] = [];
  for (let k = 0; k < segments; ++k) {
    for (const end of [k, k + 1]) points.push(...turn((2 * Math.PI * end) / segments));
  }
  return points;
}

const sphere = new SegmentsGeometry(true).setEnds([
  ...circlePoints((a) => [0, Math.cos(a), Math.sin(a)]),
  ...circlePoints((a) => [Math.cos(a), 0, Math.sin(a)]),
  ...circlePoints((a) => [Math.cos(a), Math.sin(a), 0]),
]);
const ring = new SegmentsGeometry(true).setEnds(circlePoints((a) => [Math.cos(a), 0, Math.sin(a)]));
const segment = new SegmentsGeometry().setEnds([0, 0, 0, 0, 1, 0]);
const head = new THREE.ConeGeometry(0.5, 1, 20).translate(0, -0.5, 0);
const dot = new THREE.SphereGeometry(1, 16, 10);
const up = new THREE.Vector3(0, 1, 0);

/** As a share of the size of the scene, however large the radii. */
const longestVector = 0.3;

const toVector = (v: Vector) => new THREE.Vector3(...v);

/** The look of a part, and its fainter look where other objects cover it. */
class Ink {
  readonly seen: LineMaterial;
  readonly covered: LineMaterial;

  constructor(
    linewidth: number,
    private readonly opacity: number,
  ) {
    const common = { linewidth, transparent: true, depthWrite: false };
    this.seen = new LineMaterial(common);
    this.covered = new LineMaterial({ ...common, depthFunc: THREE.GreaterDepth });
    this.strength = 1;
  }

  circles(geometry: SegmentsGeometry): Segments {
    const circles = this.line(geometry);
    circles.add(new Segments(geometry, this.covered));
    return circles;
  }

  line(geometry: SegmentsGeometry): Segments {
    return new Segments(geometry, this.seen);
  }

  set strength(share: number) {
    this.seen.opacity = share * this.opacity;
    this.covered.opacity = 0.22 * share * this.opacity;
    this.covered.visible = share === 1;
  }

  dress(colour: string, _palette: Palette): void {
    for (const material of [this.seen, this.covered]) material.color.set(colour);
  }

  dispose(): void {
    for (const material of [this.seen, this.covered]) material.dispose();
  }
}

/** Faint and behind everything: the region of a group is large, and must not hide its content. */
class BackgroundInk extends Ink {
  constructor(
    linewidth: number,
    private readonly share: number,
  ) {
    super(linewidth, 1);
    // Drawn before all opaque objects; the colour is mixed instead of blended.
    this.seen.transparent = this.seen.depthTest = false;
  }

  override circles(geometry: SegmentsGeometry): Segments {
    const circles = this.line(geometry);
    circles.renderOrder = -1;
    return circles;
  }

  override dress(colour: string, palette: Palette): void {
    super.dress(colour, palette);
    this.seen.color.lerp(new THREE.Color(palette.background), 1 - this.share);
  }
}

interface Inks {
  deformation: Ink;
  force: Ink;
  arrow: Ink;
  faint: Ink;
}

/** A vector with a head; the shaft is a line. */
class Arrow {
  readonly group = new THREE.Group();
  readonly from = new THREE.Vector3();
  readonly along = new THREE.Vector3();
  private readonly shaft: Segments;
  private readonly tip: THREE.Mesh;

  constructor(ink: Ink, faces: THREE.Material) {
    this.shaft = ink.line(segment);
    this.tip = new THREE.Mesh(head, faces);
    this.group.add(this.shaft, this.tip);
  }

  /** Points from `from` along `along`, with its length; hidden if that is 0. */
  point(from: THREE.Vector3, along: THREE.Vector3, size: number): void {
    const length = along.length();
    this.group.visible = length > 0;
    this.from.copy(from);
    this.along.copy(along);
    if (length === 0) return;
    const turn = new THREE.Quaternion().setFromUnitVectors(up, along.clone().divideScalar(length));
    const headLength = Math.min(size, 0.45 * length);
    this.shaft.position.copy(from);
    this.shaft.quaternion.copy(turn);
    this.shaft.scale.set(1, length - headLength, 1);
    this.tip.position.copy(from).add(along);
    this.tip.quaternion.copy(turn);
    this.tip.scale.set(0.7 * headLength, headLength, 0.7 * headLength);
  }
}

/** Where arrows along the normals stand, up to `count`, on the surfaces that a force targets. */
export type FeetIn = (force: Force, center: THREE.Vector3, radius: number, count: number) => Foot[];

/** What is drawn of a force at the frame shown, world space. */
export interface Drawn {
  name: string;
  isShown: boolean;
  center: THREE.Vector3;
  /** Length of the course and of the longest vector. */
  length: number;
  /** The largest magnitude at any frame, which has a vector of that length. */
  strongest: number;
  /** From where vectors start, and along them; of a magnitude of 0 none. */
  vectors: { from: THREE.Vector3; along: THREE.Vector3 }[];
  circles: Segments[];
  /** Of those behind everything. */
  isVast: (circles: Segments) => boolean;
}

/** One force, or a group. */
class Gizmo {
  readonly group = new THREE.Group();
  private readonly inks: Inks;
  private readonly solid = new THREE.MeshBasicMaterial({ transparent: true });
  private readonly deformation: Segments[] = [];
  private readonly force: Segments[] = [];
  private readonly middle: THREE.Mesh;
  private readonly course: Segments;
  private readonly arrows: Arrow[] = [];
  private readonly strongest: number;
  private length = 0;

  constructor(
    private readonly parameters: Force,
    private readonly reach: number,
  ) {
    // Groups, and volumes with a radius above half of the scene's size, are drawn in the
    // background.
    const isVast = (radius: Track<number> | undefined) => parameters.kind === "group" || Math.max(0, ...(radius ?? [])) > 0.5 * reach;
    this.inks = {
      deformation: isVast(parameters.deformationRadius) ? new BackgroundInk(1, 0.45) : new Ink(1.6, 0.9),
      force: isVast(parameters.forceRadius) ? new BackgroundInk(1, 0.45) : new Ink(2, 1),
      arrow: new Ink(2, 1),
      faint: new Ink(1, 0.5),
    };
    this.group.name = `force ${parameters.name}`;
    this.strongest = Math.max(...(parameters.magnitude ?? [0]).map(Math.abs));
    const { kind } = parameters;
    // The volume of a line is a capsule, that of a vortex a tube: circles at both ends, with lines
    // between.
    const volumes = kind === "line" ? 2 : 1;
    const shape = kind === "vortex" ? ring : sphere;
    for (let k = 0; k < (kind === "vortex" ? 3 : volumes); ++k) {
      this.deformation.push(this.inks.deformation.circles(shape));
      this.force.push(this.inks.force.circles(shape));
    }
    for (const each of this.deformation) each.name = `${parameters.name} deformationRadius`;
    for (const each of this.force) each.name = `${parameters.name} forceRadius`;
    this.middle = new THREE.Mesh(dot, this.solid);
    this.middle.name = `${parameters.name} center`;
    this.course = this.inks.faint.line(segment);
    const arrowCount: Record<string, number> = { point: 1, line: 4, radial: 6, uniform: 1, vortex: 4, inertia: 1, pressure: 14 };
    for (let k = 0; k < (arrowCount[kind] ?? 0); ++k) {
      this.arrows.push(new Arrow(this.inks.arrow, this.solid));
      this.arrows[k].group.name = `${parameters.name} vector`;
    }
    this.group.add(...this.deformation, ...this.force, this.middle, this.course, ...this.arrows.map((each) => each.group));
  }

  colour(palette: Palette): void {
    this.inks.deformation.dress(palette.deformation, palette);
    this.inks.force.dress(palette.force, palette);
    this.inks.arrow.dress(palette.force, palette);
    this.inks.faint.dress(palette.force, palette);
    this.solid.color.set(this.parameters.kind === "group" ? palette.deformation : palette.force);
  }

  get name(): string {
    return this.parameters.name;
  }

  get drawn(): Drawn {
    const { strongest, length } = this;
    return {
      name: this.name,
      isShown: this.group.visible,
      center: this.middle.position.clone(),
      length,
      strongest,
      vectors: this.arrows.filter(({ group }) => group.visible).map(({ from, along }) => ({ from, along })),
      circles: [...this.deformation, ...this.force].filter((each) => each.visible),
      isVast: (circles) => circles.renderOrder < 0,
    };
  }

  /** The label beside its middle; null: the force is not shown. */
  label(index: number): Label | null {
    if (!this.group.visible) return null;
    const { name, kind, magnitude } = this.parameters;
    const isGroup = kind === "group";
    const isFaint = !isGroup && (magnitude === undefined || at(magnitude, index) === 0);
    // First the forces that push now. Then by the largest magnitude at any time, so that names do
    // not flicker.
    const rank = (isFaint ? 0 : 2) + (isGroup ? 0 : this.strongest / (1 + this.strongest));
    return { text: name, place: this.middle.position.clone(), rank, isFaint, isGroup };
  }

  /** `middle`: the position for forces that act everywhere; `push`: the inertial force there; `feetIn`: of surfaces that it targets. */
  show(index: number, share: number, isShown: boolean, middle: THREE.Vector3, push: Vector | undefined, feetIn: FeetIn): void {
    const force = this.parameters;
    this.group.visible = isShown && at(force.enabled, index);
    const magnitude = force.magnitude ? between(force.magnitude, index, share) : 0;
    // A force without a magnitude still selects its region, but stays in the background.
    const strength = magnitude === 0 && force.kind !== "group" ? 0.3 : 1;
    for (const ink of Object.values(this.inks) as Ink[]) ink.strength = strength;
    this.solid.opacity = strength;
    const isEverywhere = force.kind === "uniform" || force.kind === "inertia" || force.kind === "custom";
    const deformationRadius = !isEverywhere && force.deformationRadius ? between(force.deformationRadius, index, share) : 0;
    const forceRadius = !isEverywhere && force.forceRadius ? between(force.forceRadius, index, share) : 0;
    const size = Math.min(deformationRadius || forceRadius || Infinity, longestVector * this.reach);
    this.length = 1.15 * size;
    const length = this.strongest > 0 ? (1.15 * size * magnitude) / this.strongest : 0;
    const vectorOf = (track: Vector[] | undefined) => (track ? toVector(vectorBetween(track, index, share)) : new THREE.Vector3());

    const ends = force.from && force.to ? [vectorOf(force.from), vectorOf(force.to)] : [force.center ? vectorOf(force.center) : middle.clone()];
    const center = ends.length === 2 ? ends[0].clone().lerp(ends[1], 0.5) : ends[0];
    this.middle.position.copy(center);
    if (!this.group.visible) return;
    this.placeVolumes(ends, deformationRadius, forceRadius, force.axis && vectorOf(force.axis));
    this.middle.scale.setScalar(0.035 * size);

    const headSize = 0.16 * size;
    const direction = force.kind === "inertia" ? toVector(push ?? [0, 0, 0]) : vectorOf(force.direction);
    if (direction.lengthSq() > 0) direction.normalize();
    this.course.visible = false;
    if (force.kind === "point" || force.kind === "uniform" || force.kind === "inertia" || force.direction) {
      this.showCourse(center, direction, this.length);
      this.arrows[0].point(center, direction.multiplyScalar(length), headSize);
      for (const arrow of this.arrows.slice(1)) arrow.group.visible = false;
    } else if (force.kind === "radial") {
      const ways: Vector[] = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
      this.burst(center, ways.map(toVector), 0.25 * size, 0.62 * length, 0.7 * headSize);
    } else if (force.kind === "pressure") {
      const feet = feetIn(force, center, forceRadius, this.arrows.length);
      this.arrows.forEach((arrow, k) => {
        const along = k < feet.length ? feet[k].normal.multiplyScalar(0.4 * length) : new THREE.Vector3();
        // Of one that sucks in, the tip is on the surface.
        arrow.point(k < feet.length && length < 0 ? feet[k].place.sub(along) : feet[k]?.place ?? center, along, 0.5 * headSize);
      });
    } else if (force.kind === "line") {
      const [side, over] = across(ends[1].clone().sub(ends[0]));
      this.burst(center, [side, side.clone().negate(), over, over.clone().negate()], 0.25 * size, 0.62 * length, 0.7 * headSize);
    } else if (force.kind === "vortex") {
      this.showVortex(center, vectorOf(force.axis), between(force.pull ?? [0], index, share), forceRadius || size, length, 0.8 * headSize);
    }
  }

  dispose(): void {
    for (const ink of Object.values(this.inks) as Ink[]) ink.dispose();
    this.solid.dispose();
  }

  private placeVolumes(ends: THREE.Vector3[], deformationRadius: number, forceRadius: number, axis?: THREE.Vector3): void {
    const place = (each: Segments, k: number, radius: number) => {
      each.visible = radius > 0;
      each.position.copy(ends[Math.min(k, ends.length - 1)]);
      each.scale.setScalar(Math.max(radius, 1e-30));
      if (axis && axis.lengthSq() > 0) {
        // Three rings around the axis.
        const way = axis.clone().normalize();
        each.quaternion.setFromUnitVectors(up, way);
        each.position.addScaledVector(way, (k - 1) * 0.5 * deformationRadius);
      }
    };
    this.deformation.forEach((each, k) => place(each, k, deformationRadius));
    this.force.forEach((each, k) => place(each, k, forceRadius));
    if (ends.length !== 2) return;
    const along = ends[1].clone().sub(ends[0]);
    const length = along.length();
    if (length === 0) return;
    for (const each of [...this.deformation, ...this.force]) each.quaternion.setFromUnitVectors(up, along.clone().divideScalar(length));
  }

  // The direction of the force, whatever its magnitude.
  private showCourse(from: THREE.Vector3, direction: THREE.Vector3, length: number): void {
    this.course.visible = direction.lengthSq() > 0;
    if (!this.course.visible) return;
    this.course.position.copy(from);
    this.course.quaternion.setFromUnitVectors(up, direction);
    this.course.scale.set(1, length, 1);
  }

  // Arrows away from the middle, or towards it if the magnitude is negative.
  private burst(center: THREE.Vector3, ways: THREE.Vector3[], gap: number, length: number, headSize: number): void {
    ways.forEach((way, k) => {
      const from = center.clone().addScaledVector(way, length < 0 ? gap - length : gap);
      this.arrows[k].point(from, way.clone().multiplyScalar(length), headSize);
    });
  }

  // Arrows along the ring, turned inwards by the pull.
  private showVortex(center: THREE.Vector3, axis: THREE.Vector3, pull: number, radius: number, length: number, headSize: number): void {
    if (axis.lengthSq() === 0) {
      for (const arrow of this.arrows) arrow.group.visible = false;
      return;
    }
    axis.normalize();
    this.course.visible = true;
    this.course.position.copy(center).addScaledVector(axis, -radius);
    this.course.quaternion.setFromUnitVectors(up, axis);
    this.course.scale.set(1, 2 * radius, 1);
    const [side, over] = across(axis);
    [side, over, side.clone().negate(), over.clone().negate()].forEach((way, k) => {
      const from = center.clone().addScaledVector(way, radius);
      const turning = axis.clone().cross(way).addScaledVector(way, -pull).normalize();
      this.arrows[k].point(from, turning.multiplyScalar(0.8 * length), headSize);
    });
  }
}

/** Two unit vectors perpendicular to `along` and to each other. */
function across(along: THREE.Vector3): [THREE.Vector3, THREE.Vector3] {
  const way = along.lengthSq() > 0 ? along.clone().normalize() : up.clone();
  const helper = Math.abs(way.y) < 0.9 ? up : new THREE.Vector3(1, 0, 0);
  const side = helper.clone().cross(way).normalize();
  return [side, way.clone().cross(side)];
}

export class Gizmos {
  readonly group = new THREE.Group();
  private readonly gizmos: Gizmo[];

  /** `reach` is the size of the scene. */
  constructor(
    readonly forces: Force[],
    reach: number,
    private readonly middle: THREE.Vector3,
  ) {
    this.group.name = "gizmos";
    this.gizmos = forces.map((force) => new Gizmo(force, reach));
    for (const gizmo of this.gizmos) this.group.add(gizmo.group);
  }

  show(index: number, share: number, isShown: boolean[], pushes: Map<number, Vector>, feetIn: FeetIn): void {
    this.gizmos.forEach((gizmo, k) => gizmo.show(index, share, isShown[k], this.middle, pushes.get(k), feetIn));
  }

  get drawn(): Drawn[] {
    return this.gizmos.map((gizmo) => gizmo.drawn);
  }

  drawnOf(name: string): Drawn | undefined {
    return this.gizmos.find((gizmo) => gizmo.name === name)?.drawn;
  }

  /** The labels of the forces that are shown. */
  labels(index: number): Label[] {
    return this.gizmos.map((gizmo) => gizmo.label(index)).filter((label) => label !== null);
  }

  colour(palette: Palette): void {
    for (const gizmo of this.gizmos) gizmo.colour(palette);
  }

  dispose(): void {
    for (const gizmo of this.gizmos) gizmo.dispose();
  }
}
