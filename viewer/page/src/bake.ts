// The data that `pliant view` puts into the page, and its decoding; docs/viewer.md has the layout.

import * as THREE from "three";

/** A parameter with one value per frame, or a single value for all. */
export type Track<T> = T[];
export type Vector = [number, number, number];
/** First and last column, first and last row, in nodes. */
export type Box = [number, number, number, number];

export interface ArrayPlace {
  begin: number;
  count: number;
}

/** Lines on a surface: first point, number of points, first segment, number of segments. */
export type LinesPlace = [number, number, number, number];

/** The regions and boxes drawn on a surface, valid from a frame on: of a grid boxes, otherwise lines. */
export interface Marks {
  frame: number;
  regions: { solved: boolean; parts?: Box[]; lines?: LinesPlace }[];
  forces: { force: number; box?: Box; lines?: LinesPlace; push?: Vector }[];
}

/** Displacements from the mesh at rest, packed. */
export interface MotionHead {
  step: number;
  predictors: ArrayPlace;
  lowBytes: ArrayPlace;
  highBytes: ArrayPlace;
}

/** What is known of a surface besides its arrays. */
export interface SurfaceFacts {
  name: string;
  enabled: boolean;
  vertices: number;
  columns: number;
  rows: number;
  /** The directions in which the grid is closed. */
  wrap?: "u" | "v" | "uv";
  origin: Vector;
  peakDisplacement: number;
  peakSpeed: number;
  low: Vector;
  high: Vector;
  error: number;
  transforms: Track<number[]>;
  /** Of the shape at rest, if it is animated. */
  restMotion?: MotionHead;
  marks: Marks[];
}

interface SurfaceHead extends SurfaceFacts, MotionHead {
  rest: ArrayPlace;
  uvs: ArrayPlace;
  nodes: ArrayPlace;
  triangles: ArrayPlace;
  edges: ArrayPlace;
  pins?: ArrayPlace;
  /** How many vertices colliders push at each frame, and the steps to each from the one before, or from 0. */
  touching?: { counts: ArrayPlace; steps: ArrayPlace };
  lines?: { counts: ArrayPlace; sources: ArrayPlace; shares: ArrayPlace; segments: ArrayPlace };
}

/** Segments between points that are weighted sums of vertices. */
export interface Lines {
  /** For each point where its entries begin, and the end of the last. */
  starts: ArrayLike<number>;
  /** A vertex, or -1 - k for the earlier point k. */
  sources: ArrayLike<number>;
  shares: ArrayLike<number>;
  /** Two points each. */
  segments: ArrayLike<number>;
}

/** A force, or the region of a group. */
export interface Force {
  name: string;
  kind: string;
  /** Name of the group that contains it. */
  group?: string;
  targets: string[];
  enabled: Track<boolean>;
  magnitude?: Track<number>;
  deformationRadius?: Track<number>;
  forceRadius?: Track<number>;
  center?: Track<Vector>;
  direction?: Track<Vector>;
  from?: Track<Vector>;
  to?: Track<Vector>;
  axis?: Track<Vector>;
  pull?: Track<number>;
}

/** A solid that surfaces meet. */
export interface ColliderHead {
  name: string;
  /** Of its shape. */
  kind: string;
  targets: string[];
  enabled: Track<boolean>;
  /** Of its other channels, but for its transform. */
  values: Record<string, Track<number | boolean | Vector>>;
  transforms: Track<number[]>;
  /** At the first frame; a plane has neither these nor triangles. */
  points?: ArrayPlace;
  triangles?: ArrayPlace;
  /** No face shares its normals with another. */
  isFlat?: boolean;
  motion?: MotionHead;
}

/** Rows of a frame number and the components of the value. */
export interface Channel {
  path: string;
  components: number;
  /** Its values are 0 for false and 1 for true. */
  isSwitch?: true;
  /** In the words of the format; a tangent that is given by frames and values is `handle`. */
  keys: { at: number[]; next: string; in: string; out: string }[];
  /** Outside the keys, as an <animate> says it. */
  before: string;
  after: string;
  loop?: { from: number; to: number; before: number; after: number; offset: number[] };
  /** Of Bézier segments. */
  handles: { key: number[]; tip: number[]; side: "in" | "out" }[];
  points: number[][];
}

export interface Message {
  kind: "note" | "warning" | "error";
  line: number;
  text: string;
  file?: string;
}

/** What is known of a scene besides its arrays. */
export interface SceneFacts {
  scene: string;
  fps: number;
  first: number;
  last: number;
  /** The first and last frame of the scene, if this page has only some of its frames. */
  sceneFrames?: [number, number];
  /** The largest displacement of all surfaces at each frame, for the captions of pictures. */
  displaced?: number[];
  forces: Force[];
  colliders?: ColliderHead[];
  channels: Channel[];
  messages: Message[];
}

interface Head extends SceneFacts {
  version: number;
  surfaces: SurfaceHead[];
}

export function at<T>(track: Track<T>, index: number): T {
  return track[Math.min(index, track.length - 1)];
}

/** A track between frames: numbers are interpolated linearly, other values stay. */
export function between(track: Track<number>, index: number, share: number): number {
  const here = at(track, index);
  return share === 0 ? here : here + share * (at(track, index + 1) - here);
}

export function vectorBetween(track: Track<Vector>, index: number, share: number): Vector {
  const here = at(track, index);
  if (share === 0) return here;
  const next = at(track, index + 1);
  return [0, 1, 2].map((k) => here[k] + share * (next[k] - here[k])) as Vector;
}

/** The first three rows of a matrix between frames, each number interpolated. */
export function matrixBetween(track: Track<number[]>, index: number, share: number, out: THREE.Matrix4): THREE.Matrix4 {
  const here = at(track, index);
  const next = at(track, index + 1);
  const t = here.map((number, k) => number + share * (next[k] - number));
  return out.set(t[0], t[1], t[2], t[3], t[4], t[5], t[6], t[7], t[8], t[9], t[10], t[11], 0, 0, 0, 1);
}

/** Whole steps of all frames, each `count` numbers. */
interface Motion {
  step: number;
  count: number;
  steps: Int16Array;
}

function displace({ step, count, steps: all }: Motion, index: number, share: number, out: Float32Array): void {
  const frames = all.length / count;
  const here = index * count;
  const next = Math.min(index + 1, frames - 1) * count;
  for (let k = 0; k < count; ++k) {
    const steps = all[here + k];
    out[k] = step * (share === 0 ? steps : steps + share * (all[next + k] - steps));
  }
}

const nothing = new Uint32Array();

/** One surface over all frames. Object space, relative to `origin`. */
export class BakedSurface {
  readonly head: SurfaceFacts;
  readonly rest: Float32Array;
  readonly uvs: Float32Array;
  readonly triangles: Uint32Array;
  readonly edges: Uint32Array;
  /** A vertex of each held node. */
  readonly pins: Uint32Array;
  /** Those that colliders push, of each frame; none: nothing touches. */
  private readonly touching: Uint32Array[] = [];
  /** How many at one frame. */
  readonly mostTouching: number = 0;
  /** The node that each vertex moves as; -1: none. */
  readonly nodes: Int32Array;
  /** The first vertex of each node; -1: none. */
  readonly nodeVertices: Int32Array;
  private readonly lines: { starts: Uint32Array; sources: Int32Array; shares: Float32Array; segments: Uint32Array };
  private readonly motion: Motion;
  private readonly restMotion?: Motion;

  constructor(
    head: SurfaceHead,
    arrays: ArrayBuffer,
    start: number,
  ) {
    this.head = head;
    const floats = (place: ArrayPlace) => new Float32Array(arrays, start + place.begin, place.count);
    const whole = (place: ArrayPlace) => new Uint32Array(arrays, start + place.begin, place.count);
    const signed = (place: ArrayPlace) => new Int32Array(arrays, start + place.begin, place.count);
    const bytes = (place: ArrayPlace) => new Uint8Array(arrays, start + place.begin, place.count);
    this.rest = floats(head.rest);
    this.uvs = floats(head.uvs);
    this.triangles = whole(head.triangles);
    this.edges = whole(head.edges);
    this.pins = head.pins ? whole(head.pins) : new Uint32Array();
    if (head.touching) {
      const vertices = whole(head.touching.steps).slice();
      let end = 0;
      for (const count of whole(head.touching.counts)) {
        const those = vertices.subarray(end, (end += count));
        for (let k = 1; k < count; ++k) those[k] += those[k - 1];
        this.touching.push(those);
        this.mostTouching = Math.max(this.mostTouching, count);
      }
    }
    this.nodes = signed(head.nodes);
    this.nodeVertices = new Int32Array(head.columns * head.rows).fill(-1);
    for (let vertex = this.nodes.length; vertex-- > 0; ) {
      if (this.nodes[vertex] >= 0) this.nodeVertices[this.nodes[vertex]] = vertex;
    }
    const order = vertexOrder(this.nodes, this.nodeVertices.length);
    const motion = ({ step, predictors, lowBytes, highBytes }: MotionHead) => ({
      step,
      count: this.rest.length,
      steps: unfolded(bytes(predictors), bytes(lowBytes), bytes(highBytes), order),
    });
    this.motion = motion(head);
    if (head.restMotion) this.restMotion = motion(head.restMotion);
    const none = { begin: 0, count: 0 };
    const { counts, sources, shares, segments } = head.lines ?? { counts: none, sources: none, shares: none, segments: none };
    const starts = new Uint32Array(counts.count + 1);
    whole(counts).forEach((count, point) => (starts[point + 1] = starts[point] + count));
    this.lines = { starts, sources: signed(sources), shares: floats(shares), segments: whole(segments) };
  }

  linesAt([point, pointCount, segment, segmentCount]: LinesPlace): Lines {
    const { starts, sources, shares, segments } = this.lines;
    const own = starts.subarray(point, point + pointCount + 1);
    const [begin, end] = [own[0], own[pointCount]];
    return {
      starts: own.map((entry) => entry - begin),
      sources: sources.subarray(begin, end),
      shares: shares.subarray(begin, end),
      segments: segments.subarray(2 * segment, 2 * (segment + segmentCount)),
    };
  }

  /** Displacements from `rest` at frame `index` plus `share` of the way to the next. */
  displacementsAt(index: number, share: number, out: Float32Array): void {
    displace(this.motion, index, share, out);
  }

  /** Those of the shape at rest: 0 unless it is animated. */
  restDisplacementsAt(index: number, share: number, out: Float32Array): void {
    if (this.restMotion) displace(this.restMotion, index, share, out);
    else out.fill(0);
  }

  /** Vertices that colliders push at frame `index`. */
  touchingAt(index: number): Uint32Array {
    return this.touching[index] ?? nothing;
  }

  marksAt(frame: number): Marks | undefined {
    return this.head.marks.findLast((marks) => marks.frame <= frame);
  }
}

/** One collider over all frames, in its own space. */
export class BakedCollider {
  /** At the first frame; none of a plane. */
  readonly points: Float32Array;
  readonly triangles: Uint32Array;
  private readonly motion?: Motion;
  private readonly boxes: THREE.Box3[] = [];

  constructor(
    readonly head: ColliderHead,
    arrays: ArrayBuffer,
    start: number,
  ) {
    const bytes = (place: ArrayPlace) => new Uint8Array(arrays, start + place.begin, place.count);
    const { points, triangles, motion } = head;
    this.points = points ? new Float32Array(arrays, start + points.begin, points.count) : new Float32Array();
    this.triangles = triangles ? new Uint32Array(arrays, start + triangles.begin, triangles.count) : new Uint32Array();
    if (!motion) return;
    const order = Uint32Array.from({ length: this.points.length / 3 }, (_, vertex) => vertex);
    const steps = unfolded(bytes(motion.predictors), bytes(motion.lowBytes), bytes(motion.highBytes), order);
    this.motion = { step: motion.step, count: this.points.length, steps };
  }

  /** Around its points at a frame. */
  boxAt(index: number): THREE.Box3 {
    if (!this.motion) index = 0;
    if (!this.boxes[index]) {
      const points = new Float32Array(this.points.length);
      this.pointsAt(index, 0, points);
      this.boxes[index] = new THREE.Box3().setFromArray(points as unknown as number[]);
    }
    return this.boxes[index].clone();
  }

  pointsAt(index: number, share: number, out: Float32Array): void {
    if (this.motion) displace(this.motion, index, share, out);
    else out.fill(0);
    for (let k = 0; k < out.length; ++k) out[k] += this.points[k];
  }
}

/** Vertices in the order of their nodes, those without one first, those of one node in the order of the mesh. */
function vertexOrder(nodes: Int32Array, nodeCount: number): Uint32Array {
  const begins = new Uint32Array(nodeCount + 2);
  for (const node of nodes) ++begins[node + 2];
  for (let node = 0; node <= nodeCount; ++node) begins[node + 1] += begins[node];
  const order = new Uint32Array(nodes.length);
  nodes.forEach((node, vertex) => (order[begins[node + 1]++] = vertex));
  return order;
}

/** Integer displacements in steps, frames x vertices x 3, from the errors of their predictions. */
export function unfolded(predictors: Uint8Array, low: Uint8Array, high: Uint8Array, order: Uint32Array): Int16Array {
  const count = order.length;
  const steps = new Int16Array(predictors.length * count * 3);
  const along = 4;
  let read = 0;
  for (let frame = 0; frame < predictors.length; ++frame) {
    const kind = predictors[frame] & 3;
    const isAlong = (predictors[frame] & along) !== 0;
    const here = frame * count * 3;
    const before = kind >= 1 && frame >= 1 ? here - count * 3 : -1;
    const earlier = kind === 2 && frame >= 2 ? here - count * 6 : -1;
    for (let component = 0; component < 3; ++component) {
      let last = 0;
      for (let k = 0; k < count; ++k, ++read) {
        const folded = low[read] | (high[read] << 8);
        let missed = (folded >> 1) ^ -(folded & 1);
        if (isAlong) {
          missed += last;
          last = missed;
        }
        const place = 3 * order[k] + component;
        let guess = 0;
        if (before >= 0) guess = kind === 2 ? 2 * steps[before + place] : steps[before + place];
        if (earlier >= 0) guess -= steps[earlier + place];
        steps[here + place] = guess + missed; // modulo 2^16, as the Int16Array wraps
      }
    }
  }
  return steps;
}

/** All frames of a scene, packed. */
export class Bake implements ShownBake {
  readonly head: Head;
  readonly surfaces: BakedSurface[];
  readonly colliders: BakedCollider[];

  constructor(unpacked: ArrayBuffer) {
    const { head, start } = split<Head>(unpacked);
    this.head = head;
    this.surfaces = head.surfaces.map((surface) => new BakedSurface(surface, unpacked, start));
    this.colliders = (head.colliders ?? []).map((collider) => new BakedCollider(collider, unpacked, start));
  }

  get frameCount(): number {
    return this.head.last - this.head.first + 1;
  }
}

/** A surface over its frames, wherever they come from. */
export type ShownSurface = Pick<BakedSurface, keyof BakedSurface>;

/** A scene over its frames. */
export interface ShownBake {
  head: SceneFacts & { surfaces: SurfaceFacts[] };
  surfaces: ShownSurface[];
  colliders: BakedCollider[];
  frameCount: number;
}

/** The head of what a command packed, and where its arrays begin: the length of the head, the head, the arrays. */
export function split<T extends { version: number }>(unpacked: ArrayBuffer): { head: T; start: number } {
  const begin = 4;
  const length = new DataView(unpacked).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(unpacked, begin, length))) as T;
  if (head.version !== 1) throw new Error(`this page reads version 1, not ${head.version}`);
  return { head, start: begin + length };
}

/** Undoes the deflate stream that the command made. */
export function inflate(packed: Uint8Array<ArrayBuffer>): Promise<ArrayBuffer> {
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Response(stream).arrayBuffer();
}

export async function unpack(packed: Uint8Array<ArrayBuffer>): Promise<Bake> {
  return new Bake(await inflate(packed));
}

/** The bytes of a base 64 text. */
export function bytesOf(base64: string): Uint8Array<ArrayBuffer> {
  const letters = atob(base64); // one for each byte
  const bytes = new Uint8Array(letters.length);
  for (let k = 0; k < bytes.length; ++k) bytes[k] = letters.charCodeAt(k);
  return bytes;
}
