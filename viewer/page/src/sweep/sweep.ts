// The data that `pliant sweep view` puts into the page, and its decoding; docs/viewer.md has the
// layout. A row is a take of the table on this page, which may have only some of all takes.

import { split, unfolded, type ArrayPlace, type Vector } from "../bake";
import { distinctTexts } from "./numbers";

interface TextsHead {
  texts: string[];
  rows: ArrayPlace;
}

interface ShapeHead {
  take: number;
  frame: number;
  vertices: number;
  shown: number;
  displaced: number;
  mesh: number;
  origin: Vector;
  low: Vector;
  high: Vector;
  step: number;
  predictors: ArrayPlace;
  lowBytes: ArrayPlace;
  highBytes: ArrayPlace;
  displacedLow: ArrayPlace;
  displacedHigh: ArrayPlace;
}

interface Head {
  version: number;
  name: string;
  command: string;
  takes: number;
  done: number;
  failed: number;
  paths: string[];
  axes: { count: number; paths: number[] }[];
  table: { takes: ArrayPlace; status: ArrayPlace; paths: TextsHead[]; hash: ArrayPlace; errors: TextsHead } & Record<(typeof measureNames)[number], ArrayPlace>;
  shapes: { meshes: ArrayPlace[]; takes: ShapeHead[] };
  failures: { take: number; text: string }[];
  conflicts: { take: number; text: string }[];
}

export const measureNames = ["peak", "peakFrame", "final", "rms", "speed", "energy", "settle"] as const;

/** What each measure is, for a tooltip, docs/sweeps.md; and its unit, in those of the scene. */
const aboutMeasures: Record<(typeof measureNames)[number], [about: string, unit: string]> = {
  peak: ["the largest displacement", "scene units"],
  peakFrame: ["the first frame with the largest displacement", "frame"],
  final: ["the largest displacement at the last frame", "scene units"],
  rms: ["the root mean square of displacements over frames and vertices", "scene units"],
  speed: ["the largest speed of a vertex", "scene units/s"],
  energy: ["the largest kinetic energy per mass", "scene units²/s²"],
  settle: ["the frame after which nothing moves more than a thousandth of the peak", "frame"],
};

/** A column of texts: each once, and which of them a row has. */
export interface Texts {
  texts: string[];
  rows: Uint32Array;
}

/** A PATH that varies. */
export interface Path extends Texts {
  /** As typed. */
  title: string;
  /** The end of it that tells it from the others. */
  name: string;
  /** Of each text; null: some are no numbers. */
  numbers: number[] | null;
  /** Each text, short enough to read at a glance: a number with four digits or as many as tell it from the others, of files their names if these differ. */
  shortTexts: string[];
}

export interface Measure {
  name: string;
  about: string;
  unit: string;
  /** It is a frame. */
  isWhole: boolean;
  /** Of each row; NaN: there is none. */
  values: Float64Array;
}

/** A take at one frame. World space, relative to the sweep's `origin`. */
export interface TakeShape {
  row: number;
  frame: number;
  /** Vertices of the mesh, and of its coarser copy here. */
  vertices: number;
  shown: number;
  /** Positions, and the distance from rest of each vertex; unpacked at each call. */
  unpack(): { positions: Float32Array; displaced: Float32Array };
  /** The greatest distance from rest, of the whole mesh. */
  mostDisplaced: number;
  triangles: Uint32Array;
  mesh: number;
  low: Vector;
  high: Vector;
  /** It is so much larger than the others that these would be dots beside it. */
  isGiant: boolean;
}

/** A take is a giant if its box is larger than this many times that of the middle take. */
const giantSize = 8;

export const states = ["missing", "failed", "done"] as const;

const numberPattern = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;

/** The ends of paths, as long as necessary to differ: `damping` of `sheet.damping`. */
function shortNames(titles: string[]): string[] {
  const ends = (title: string, parts: number) => title.split(".").slice(-parts).join(".");
  return titles.map((title) => {
    // A component belongs to its attribute.
    for (let parts = /\.[xyz][*+]?$/.test(title) ? 2 : 1; parts < 4; ++parts) {
      const name = ends(title, parts);
      if (titles.filter((other) => ends(other, parts) === name).length === 1) return name;
    }
    return title;
  });
}

export class Sweep {
  readonly head: Head;
  readonly rowCount: number;
  readonly takes: Uint32Array;
  readonly paths: Path[];
  readonly measures: Measure[];
  readonly errors: Texts;
  readonly shapes: TakeShape[];
  /** A point amid the shapes, giants not counted, world space. */
  readonly origin: Vector = [0, 0, 0];
  private readonly status: Uint8Array;
  private readonly hashes: Uint8Array;
  private readonly rowOf = new Map<number, number>();
  private readonly shapeOf = new Map<number, TakeShape>();

  constructor(unpacked: ArrayBuffer) {
    const { head, start } = split<Head>(unpacked);
    this.head = head;
    const whole = (place: ArrayPlace) => new Uint32Array(unpacked, start + place.begin, place.count);
    const bytes = (place: ArrayPlace) => new Uint8Array(unpacked, start + place.begin, place.count);
    const { table } = head;
    this.takes = whole(table.takes);
    this.rowCount = this.takes.length;
    this.takes.forEach((take, row) => this.rowOf.set(take, row));
    this.status = bytes(table.status);
    this.hashes = bytes(table.hash);
    this.errors = { texts: table.errors.texts, rows: whole(table.errors.rows) };
    const names = shortNames(head.paths);
    this.paths = table.paths.map(({ texts, rows }, k) => {
      const numbers = texts.every((text) => numberPattern.test(text)) ? texts.map(Number) : null;
      const ends = texts.map((text) => text.split("/").pop() || text);
      const shortTexts = numbers ? distinctTexts(numbers) : new Set(ends).size === texts.length ? ends : texts;
      return { title: head.paths[k], name: names[k], texts, rows: whole(rows), numbers, shortTexts };
    });
    this.measures = measureNames.map((name) => {
      const { begin, count } = table[name];
      const [about, unit] = aboutMeasures[name];
      const isWhole = unit === "frame";
      // Doubles must be aligned to eight bytes, but the arrays are to four.
      const stored = isWhole
        ? new Int32Array(unpacked, start + begin, count)
        : new Float64Array(unpacked.slice(start + begin, start + begin + 8 * count));
      return { name, about, unit, isWhole, values: Float64Array.from(stored, (value, row) => (this.isDone(row) ? value : NaN)) };
    });
    const meshes = head.shapes.meshes.map((place) => joined(whole(place)));
    const sizeOf = ({ low, high }: ShapeHead) => Math.hypot(...high.map((each, k) => each - low[k]));
    const middle = [...head.shapes.takes].sort((a, b) => sizeOf(a) - sizeOf(b))[Math.floor((head.shapes.takes.length - 1) / 2)];
    if (middle) this.origin = middle.origin;
    this.shapes = head.shapes.takes.map((shape): TakeShape => {
      const relative = (place: Vector) => place.map((each, k) => each - this.origin[k]) as Vector;
      return {
        row: this.rowOf.get(shape.take)!,
        frame: shape.frame,
        vertices: shape.vertices,
        shown: shape.shown,
        unpack: () => {
          const shift = shape.origin.map((each, k) => each - this.origin[k]);
          const positions = new Float32Array(3 * shape.shown);
          const displaced = new Float32Array(shape.shown);
          const order = Uint32Array.from({ length: shape.shown }, (_, k) => k);
          const steps = unfolded(bytes(shape.predictors), bytes(shape.lowBytes), bytes(shape.highBytes), order);
          const [low, high] = [bytes(shape.displacedLow), bytes(shape.displacedHigh)];
          for (let k = 0; k < positions.length; ++k) positions[k] = steps[k] * shape.step + shift[k % 3];
          for (let k = 0; k < displaced.length; ++k) displaced[k] = ((low[k] | (high[k] << 8)) / 65535) * shape.displaced;
          return { positions, displaced };
        },
        mostDisplaced: shape.displaced,
        triangles: meshes[shape.mesh],
        mesh: shape.mesh,
        low: relative(shape.low),
        high: relative(shape.high),
        isGiant: sizeOf(shape) > giantSize * sizeOf(middle),
      };
    });
    for (const shape of this.shapes) this.shapeOf.set(shape.row, shape);
  }

  get hasAllTakes(): boolean {
    return this.rowCount === this.head.takes;
  }

  shape(row: number): TakeShape | undefined {
    return this.shapeOf.get(row);
  }

  row(take: number): number | undefined {
    return this.rowOf.get(take);
  }

  stateOf(row: number): (typeof states)[number] {
    return states[this.status[row]];
  }

  isDone(row: number): boolean {
    return this.status[row] === 2;
  }

  errorOf(row: number): string {
    return textOf(this.errors, row);
  }

  hashOf(row: number): string {
    if (!this.isDone(row)) return "";
    return Array.from(this.hashes.subarray(16 * row, 16 * row + 16), (byte) => byte.toString(16).padStart(2, "0")).join("");
  }

  /** Which of an axis's values a row has. */
  stepOf(axis: number, row: number): number {
    let stride = 1;
    for (let k = this.head.axes.length - 1; k > axis; --k) stride *= this.head.axes[k].count;
    return Math.floor(this.takes[row] / stride) % this.head.axes[axis].count;
  }

  /** A take for those who hear the page. */
  inWords(row: number): string {
    const state = this.stateOf(row);
    const more = state === "done" ? this.measures.map((measure) => `${measure.name} ${measureText(measure, row)}`) : [state, this.errorOf(row)].filter(Boolean);
    return [`take ${this.takes[row]}`, ...this.captions(row, Infinity).map((each) => each.join(" ")), ...more].join(", ");
  }

  /** The names and values of what varies, short enough to read at a glance. */
  captions(row: number, most: number): [string, string][] {
    const all = this.paths.map((path): [string, string] => [path.name, shortText(path, row)]);
    return all.length <= most ? all : [...all.slice(0, most - 1), [`and ${all.length - most + 1} more`, ""]];
  }
}

/** Each corner is stored less that of the triangle before. */
function joined(differences: Uint32Array): Uint32Array {
  const corners = differences.slice();
  for (let k = 3; k < corners.length; ++k) corners[k] += corners[k - 3];
  return corners;
}

export const textOf = ({ texts, rows }: Texts, row: number) => texts[rows[row]];

export const shortText = ({ shortTexts, rows }: Path, row: number) => shortTexts[rows[row]];

/** With six digits, as the command's summaries. */
export function measureText({ values }: Measure, row: number): string {
  const value = values[row];
  if (Number.isNaN(value)) return "";
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e6 || size < 1e-4)) return Number(value.toPrecision(6)).toExponential().replace("e+", "e");
  return String(Number(value.toPrecision(6)));
}

/** The command that writes a take. */
export function commandOf({ takes, head }: Sweep, row: number): string {
  return `${head.command} ${takes[row]} -o take${takes[row]}.glb`;
}
