// What of an object can be taken hold of in the view: its places, radii, direction and magnitude, as its attributes say.

import * as THREE from "three";

import { at, matrixBetween, type Force } from "../bake";
import { axes, type Axis } from "../stage";
import { rounded, stepOf } from "./arithmetic";
import type { Editor } from "./editor";
import type { AttributeFacts, Operation, SceneObject } from "./session";
import { between, type Sight, type Spot } from "./sight";

/** Where a handle is pulled to. */
export interface Pull {
  spot: Spot;
  /** Only along this one. */
  axis: Axis | null;
  snap: "vertex" | "surface" | null;
}

export type HandleKind = "move" | "radius" | "direction" | "magnitude";

/** A value, and where its handle is then. */
interface Held {
  text: string;
  place: THREE.Vector3;
}

/** The texts of numbers, those of the numbers before where they differ by less than half a step. */
function textsOf(numbers: number[], steps: number[], before: { texts: string[]; numbers: number[] }): string[] {
  return numbers.map((number, k) => (Math.abs(number - before.numbers[k]) < steps[k] / 2 ? before.texts[k] : rounded(number, steps[k])));
}

export abstract class Handle {
  abstract readonly kind: HandleKind;
  private held: Held | null = null;
  private isLetGo = false;
  private textsBefore: string[] = [];

  constructor(
    protected readonly editor: Editor,
    protected readonly sight: Sight,
    readonly object: string,
    protected readonly attribute: string,
    readonly label: string,
  ) {}

  get facts(): AttributeFacts | undefined {
    return this.editor.session.attribute(this.object, this.attribute);
  }

  /** The value as the file has it. */
  get text(): string {
    return this.held?.text ?? (this.facts ? this.editor.textOf(this.facts) : "");
  }

  /** Empty: it cannot be said as numbers. */
  get numbers(): number[] {
    const numbers = this.text.trim().split(/\s+/).map(Number);
    return this.text.trim() === "" || numbers.some((number) => !Number.isFinite(number)) ? [] : numbers;
  }

  /** Why it cannot be pulled; empty: it can. */
  get obstacle(): string {
    const object = this.editor.session.object(this.object);
    if (!object) return `There is no ${this.object}`;
    const file = object.file ?? this.facts?.file;
    if (file !== undefined) return `${this.object} stands in ${file}, and cannot be changed here`;
    return this.numbers.length === 0 ? `${this.object}.${this.attribute} is moved by a path, and cannot be dragged` : "";
  }

  /** Where it is; null: it cannot be said yet. */
  get place(): THREE.Vector3 | null {
    if (this.held && this.isLetGo && this.isSettled) this.held = null;
    return this.held?.place.clone() ?? this.ownPlace();
  }

  /** The way on the screen, a unit, along which it gives way to others. */
  abstract get outwards(): Spot;

  /** Whether the arrow keys go along `outwards`, and not along the screen. */
  get isLine(): boolean {
    return this.kind === "radius" || this.kind === "magnitude";
  }

  /** Takes hold of it: all that follows is relative to how it is now, also if the page does not show yet what came of the last time. */
  begin(): void {
    const { place, text } = this;
    this.isLetGo = false;
    this.textsBefore = text.trim().split(/\s+/);
    if (place) this.start(place, this.numbers, this.textsBefore);
    this.held = place && { text, place };
  }

  /** Whether this gives it another value than it had before. */
  pull(pull: Pull): boolean {
    const before = this.text;
    const held = this.held && this.pulled(pull);
    if (held) this.held = held;
    return this.text !== before;
  }

  /** Lets go of it; `isTaken`: the document has its value. */
  letGo(isTaken: boolean): void {
    this.isLetGo = true;
    if (!isTaken) this.held = null;
  }

  /** What gives it its value: of a constant vector, the components that change. */
  operations(): Operation[] {
    const { facts, text, editor } = this;
    if (!facts) return [];
    const whole = editor.toSet(facts, text);
    const changed = text.split(" ").flatMap((value, k) => (value === this.textsBefore[k] ? [] : [{ op: "set", path: `${facts.path}.${"xyz"[k]}`, value }]));
    return whole.op !== "set" || changed.length === 0 || changed.length === this.textsBefore.length ? [whole] : changed;
  }

  /** Where the value has it. */
  protected abstract ownPlace(): THREE.Vector3 | null;
  protected abstract start(place: THREE.Vector3, numbers: number[], texts: string[]): void;
  protected abstract pulled(pull: Pull): Held | null;

  /** Frames since the first one that is drawn. */
  protected get index(): number {
    return this.editor.playback.frame - (this.editor.scene.head?.first ?? 0);
  }

  /** The force as the command has it in the world. */
  protected get force(): Force | undefined {
    return this.editor.scene.head?.forces.find(({ name }) => name === this.object);
  }

  /** The surface in whose space the object's places are; empty: the world. */
  protected get carrier(): string {
    return this.editor.session.attribute(this.object, "follow")?.value ?? "";
  }

  /** From the object's space to the world. */
  protected get toWorld(): THREE.Matrix3 {
    const surface = this.carrier === "" ? undefined : this.editor.scene.head?.surfaces.find(({ name }) => name === this.carrier);
    if (!surface) return new THREE.Matrix3();
    return new THREE.Matrix3().setFromMatrix4(matrixBetween(surface.transforms, this.index, 0, new THREE.Matrix4()));
  }

  /** A vector of the object in the world; of one that rides on a surface as the command carried it there. */
  protected inWorld(): THREE.Vector3 | null {
    const { numbers } = this;
    if (this.carrier === "" && numbers.length === 3) return new THREE.Vector3().fromArray(numbers);
    const track = this.force?.[this.attribute as "center" | "from" | "to" | "direction" | "axis"];
    return track ? new THREE.Vector3(...at(track, this.index)) : null;
  }

  // Whether the page shows what came of it.
  protected get isSettled(): boolean {
    const { session, scene } = this.editor;
    if (session.failures.length > 0 || !session.isAlive) return true;
    const isRead = session.facts.revision === session.revision;
    const needsScene = this.facts?.animated || this.carrier !== "" || this.isDrawn;
    return isRead && (!needsScene || (scene.head?.revision === session.revision && (!this.isDrawn || scene.shown.isExact)));
  }

  /** Whether its place is that of what is drawn. */
  protected get isDrawn(): boolean {
    return false;
  }
}

/** A place. */
class PlaceHandle extends Handle {
  readonly kind = "move";
  private from = { place: new THREE.Vector3(), numbers: [] as number[], texts: [] as string[], toObject: new THREE.Matrix3(), toWorld: new THREE.Matrix3() };
  private readonly middles = new WeakMap<THREE.BufferAttribute | THREE.InterleavedBufferAttribute, { version: number; middle: THREE.Vector3 }>();

  override get outwards(): Spot {
    return { x: 0.6, y: 0.8 };
  }

  protected override get isDrawn(): boolean {
    return this.attribute === "translate";
  }

  protected ownPlace(): THREE.Vector3 | null {
    return this.isDrawn ? this.middle() : this.inWorld();
  }

  protected start(place: THREE.Vector3, numbers: number[], texts: string[]): void {
    const { toWorld } = this;
    this.from = { place, numbers, texts, toWorld, toObject: toWorld.clone().invert() };
  }

  protected pulled(pull: Pull): Held | null {
    const { place, numbers, texts, toObject, toWorld } = this.from;
    const target = this.target(pull);
    if (!target) return null;
    const pixel = this.sight.pixelAt(place);
    const rows = [0, 1, 2].map((row) => Math.hypot(toObject.elements[row], toObject.elements[row + 3], toObject.elements[row + 6]));
    const moved = target.sub(place).applyMatrix3(toObject).toArray();
    const made = textsOf(moved.map((number, k) => numbers[k] + number), rows.map((row) => stepOf(pixel * row)), { texts, numbers });
    const offset = new THREE.Vector3().fromArray(made.map((text, k) => Number(text) - numbers[k]));
    return { text: made.join(" "), place: offset.applyMatrix3(toWorld).add(place) };
  }

  private target({ spot, axis, snap }: Pull): THREE.Vector3 | null {
    const { place } = this.from;
    const there = snap === "vertex" ? this.sight.atVertex(spot, this.object) : snap === "surface" ? this.sight.onSurface(spot, this.object) : null;
    if (snap && !there) return null;
    if (!axis) return there ?? this.sight.inPlane(spot, place);
    const times = there ? there.sub(place).dot(axes[axis]) : this.sight.along(spot, place, axes[axis]);
    return times === null ? null : place.clone().addScaledVector(axes[axis], times);
  }

  // Of the box around what is drawn, or where a plane is.
  private middle(): THREE.Vector3 | null {
    const { viewer } = this.editor;
    const view = viewer.views.find(({ surface }) => surface.head.name === this.object);
    const collider = viewer.colliders.find(({ collider: { head } }) => head.name === this.object);
    if (collider && collider.collider.points.length === 0) return new THREE.Vector3().setFromMatrixPosition(collider.group.matrix);
    const drawn = view ?? collider;
    if (!drawn) return this.inWorld();
    const positions = drawn.mesh.geometry.getAttribute("position");
    const version = "version" in positions ? positions.version : 0;
    let known = this.middles.get(positions);
    if (known?.version !== version) {
      const middle = new THREE.Box3().setFromBufferAttribute(positions as THREE.BufferAttribute).getCenter(new THREE.Vector3());
      this.middles.set(positions, (known = { version, middle }));
    }
    return known.middle.clone().applyMatrix4(drawn.group.matrix);
  }
}

/** A radius about places of the object. */
class RadiusHandle extends Handle {
  readonly kind = "radius";
  private center = new THREE.Vector3();
  private step = 0;
  private before = { texts: [] as string[], numbers: [] as number[] };

  constructor(
    editor: Editor,
    sight: Sight,
    object: string,
    attribute: string,
    label: string,
    private readonly around: PlaceHandle,
    /** On its circle, from the right upwards: the handles of a force are apart from each other. */
    private angle: number,
  ) {
    super(editor, sight, object, attribute, label);
  }

  override get outwards(): Spot {
    return { x: Math.cos(this.angle), y: -Math.sin(this.angle) };
  }

  protected ownPlace(): THREE.Vector3 | null {
    const [radius] = this.numbers;
    const center = this.around.place;
    if (!center || radius === undefined) return null;
    const way = this.way();
    return center.addScaledVector(way, radius * this.scaleAlong(way));
  }

  protected start(place: THREE.Vector3, numbers: number[], texts: string[]): void {
    this.center = this.around.place ?? place;
    this.step = stepOf(this.sight.pixelAt(this.center) / this.scaleAlong(this.way()));
    this.before = { texts, numbers };
  }

  protected pulled({ spot }: Pull): Held | null {
    const there = this.sight.inPlane(spot, this.center);
    if (!there) return null;
    const away = there.sub(this.center);
    if (away.length() > 0) this.angle = Math.atan2(away.dot(this.sight.up), away.dot(this.sight.right));
    const way = this.way();
    const scale = this.scaleAlong(way);
    const [text] = textsOf([away.length() / scale], [this.step], this.before);
    return { text, place: this.center.clone().addScaledVector(way, Number(text) * scale) };
  }

  private way(): THREE.Vector3 {
    return this.sight.right.multiplyScalar(Math.cos(this.angle)).addScaledVector(this.sight.up, Math.sin(this.angle));
  }

  // Radii of forces are lengths of the world, those of a solid are scaled with it.
  private scaleAlong(way: THREE.Vector3): number {
    const collider = this.editor.scene.head?.colliders?.find(({ name }) => name === this.object);
    if (!collider) return 1;
    const toObject = new THREE.Matrix3().setFromMatrix4(matrixBetween(collider.transforms, this.index, 0, new THREE.Matrix4())).invert();
    return 1 / Math.max(way.clone().applyMatrix3(toObject).length(), 1e-12);
  }
}

/** Where a force acts from: the middle of its places, or of what is drawn of it. */
function middleOf(editor: Editor, object: string, places: PlaceHandle[]): THREE.Vector3 | null {
  const known = places.map(({ place }) => place).filter((place) => place !== null);
  if (known.length > 0) return known.reduce((sum, place) => sum.add(place), new THREE.Vector3()).divideScalar(known.length);
  return editor.viewer.drawnOf(object)?.center ?? null;
}

/** On the screen, how far an arrow must reach for that one can pull along it. [px] */
const leastArrow = 24;

/** A unit from one place to another as they are seen. */
function wayBetween(sight: Sight, from: THREE.Vector3, to: THREE.Vector3): Spot {
  const [a, b] = [sight.seen(from), sight.seen(to)];
  const length = a && b ? Math.hypot(b.x - a.x, b.y - a.y) : 0;
  return a && b && length > 1 ? { x: (b.x - a.x) / length, y: (b.y - a.y) / length } : { x: Math.SQRT1_2, y: -Math.SQRT1_2 };
}

/** A direction, at the end of an arrow about the middle of a force. */
class DirectionHandle extends Handle {
  readonly kind = "direction";
  private from = { tip: new THREE.Vector3(), sphere: new THREE.Sphere(), numbers: [] as number[], texts: [] as string[], length: 1, toObject: new THREE.Matrix3(), toWorld: new THREE.Matrix3() };
  private isFar = false;

  constructor(
    editor: Editor,
    sight: Sight,
    object: string,
    attribute: string,
    label: string,
    private readonly places: PlaceHandle[],
  ) {
    super(editor, sight, object, attribute, label);
  }

  /** Whether the force pushes along it. */
  get isPush(): boolean {
    return this.attribute === "direction";
  }

  override get outwards(): Spot {
    const [center, tip] = [this.center, this.place];
    return center && tip ? wayBetween(this.sight, center, tip) : { x: 0, y: -1 };
  }

  protected ownPlace(): THREE.Vector3 | null {
    const { center } = this;
    const way = this.inWorld();
    if (!center || !way) return null;
    if (way.lengthSq() === 0) way.set(0, 1, 0);
    return center.addScaledVector(way.normalize(), this.reach);
  }

  protected start(tip: THREE.Vector3, numbers: number[], texts: string[]): void {
    const { toWorld } = this;
    const center = this.center ?? tip;
    this.from = { tip, sphere: new THREE.Sphere(center, center.distanceTo(tip) || 1), numbers, texts, length: Math.hypot(...numbers) || 1, toWorld, toObject: toWorld.clone().invert() };
    this.isFar = this.sight.isFartherThan(tip, center);
  }

  protected pulled(pull: Pull): Held | null {
    const { sphere: { center, radius }, numbers, texts, length, toObject, toWorld } = this.from;
    const target = this.target(pull);
    if (!target) return null;
    const step = stepOf((this.sight.pixelAt(center) / radius) * length);
    const made = textsOf(target.applyMatrix3(toObject).toArray(), [step, step, step], { texts, numbers });
    const way = new THREE.Vector3().fromArray(made.map(Number)).applyMatrix3(toWorld);
    if (way.lengthSq() === 0) return null;
    return { text: made.join(" "), place: way.setLength(radius).add(center) };
  }

  // In the world, such that the vector in the object's space keeps its length, but for a move along an axis.
  private target({ spot, axis, snap }: Pull): THREE.Vector3 | null {
    const { tip, sphere, numbers, length, toObject, toWorld } = this.from;
    const keptLength = (way: THREE.Vector3) => way.multiplyScalar(length / way.clone().applyMatrix3(toObject).length());
    const there = snap === "vertex" ? this.sight.atVertex(spot, "") : snap === "surface" ? this.sight.onSurface(spot, "") : null;
    if (snap) return there && there.distanceTo(sphere.center) > 0 ? keptLength(there.sub(sphere.center)) : null;
    if (axis) {
      const times = this.sight.along(spot, tip, axes[axis]);
      return times === null ? null : new THREE.Vector3().fromArray(numbers).applyMatrix3(toWorld).addScaledVector(axes[axis], (times * length) / sphere.radius);
    }
    const { place, isBeside } = this.sight.onSphere(spot, sphere, this.isFar);
    // Over the edge one comes to the near side.
    if (isBeside) this.isFar = false;
    return keptLength(place.sub(sphere.center));
  }

  private get center(): THREE.Vector3 | null {
    return middleOf(this.editor, this.object, this.places);
  }

  private get reach(): number {
    return this.editor.viewer.drawnOf(this.object)?.length || 0.1 * this.editor.viewer.reach;
  }
}

/** A vector and where it starts. */
interface Course {
  start: THREE.Vector3;
  along: THREE.Vector3;
}

/** A strength, at the tip of a vector that is drawn. */
class MagnitudeHandle extends Handle {
  readonly kind = "magnitude";
  private from = { start: new THREE.Vector3(), along: new THREE.Vector3(), full: 1, step: 0, texts: [] as string[], numbers: [] as number[] };

  constructor(
    editor: Editor,
    sight: Sight,
    object: string,
    attribute: string,
    label: string,
    private readonly places: PlaceHandle[],
    private readonly direction: DirectionHandle | undefined,
  ) {
    super(editor, sight, object, attribute, label);
  }

  override get outwards(): Spot {
    const course = this.course();
    return course ? wayBetween(this.sight, course.start, course.start.clone().add(course.along)) : { x: 0, y: -1 };
  }

  protected ownPlace(): THREE.Vector3 | null {
    const [magnitude] = this.numbers;
    const course = this.course();
    return course && magnitude !== undefined ? course.start.addScaledVector(course.along, magnitude / course.full) : null;
  }

  protected start(_place: THREE.Vector3, numbers: number[], texts: string[]): void {
    const course = this.course()!;
    this.from = { ...course, step: stepOf(course.full / Math.max(this.lengthOf(course), 1)), texts, numbers };
  }

  protected pulled({ spot }: Pull): Held | null {
    const { start, along, full, step } = this.from;
    const times = this.sight.along(spot, start, along);
    if (times === null) return null;
    const [text] = textsOf([times * full], [step], this.from);
    return { text, place: start.clone().addScaledVector(along, Number(text) / full) };
  }

  // The vector of the largest magnitude, `full`, and where it starts.
  private course(): (Course & { full: number }) | null {
    const center = middleOf(this.editor, this.object, this.places);
    if (!center) return null;
    const drawn = this.editor.viewer.drawnOf(this.object);
    const length = drawn?.length || 0.1 * this.editor.viewer.reach;
    const full = this.full(drawn?.strongest ?? 0);
    const [now] = this.numbers;
    const tip = this.direction?.place;
    const courses: Course[] = [];
    if (tip && this.direction!.isPush) courses.push({ start: center, along: tip.sub(center) });
    else if (now) courses.push(...(drawn?.vectors ?? []).map(({ from, along }) => ({ start: from.clone(), along: along.clone().multiplyScalar(full / now) })));
    const best = courses.reduce<Course | null>((most, each) => (most && this.lengthOf(most) >= this.lengthOf(each) ? most : each), null);
    if (best && this.lengthOf(best) >= leastArrow) return { ...best, full };
    return { start: center, along: this.sight.right.add(this.sight.up).setLength(length), full };
  }

  // As it is seen. [px]
  private lengthOf({ start, along }: Course): number {
    const [a, b] = [this.sight.seen(start), this.sight.seen(start.clone().add(along))];
    return a && b ? between(a, b) : 0;
  }

  // Where nothing pushes yet, about what moves a region by a tenth of its width: that tenth / 0.00126 over the fourth power of
  // the share of the sheet (a clamped square plate under even load, Timoshenko and Woinowsky-Krieger, table 35).
  private full(strongest: number): number {
    if (strongest > 0) return strongest;
    const [now] = this.numbers;
    if (now) return Math.abs(now);
    const size = this.editor.viewer.reach;
    const radius = this.force?.deformationRadius ? at(this.force.deformationRadius, this.index) : size;
    const share = Math.min(Math.max((2 * radius) / size, 0.1), 1);
    return (0.1 * share * size) / 0.00126 / share ** 4;
  }
}

/** What is held of an object, the places first. */
export function handlesOf(editor: Editor, sight: Sight, { name, kind, shape, attributes }: SceneObject): Handle[] {
  const has = (attribute: string) => attributes.some((each) => each.name === attribute && !each.excluded && (each.value !== "" || each.animated));
  const places = ["center", "translate", "from", "to"].filter(has).map((attribute) => {
    const label = attribute === "from" || attribute === "to" ? `Move ${attribute} of ${name}` : `Move ${name}`;
    return new PlaceHandle(editor, sight, name, attribute, label);
  });
  // Those of what has a place; of a solid its own, not how far it reaches.
  const isRadius = (each: { name: string; element: string }) => /radius$/i.test(each.name) && each.element === (has("translate") ? shape : kind);
  const radii = places.length === 0 ? [] : attributes.filter((each) => isRadius(each) && has(each.name));
  const words = (attribute: string) => attribute.replace(/[A-Z]/g, (letter) => ` ${letter.toLowerCase()}`).replace(/^./, (letter) => letter.toUpperCase());
  const circles = radii.map((each, k) => new RadiusHandle(editor, sight, name, each.name, `${words(each.name)} of ${name}`, places[0], Math.PI * k));
  const way = ["direction", "axis"].find((each) => has(each) && attributes.some((it) => it.name === each && it.element === kind));
  const direction = way ? new DirectionHandle(editor, sight, name, way, `Direction of ${name}`, places) : undefined;
  const magnitude = has("magnitude") ? [new MagnitudeHandle(editor, sight, name, "magnitude", `Magnitude of ${name}`, places, direction)] : [];
  // A direction is farther out than the magnitude along it.
  return [...places, ...circles, ...magnitude, ...(direction ? [direction] : [])];
}
