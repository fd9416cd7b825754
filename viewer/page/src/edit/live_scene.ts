// The scene that is edited, as the stage shows it: what the command has solved so far, at the newest revision.

import * as THREE from "three";

import { BakedCollider, matrixBetween, split, type ArrayPlace, type ColliderHead, type Lines, type LinesPlace, type Marks, type Message, type SceneFacts, type ShownBake, type ShownSurface, type SurfaceFacts } from "../bake";
import { Changing } from "../changing";
import { Refusal } from "./requests";
import type { Session } from "./session";

/** The answer to `scene`: a page's head without arrays. */
export interface LiveFacts extends SceneFacts {
  revision: number;
  /** Of each the `shape` at rest. */
  surfaces: (SurfaceFacts & { shape: string; origin: [number, number, number] })[];
  colliders?: (ColliderHead & { shape?: string })[];
}

/** World positions of all surfaces at one frame. */
export interface SolvedFrame {
  revision: number;
  frame: number;
  positions: Float32Array[];
}

/** Regions, and what touches, at one frame. */
interface Details {
  revision: number;
  frame: number;
  marks: Marks[];
  touching: Uint32Array[];
  lines: (Lines | null)[];
  rest: (Float32Array | null)[];
  messages: Message[];
  /** All frames had been solved: there are no further messages. */
  isComplete: boolean;
}

class LiveSurface implements ShownSurface {
  readonly rest: Float32Array;
  readonly uvs: Float32Array;
  readonly triangles: Uint32Array;
  readonly edges: Uint32Array;
  readonly pins: Uint32Array;
  readonly nodes: Int32Array;
  readonly nodeVertices: Int32Array;
  head!: LiveFacts["surfaces"][number];
  private readonly inverse = new THREE.Matrix4();

  constructor(
    readonly shape: string,
    private readonly scene: LiveScene,
    /** Among the surfaces of the scene. */
    public index: number,
    unpacked: ArrayBuffer,
  ) {
    const { head, start } = split<{ version: number; columns: number; rows: number } & Record<"rest" | "uvs" | "triangles" | "edges" | "nodes", ArrayPlace> & { pins?: ArrayPlace }>(unpacked);
    const floats = (place: ArrayPlace) => new Float32Array(unpacked, start + place.begin, place.count);
    const whole = (place: ArrayPlace) => new Uint32Array(unpacked, start + place.begin, place.count);
    this.rest = floats(head.rest);
    this.uvs = floats(head.uvs);
    this.triangles = whole(head.triangles);
    this.edges = whole(head.edges);
    this.pins = head.pins ? whole(head.pins) : new Uint32Array();
    this.nodes = new Int32Array(unpacked, start + head.nodes.begin, head.nodes.count);
    this.nodeVertices = new Int32Array(head.columns * head.rows).fill(-1);
    for (let vertex = this.nodes.length; vertex-- > 0; ) {
      if (this.nodes[vertex] >= 0) this.nodeVertices[this.nodes[vertex]] = vertex;
    }
  }

  get mostTouching(): number {
    return this.rest.length / 3;
  }

  displacementsAt(index: number, share: number, out: Float32Array): void {
    const here = this.scene.solvedAt(index)?.positions[this.index];
    if (!here || here.length !== out.length) return void out.fill(0);
    this.subtract(here, index, out);
    const next = share === 0 ? undefined : this.scene.solvedAt(index + 1)?.positions[this.index];
    if (!next) return;
    const then = new Float32Array(out.length);
    this.subtract(next, index + 1, then);
    for (let k = 0; k < out.length; ++k) out[k] += share * (then[k] - out[k]);
  }

  restDisplacementsAt(index: number, _share: number, out: Float32Array): void {
    const rest = this.scene.detailsAt(index)?.rest[this.index];
    if (rest?.length === out.length) for (let k = 0; k < out.length; ++k) out[k] = rest[k] - this.rest[k];
    else out.fill(0);
  }

  touchingAt(index: number): Uint32Array {
    return this.scene.drawingAt(index)?.touching[this.index] ?? new Uint32Array();
  }

  marksAt(frame: number): Marks | undefined {
    return this.scene.drawingAt(frame - this.scene.head.first)?.marks[this.index];
  }

  linesAt([point, pointCount, segment, segmentCount]: LinesPlace): Lines {
    const { starts, sources, shares, segments } = this.scene.shownDetails!.lines[this.index]!;
    const own = Uint32Array.from({ length: pointCount + 1 }, (_, k) => starts[point + k]);
    const [begin, end] = [own[0], own[pointCount]];
    const part = <T extends { subarray(from: number, to: number): T }>(array: ArrayLike<number>, from: number, to: number) => (array as unknown as T).subarray(from, to);
    return { starts: own.map((entry) => entry - begin), sources: part<Int32Array>(sources, begin, end), shares: part<Float32Array>(shares, begin, end), segments: part<Uint32Array>(segments, 2 * segment, 2 * (segment + segmentCount)) };
  }

  /** The largest distance of world positions from rest. */
  farthest(positions: Float32Array, index: number): number {
    const { transforms, origin } = this.head;
    const m = matrixBetween(transforms, index, 0, this.inverse).elements;
    const { rest } = this;
    let most = 0;
    for (let k = 0; k < rest.length; k += 3) {
      const [x, y, z] = [rest[k] + origin[0], rest[k + 1] + origin[1], rest[k + 2] + origin[2]];
      let sum = 0;
      for (let row = 0; row < 3; ++row) sum += (positions[k + row] - (m[row] * x + m[row + 4] * y + m[row + 8] * z + m[row + 12])) ** 2;
      if (sum > most) most = sum;
    }
    // What single precision makes of it is no motion.
    const least = 4 * this.head.error;
    return most > least * least ? Math.sqrt(most) : 0;
  }

  // World positions as displacements from rest in object space.
  private subtract(positions: Float32Array, index: number, out: Float32Array): void {
    const { transforms, origin } = this.head;
    const m = matrixBetween(transforms, index, 0, this.inverse).invert().elements;
    for (let k = 0; k < out.length; k += 3) {
      const [x, y, z] = [positions[k], positions[k + 1], positions[k + 2]];
      for (let row = 0; row < 3; ++row) out[k + row] = m[row] * x + m[row + 4] * y + m[row + 8] * z + m[row + 12] - origin[row] - this.rest[k + row];
    }
  }
}

/** Tells when something else is to be drawn: `isNew` if it is the scene, otherwise a frame. */
export class LiveScene extends Changing<[isNew: boolean]> implements ShownBake {
  head!: LiveFacts;
  surfaces: LiveSurface[] = [];
  colliders: BakedCollider[] = [];
  /** Ranges of frames that are solved at `readyRevision`. */
  ready: [number, number][] = [];
  readyRevision = -1;
  shownDetails: Details | null = null;
  private readonly progress: (() => void)[] = [];
  private readonly shapes = new Map<string, ArrayBuffer>();
  private solved = new Map<number, SolvedFrame>();
  /** Of the revision before, until there are newer ones. */
  private older: SolvedFrame | null = null;
  private isReading = false;
  private wanted = -1;
  private fetching: AbortController | null = null;
  private frame = 0;
  private pending = 0;
  private soon = 0;
  private isAhead = false;
  private messages: Message[] | null = null;
  /** The largest displacement and speed of each surface in the frames of the newest revision that are here. */
  private peaks = { revision: -1, displacement: [] as number[], speed: [] as number[] };

  constructor(private readonly session: Session) {
    super();
    session.onNewer(() => this.update());
    session.onChange(() => this.head || void this.readScene());
  }

  get frameCount(): number {
    return this.head.last - this.head.first + 1;
  }

  /** What is on the screen at a frame; `isExact`: it is the newest revision's. */
  get shown(): { solved: SolvedFrame | null; isExact: boolean } {
    const solved = this.solved.get(this.frame) ?? null;
    return solved?.revision === this.session.revision ? { solved, isExact: true } : { solved: solved ?? this.older, isExact: false };
  }

  /** Calls `listener` when other frames are ready. */
  onProgress(listener: () => void): void {
    this.progress.push(listener);
  }

  /** The playhead is there. */
  goTo(frame: number): void {
    if (frame === this.frame && this.solved.get(frame)?.revision === this.session.revision) return;
    this.frame = frame;
    this.ask();
    this.askDetails();
  }

  isReady(frame: number): boolean {
    return this.readyNow.some(([first, last]) => first <= frame && frame <= last);
  }

  /** Ranges of frames that are solved at the newest revision. */
  get readyNow(): [number, number][] {
    return this.readyRevision === this.session.revision ? this.ready : [];
  }

  takeReady(revision: number, ready: [number, number][]): void {
    [this.readyRevision, this.ready] = [revision, ready];
    for (const listener of this.progress) listener();
    this.fetchSoon();
    this.askDetails();
  }

  solvedAt(index: number): SolvedFrame | null {
    const frame = this.head.first + index;
    return this.solved.get(frame) ?? (frame === this.frame ? this.older : (this.solved.get(this.frame) ?? this.older));
  }

  detailsAt(_index: number): Details | null {
    return this.shownDetails;
  }

  /** What is drawn on the surfaces: not beside a force that is elsewhere by now. */
  drawingAt(index: number): Details | null {
    return this.shownDetails?.frame === this.head.first + index ? this.shownDetails : null;
  }

  /** There is a newer revision: asks for the frame shown at once, and for what the scene says. */
  private update(): void {
    clearTimeout(this.soon);
    this.soon = 0;
    for (const listener of this.progress) listener();
    this.ask();
    void this.readScene();
  }

  async readScene(): Promise<void> {
    if (this.isReading || this.session.facts.text === null) return;
    this.isReading = true;
    while (this.wanted !== this.session.revision) {
      this.wanted = this.session.revision;
      try {
        const facts = await this.session.requests.json<LiveFacts>(`scene?revision=${this.wanted}`);
        await this.fetchShapes(facts);
        if (facts.revision === this.session.revision) this.take(facts);
      } catch (error) {
        this.isReading = false;
        if (!(error instanceof Refusal)) {
          if (this.session.isAlive) throw error;
          return;
        }
        if (error.status === 422) {
          this.session.fail(this.wanted, error.errors);
          this.empty();
        }
        this.isReading = true;
      }
    }
    this.isReading = false;
  }

  // Without a surface there is nothing that the command could play, nor that could stay on the stage.
  private empty(): void {
    const { facts, objects, revision } = this.session;
    if (facts.revision !== revision || objects.some(({ kind }) => kind === "surface")) return;
    this.take({ revision, scene: facts.file, fps: facts.fps, first: facts.start, last: facts.end, surfaces: [], forces: [], channels: [], messages: [] });
  }

  private async fetchShapes({ surfaces, colliders = [] }: LiveFacts): Promise<void> {
    const keys = new Set([...surfaces, ...colliders].flatMap(({ shape }) => (shape ? [shape] : [])));
    for (const key of [...this.shapes.keys()]) if (!keys.has(key)) this.shapes.delete(key);
    for (const key of keys) {
      if (!this.shapes.has(key)) this.shapes.set(key, await this.session.requests.bytes(`shape?key=${key}`));
    }
  }

  private take(facts: LiveFacts): void {
    const before = this.surfaces;
    this.head = facts;
    // Those of the revision before stay until all frames have told theirs.
    facts.messages = this.messages ?? facts.messages;
    this.surfaces = facts.surfaces.map((head, k) => {
      const surface = before.find((each) => each.shape === head.shape && each.head.name === head.name) ?? new LiveSurface(head.shape, this, k, this.shapes.get(head.shape)!);
      surface.index = k;
      const { peakDisplacement = 0, peakSpeed = 0 } = surface.head ?? {};
      surface.head = Object.assign(head, { peakDisplacement, peakSpeed });
      return surface;
    });
    this.colliders = (facts.colliders ?? []).map((head) => {
      if (!head.shape) return new BakedCollider(head, new ArrayBuffer(0), 0);
      const packed = this.shapes.get(head.shape)!;
      const { head: arrays, start } = split<ColliderHead & { version: number }>(packed);
      return new BakedCollider({ ...arrays, ...head }, packed, start);
    });
    this.tell(true);
    this.fetchSoon();
  }

  // The newest frame that is wanted is the only one that is asked for.
  private ask(): void {
    if (!this.head) return; // its frames are not known yet
    const { revision } = this.session;
    const { frame } = this;
    if (this.solved.get(frame)?.revision === revision) return this.tell(false);
    this.fetching?.abort();
    const fetching = (this.fetching = new AbortController());
    this.fetchFrame(revision, frame, fetching.signal).then(
      (solved) => {
        this.keep(solved);
        if (frame === this.frame) this.tell(false);
      },
      (error: Error) => {
        if (error instanceof Refusal && error.status === 422) this.session.fail(revision, error.errors);
      },
    );
  }

  private async fetchFrame(revision: number, frame: number, signal?: AbortSignal): Promise<SolvedFrame> {
    const bytes = await this.session.requests.bytes(`frame?revision=${revision}&frame=${frame}`, signal);
    return { revision, frame, positions: positionsIn(bytes) };
  }

  private keep(solved: SolvedFrame): void {
    if (solved.revision !== this.session.revision) return;
    for (const [frame, old] of this.solved) {
      if (old.revision === solved.revision) continue;
      this.older = old;
      this.solved.delete(frame);
    }
    this.solved.set(solved.frame, solved);
    this.measure(solved);
    // Those farthest from the playhead give way.
    let bytes = 0;
    for (const { positions } of this.solved.values()) for (const each of positions) bytes += each.byteLength;
    if (bytes <= mostBytes) return;
    const farthest = [...this.solved.keys()].reduce((a, b) => (Math.abs(a - this.frame) >= Math.abs(b - this.frame) ? a : b));
    this.solved.delete(farthest);
  }

  // Frames that are ready are fetched ahead, one after the other, while they are likely to fit.
  // While something is dragged, only the frame shown is.
  private fetchSoon(): void {
    this.soon ||= window.setTimeout(() => {
      this.soon = 0;
      void this.fetchAhead();
    }, 200);
  }

  private async fetchAhead(): Promise<void> {
    if (this.isAhead || !this.head) return;
    this.isAhead = true;
    try {
      for (let next; (next = this.nextAhead()) !== null; ) this.keep(await this.fetchFrame(this.session.revision, next));
    } catch {
      // What is missing is asked for when it is shown.
    }
    this.isAhead = false;
    if (this.solved.size === this.frameCount) this.showPeaks(true);
  }

  // How far and how fast a frame has moved.
  private measure({ revision, frame, positions }: SolvedFrame): void {
    if (this.peaks.revision !== revision) this.peaks = { revision, displacement: [], speed: [] };
    const { displacement, speed } = this.peaks;
    const before = this.solved.get(frame - 1);
    this.surfaces.forEach((surface, k) => {
      const here = positions[k];
      if (here?.length !== surface.rest.length) return;
      displacement[k] = Math.max(displacement[k] ?? 0, surface.farthest(here, frame - this.head.first));
      if (before?.revision === revision) speed[k] = Math.max(speed[k] ?? 0, this.head.fps * farthestApart(here, before.positions[k]));
    });
    this.showPeaks(false);
  }

  // The colours of a surface do not change while it is solved, unless they would not reach.
  private showPeaks(areAll: boolean): void {
    this.surfaces.forEach(({ head }, k) => {
      const least = areAll ? [0, 0] : [head.peakDisplacement, head.peakSpeed];
      head.peakDisplacement = Math.max(least[0], this.peaks.displacement[k] ?? 0);
      head.peakSpeed = Math.max(least[1], this.peaks.speed[k] ?? 0);
    });
    if (areAll) this.tell(false);
  }

  private nextAhead(): number | null {
    const one = this.surfaces.reduce((sum, { rest }) => sum + rest.byteLength, 0);
    const count = Math.min(Math.floor(mostBytes / 2 / Math.max(one, 1)), this.frameCount);
    for (let k = 0; k < count; ++k) {
      const frame = this.head.first + ((this.frame - this.head.first + k) % this.frameCount);
      if (this.isReady(frame) && this.solved.get(frame)?.revision !== this.session.revision) return frame;
    }
    return null;
  }

  // Regions and dots follow when the hand rests.
  private askDetails(): void {
    if (!this.head) return;
    clearTimeout(this.pending);
    this.pending = window.setTimeout(() => void this.fetchDetails(), 60);
  }

  private async fetchDetails(): Promise<void> {
    const { revision } = this.session;
    const { frame } = this;
    const isComplete = this.readyNow.some(([first, last]) => first <= this.head.first && this.head.last <= last);
    if (this.shownDetails?.revision === revision && this.shownDetails.frame === frame && this.shownDetails.isComplete === isComplete) return;
    try {
      const bytes = await this.session.requests.bytes(`details?revision=${revision}&frame=${frame}`);
      if (revision !== this.session.revision || frame !== this.frame) return;
      this.shownDetails = { revision, frame, isComplete, ...unpackDetails(bytes) };
      if (isComplete && this.head.revision === revision) this.head.messages = this.messages = this.shownDetails.messages;
      this.tell(false);
      for (const listener of this.progress) listener();
    } catch {
      // It has changed meanwhile, or cannot be solved, which the frame tells.
    }
  }
}

/** The world positions of each surface in the answer to `frame`. */
export function positionsIn(bytes: ArrayBuffer): Float32Array[] {
  const positions: Float32Array[] = [];
  const view = new DataView(bytes);
  for (let at = 0; at < bytes.byteLength; ) {
    const count = 3 * view.getUint32(at, true);
    positions.push(new Float32Array(bytes, at + 4, count));
    at += 4 + 4 * count;
  }
  return positions;
}

function farthestApart(a: Float32Array, b: Float32Array): number {
  let most = 0;
  for (let k = 0; k < a.length; k += 3) most = Math.max(most, (a[k] - b[k]) ** 2 + (a[k + 1] - b[k + 1]) ** 2 + (a[k + 2] - b[k + 2]) ** 2);
  return Math.sqrt(most);
}

const mostBytes = 400_000_000;

interface DetailsHead {
  version: number;
  messages: Message[];
  surfaces: { marks: Marks; touching: ArrayPlace; rest?: ArrayPlace; lines?: Record<"counts" | "sources" | "shares" | "segments", ArrayPlace> }[];
}

function unpackDetails(bytes: ArrayBuffer): Omit<Details, "revision" | "frame" | "isComplete"> {
  const { head, start } = split<DetailsHead>(bytes);
  const whole = (place: ArrayPlace) => new Uint32Array(bytes, start + place.begin, place.count);
  const floats = (place: ArrayPlace) => new Float32Array(bytes, start + place.begin, place.count);
  return {
    messages: head.messages,
    marks: head.surfaces.map(({ marks }) => marks),
    touching: head.surfaces.map(({ touching }) => whole(touching)),
    rest: head.surfaces.map(({ rest }) => (rest ? floats(rest) : null)),
    lines: head.surfaces.map(({ lines }) => {
      if (!lines) return null;
      const counts = whole(lines.counts);
      const starts = new Uint32Array(counts.length + 1);
      counts.forEach((count, k) => (starts[k + 1] = starts[k] + count));
      return { starts, sources: new Int32Array(bytes, start + lines.sources.begin, lines.sources.count), shares: floats(lines.shares), segments: whole(lines.segments) };
    }),
  };
}
