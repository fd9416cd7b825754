// Curves over frames on a canvas: grid, curves with keys and handles, the frame shown, and the
// values at the cursor.

import type { Channel } from "./bake";
import type { FrameAxis } from "./frame_axis";
import type { Palette } from "./theme";
import { addDiamond, niceStep, prepare, textSize } from "./timeline";

/** A channel's value, or a component of it, as one line. */
export interface Curve {
  channel: Channel;
  /** Index into the rows of the channel. */
  component: number;
  /** Name of the component of a vector; empty: the channel is not a vector. */
  part: string;
  colour: string;
  dash: number[];
}

/** The frame at the cursor, and the curve near it; null: none. */
export interface Hover {
  frame: number;
  curve: Curve | null;
}

/** How a key is drawn. */
export type KeyState = "plain" | "selected" | "clash";

/** A line behind the curves: what one was before, or what a hand did. */
export interface Trace {
  kind: "before" | "hand";
  /** Frames and values. */
  points: [number, number][];
}

/** The content of the plot. */
export interface CurvePicture {
  curves: Curve[];
  palette: Palette;
  first: number;
  last: number;
  /** The frame shown. */
  time: number;
  hover: Hover | null;
  /** Shown if there is no curve. */
  empty: string;
  /** The frames shown; null: all. */
  frames: [number, number] | null;
  /** The values shown; null: those of the curves. */
  values: [number, number] | null;
  stateOf: (curve: Curve, frame: number) => KeyState;
  traces: Trace[];
  /** Frames that stand out. */
  shaded: [number, number][];
}

/** The map between frames and values and the canvas. [CSS px] */
export interface Scales {
  x: (frame: number) => number;
  y: (value: number) => number;
  frameAt: (x: number) => number;
  valueAt: (y: number) => number;
  frames: [number, number];
  values: [number, number];
  left: number;
  right: number;
  floor: number;
}

const top = 10;
const reachOfCursor = 12;
const bottomOf = (text: number) => 1.9 * text;
/** With more keys of a curve in the window they are dots. */
const mostDiamonds = 300;
/** With more of them, only those that are chosen have handles. */
const mostHandles = 100;

/** The engine's value at a whole frame: at a jump, the value after it. */
export function valueAt({ channel, component }: Curve, frame: number): number | undefined {
  const { points } = channel;
  const point = points[after(points, frame) - 1];
  return point?.[0] === frame ? point[component] : undefined;
}

export class CurvePlot {
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly axis: FrameAxis,
  ) {}

  /** Measures the page once for what is drawn. */
  scales({ curves, traces, first, last, frames, values }: CurvePicture, height = this.canvas.clientHeight): Scales {
    const [from, to] = frames ?? [first, Math.max(last, first + 1)];
    const [low, high] = values ?? range(curves, traces, from, to);
    const left = this.axis.x(first, this.canvas);
    const right = this.axis.x(Math.max(last, first + 1), this.canvas);
    const floor = height - bottomOf(textSize());
    const perFrame = (right - left) / (to - from);
    const perValue = (floor - top) / (high - low);
    return {
      x: (frame) => left + (frame - from) * perFrame,
      y: (value) => floor - (value - low) * perValue,
      frameAt: (x) => from + (x - left) / perFrame,
      valueAt: (y) => low + (floor - y) / perValue,
      frames: [from, to],
      values: [low, high],
      left,
      right,
      floor,
    };
  }

  draw(picture: CurvePicture): void {
    // Many small marks are faster by the processor, also where there is a graphics card.
    const surface = prepare(this.canvas, { willReadFrequently: true });
    if (!surface) return;
    const { context, width, height } = surface;
    const { curves, palette, hover } = picture;
    const scales = this.scales(picture, height);
    const { x, left, right, floor } = scales;
    context.font = `${textSize()}px system-ui, sans-serif`;
    context.save();
    context.beginPath();
    context.rect(left - 6, 0, right - left + 12, floor);
    context.clip();
    context.fillStyle = palette.accent;
    context.globalAlpha = 0.1;
    for (const [from, to] of picture.shaded) context.fillRect(x(from) - 2, top, x(to) - x(from) + 4, floor - top);
    context.globalAlpha = 1;
    context.restore();
    this.drawGrid(context, palette, scales, height);
    const isSeen = (frame: number) => x(frame) >= left - 1 && x(frame) <= right + 1;
    if (hover && isSeen(hover.frame)) vertical(context, x(hover.frame), top, floor, palette.faint, 1);
    context.save();
    context.beginPath();
    context.rect(left - 6, 0, right - left + 12, floor);
    context.clip();
    for (const { points, kind } of picture.traces) drawLine(context, points, 1, kind === "before" ? palette.faint : palette.accent, 1.5, kind === "before" ? [4, 3] : [], scales);
    for (const curve of curves) drawCurve(context, curve, picture, scales, isOne(curve, hover?.curve));
    context.restore();
    if (isSeen(picture.time)) vertical(context, x(picture.time), top, floor, palette.accent, 2);
    if (hover && isSeen(hover.frame)) this.drawHover(context, picture, scales, width, height);
    if (picture.empty !== "") {
      context.fillStyle = palette.ink;
      context.textAlign = "center";
      context.fillText(picture.empty, width / 2, height / 2);
    }
  }

  /** The curve nearest to a position in the window, if one is near. */
  near(picture: CurvePicture, clientX: number, clientY: number, reach = reachOfCursor): Curve | null {
    const box = this.canvas.getBoundingClientRect();
    const [atX, atY] = [clientX - box.left, clientY - box.top];
    const { x, y, frameAt } = this.scales(picture, box.height);
    let best: Curve | null = null;
    let least = reach;
    for (const curve of picture.curves) {
      const { points } = curve.channel;
      const [begin, end] = between(points, frameAt(atX - least), frameAt(atX + least));
      for (let k = begin; k < end; ++k) {
        const [from, to] = [points[Math.max(k - 1, 0)], points[k]];
        const away = distance(atX, atY, x(from[0]), y(from[curve.component]), x(to[0]), y(to[curve.component]));
        if (away < least) [least, best] = [away, curve];
      }
    }
    return best;
  }

  private drawGrid(context: CanvasRenderingContext2D, palette: Palette, { x, y, left, right, floor, frames: [first, last], values: [low, high] }: Scales, height: number): void {
    const text = textSize();
    // Beside the curves if there is room, otherwise on them.
    const isBeside = left > 5 * text;
    const step = niceStep(((high - low) * 3 * text) / Math.max(floor - top, 1));
    context.textBaseline = isBeside ? "middle" : "bottom";
    context.textAlign = isBeside ? "right" : "left";
    context.lineWidth = 1;
    for (let k = Math.ceil(low / step); k * step <= high; ++k) {
      context.strokeStyle = k === 0 ? palette.faint : palette.floor;
      context.beginPath();
      context.moveTo(left, Math.round(y(k * step)) + 0.5);
      context.lineTo(right, Math.round(y(k * step)) + 0.5);
      context.stroke();
      context.fillStyle = palette.ink;
      context.fillText(numberText(k * step), isBeside ? left - 8 : left + 2, y(k * step));
    }
    const frames = Math.max(1, niceStep((4.2 * text * (last - first)) / (right - left)));
    context.textBaseline = "alphabetic";
    context.textAlign = "center";
    for (let frame = Math.ceil(first / frames) * frames; frame <= last; frame += frames) context.fillText(String(frame), x(frame), height - 0.45 * text);
  }

  // Draws a dot on each curve, and the value of the one under the cursor.
  private drawHover(context: CanvasRenderingContext2D, picture: CurvePicture, { x, y }: Scales, width: number, height: number): void {
    const { curves, palette } = picture;
    const hover = picture.hover!;
    const at = x(hover.frame);
    for (const curve of curves) {
      const value = valueAt(curve, hover.frame);
      if (value === undefined) continue;
      context.fillStyle = curve.colour;
      context.beginPath();
      context.arc(at, y(value), isOne(curve, hover.curve) ? 4.5 : 3, 0, 2 * Math.PI);
      context.fill();
    }
    const value = hover.curve && valueAt(hover.curve, hover.frame);
    if (!hover.curve || value === null || value === undefined) return;
    const text = textSize();
    const words = `${nameOf(hover.curve)}  ${valueText(value)}`;
    const room = context.measureText(words).width + 12;
    const left = at + 10 + room < width ? at + 10 : at - 10 - room;
    const over = Math.min(Math.max(y(value) - 1.9 * text, 2), height - 3.5 * text);
    context.fillStyle = palette.panel;
    context.strokeStyle = hover.curve.colour;
    context.lineWidth = 1.5;
    context.beginPath();
    context.roundRect(left, over, room, 1.6 * text, 4);
    context.fill();
    context.stroke();
    context.fillStyle = palette.ink;
    context.textAlign = "left";
    context.textBaseline = "middle";
    context.fillText(words, left + 6, over + 0.82 * text);
    context.textBaseline = "alphabetic";
  }
}

/** Whether they are of the same component. */
export const isOne = (curve: Curve, other: Curve | null | undefined) => curve.channel.path === other?.channel.path && curve.component === other.component;

export const nameOf = ({ channel, part }: Curve) => (part === "" ? channel.path : `${channel.path} ${part}`);

function vertical(context: CanvasRenderingContext2D, x: number, from: number, to: number, colour: string, width: number): void {
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.beginPath();
  context.moveTo(x, from);
  context.lineTo(x, to);
  context.stroke();
}

function drawCurve(context: CanvasRenderingContext2D, curve: Curve, { palette, stateOf }: CurvePicture, scales: Scales, isNear: boolean): void {
  const { channel, component, colour } = curve;
  const { x, y, frames: [first, last] } = scales;
  drawLine(context, channel.points, component, colour, isNear ? 3 : 2, curve.dash, scales);
  context.lineWidth = 1;
  context.strokeStyle = palette.faint;
  context.fillStyle = palette.panel;
  const [fewest, most] = between(channel.keys, first, last, ({ at }) => at[0]);
  const isFew = most - fewest <= mostHandles;
  const [begin, end] = between(channel.handles, first, last, ({ key }) => key[0]);
  for (let k = begin; k < end; ++k) {
    const { key, tip } = channel.handles[k];
    const isChosen = stateOf(curve, key[0]) === "selected";
    if (!isFew && !isChosen) continue;
    context.globalAlpha = isChosen ? 1 : 0.55;
    context.beginPath();
    context.moveTo(x(key[0]), y(key[component]));
    context.lineTo(x(tip[0]), y(tip[component]));
    context.stroke();
    context.beginPath();
    context.arc(x(tip[0]), y(tip[component]), 3, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
  }
  context.globalAlpha = 1;
  drawKeys(context, curve, channel.keys.slice(fewest, most), palette, stateOf, scales);
}

// Those of a state at once, which is fast.
function drawKeys(context: CanvasRenderingContext2D, curve: Curve, keys: Channel["keys"], palette: Palette, stateOf: CurvePicture["stateOf"], { x, y }: Scales): void {
  const states = keys.map(({ at }) => stateOf(curve, at[0]));
  const isMany = keys.length > mostDiamonds;
  for (const state of ["plain", "selected", "clash"] as const) {
    context.fillStyle = state === "plain" ? curve.colour : state === "selected" ? palette.accent : palette.pin;
    context.beginPath();
    keys.forEach(({ at }, k) => {
      if (states[k] !== state) return;
      const [left, over] = [x(at[0]), y(at[curve.component])];
      if (isMany) context.fillRect(Math.round(left) - 1, Math.round(over) - 1, 3, 3);
      else addDiamond(context, left, over, state === "plain" ? 5 : 6);
    });
    context.fill();
    if (isMany || state === "plain") continue;
    context.strokeStyle = state === "clash" ? palette.pin : palette.panel;
    context.lineWidth = state === "clash" ? 4 : 1;
    context.stroke();
  }
}

// Where several points fall on a pixel, the line there goes from the least to the most of them.
function drawLine(context: CanvasRenderingContext2D, points: number[][], component: number, colour: string, width: number, dash: number[], { x, y, frames: [first, last], left, right }: Scales): void {
  const [begin, end] = between(points, first, last);
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.setLineDash(dash);
  context.lineJoin = "round";
  context.beginPath();
  if (end - begin < 2 * (right - left)) {
    for (let k = begin; k < end; ++k) context[k === begin ? "moveTo" : "lineTo"](x(points[k][0]), y(points[k][component]));
  } else {
    for (let k = begin; k < end; ) {
      const pixel = Math.round(x(points[k][0]));
      let [least, most] = [Infinity, -Infinity];
      const from = points[k][component];
      let to = from;
      for (; k < end && Math.round(x(points[k][0])) === pixel; ++k) {
        to = points[k][component];
        [least, most] = [Math.min(least, to), Math.max(most, to)];
      }
      for (const value of [from, least, most, to]) context.lineTo(pixel, y(value));
    }
  }
  context.stroke();
  context.setLineDash([]);
}

/** The number of rows, which ascend, whose place is at most `frame`. */
export function after<Row>(rows: Row[], frame: number, placeOf: (row: Row) => number = (row) => (row as number[])[0]): number {
  let [low, high] = [0, rows.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (placeOf(rows[middle]) <= frame) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** The rows from `first` to `last`, and up to two more on each side, as a half-open range. */
function between<Row>(rows: Row[], first: number, last: number, placeOf?: (row: Row) => number): [number, number] {
  return [Math.max(after(rows, first, placeOf) - 2, 0), Math.min(after(rows, last, placeOf) + 2, rows.length)];
}

/** From a point to a line segment. */
function distance(x: number, y: number, ax: number, ay: number, bx: number, by: number): number {
  const [dx, dy] = [bx - ax, by - ay];
  const length = dx * dx + dy * dy;
  const share = length > 0 ? Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / length, 0), 1) : 0;
  return Math.hypot(x - ax - share * dx, y - ay - share * dy);
}

/** The range of values of the curves, keys and handles over these frames, and of what is behind them, with a margin. */
function range(curves: Curve[], traces: Trace[], first: number, last: number): [number, number] {
  let low = Infinity;
  let high = -Infinity;
  const include = (value: number) => {
    if (!Number.isFinite(value)) return;
    low = Math.min(low, value);
    high = Math.max(high, value);
  };
  for (const { channel, component } of curves) {
    extremesOf(channel.points)[component]?.forEach(include);
    for (const { tip } of channel.handles) if (tip[0] >= first && tip[0] <= last) include(tip[component]);
  }
  for (const { points } of traces) for (const [, value] of points) include(value);
  if (low > high) return [0, 1];
  const air = high > low ? 0.08 * (high - low) : Math.max(1, 0.1 * Math.abs(high));
  return [low - air, high + air];
}

const extremes = new WeakMap<number[][], number[][]>();

/** The least and the largest of each column that are finite. */
function extremesOf(points: number[][]): number[][] {
  let known = extremes.get(points);
  if (!known) {
    known = (points[0] ?? []).map(() => [Infinity, -Infinity]);
    for (const point of points) {
      known.forEach((ends, k) => {
        if (!Number.isFinite(point[k])) return;
        ends[0] = Math.min(ends[0], point[k]);
        ends[1] = Math.max(ends[1], point[k]);
      });
    }
    extremes.set(points, known);
  }
  return known;
}

/** At most four digits. */
export function numberText(value: number, digits = 4): string {
  const size = Math.abs(value);
  if (size !== 0 && (size >= Math.max(1e5, 10 ** digits) || size < 1e-3)) return value.toExponential(digits - 3).replace("e+", "e");
  return String(Number(value.toPrecision(digits)));
}

/** At most seven digits. */
export function valueText(value: number): string {
  return String(Number(value.toPrecision(7)));
}
