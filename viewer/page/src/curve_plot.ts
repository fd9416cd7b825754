// Curves over frames on a canvas: grid, curves with keys and handles, the frame shown, and the
// values at the cursor.

import type { Channel } from "./bake";
import type { FrameAxis } from "./frame_axis";
import type { Palette } from "./theme";
import { diamond, niceStep, prepare, textSize } from "./timeline";

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
}

const top = 10;
const reachOfCursor = 12;
const bottomOf = (text: number) => 1.9 * text;

/** The engine's value at a whole frame: at a jump, the value after it. */
export function valueAt({ channel, component }: Curve, frame: number): number | undefined {
  return channel.points.findLast((point) => point[0] === frame)?.[component];
}

export class CurvePlot {
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly axis: FrameAxis,
  ) {}

  draw(picture: CurvePicture): void {
    const surface = prepare(this.canvas);
    if (!surface) return;
    const { context, width, height } = surface;
    const { curves, palette, first, last, hover } = picture;
    const x = this.xOf();
    const y = this.yOf(picture, height);
    const floor = height - bottomOf(textSize());
    const [left, right] = [x(first), x(Math.max(last, first + 1))];
    context.font = `${textSize()}px system-ui, sans-serif`;
    this.drawGrid(context, picture, height);
    if (hover) vertical(context, x(hover.frame), top, floor, palette.faint, 1);
    context.save();
    context.beginPath();
    context.rect(left - 6, top, right - left + 12, floor - top);
    context.clip();
    for (const curve of curves) drawCurve(context, curve, palette, x, y, curve === hover?.curve);
    context.restore();
    vertical(context, x(picture.time), top, floor, palette.accent, 2);
    if (hover) this.drawHover(context, picture, width, height);
    if (picture.empty !== "") {
      context.fillStyle = palette.ink;
      context.textAlign = "center";
      context.fillText(picture.empty, width / 2, height / 2);
    }
  }

  /** The curve nearest to a position in the window, if one is near. */
  near(picture: CurvePicture, clientX: number, clientY: number): Curve | null {
    const box = this.canvas.getBoundingClientRect();
    const [atX, atY] = [clientX - box.left, clientY - box.top];
    const x = this.xOf();
    const y = this.yOf(picture, box.height);
    let best: Curve | null = null;
    let least = reachOfCursor;
    for (const curve of picture.curves) {
      const { points } = curve.channel;
      for (let k = 0; k < points.length; ++k) {
        const [from, to] = [points[Math.max(k - 1, 0)], points[k]];
        if (x(to[0]) < atX - least || x(from[0]) > atX + least) continue;
        const away = distance(atX, atY, x(from[0]), y(from[curve.component]), x(to[0]), y(to[curve.component]));
        if (away < least) [least, best] = [away, curve];
      }
    }
    return best;
  }

  // Measures the page once for the whole drawing.
  private xOf(): (frame: number) => number {
    const origin = this.axis.x(0, this.canvas);
    const { perFrame } = this.axis;
    return (frame) => origin + frame * perFrame;
  }

  private yOf({ curves, first, last }: CurvePicture, height: number): (value: number) => number {
    const [low, high] = range(curves, first, last);
    const room = height - top - bottomOf(textSize());
    return (value) => top + ((high - value) / (high - low)) * room;
  }

  private drawGrid(context: CanvasRenderingContext2D, { curves, palette, first, last }: CurvePicture, height: number): void {
    const text = textSize();
    const x = this.xOf();
    const [low, high] = range(curves, first, last);
    const room = height - top - bottomOf(text);
    const y = (value: number) => top + ((high - value) / (high - low)) * room;
    const [left, right] = [x(first), x(Math.max(last, first + 1))];
    // Beside the curves if there is room, otherwise on them.
    const isBeside = left > 5 * text;
    const step = niceStep(((high - low) * 3 * text) / Math.max(room, 1));
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
    const frames = Math.max(1, niceStep((4.2 * text) / this.axis.perFrame));
    context.textBaseline = "alphabetic";
    context.textAlign = "center";
    for (let frame = Math.ceil(first / frames) * frames; frame <= last; frame += frames) context.fillText(String(frame), x(frame), height - 0.45 * text);
  }

  // Draws a dot on each curve, and the value of the one under the cursor.
  private drawHover(context: CanvasRenderingContext2D, picture: CurvePicture, width: number, height: number): void {
    const { curves, palette } = picture;
    const hover = picture.hover!;
    const at = this.xOf()(hover.frame);
    const y = this.yOf(picture, height);
    for (const curve of curves) {
      const value = valueAt(curve, hover.frame);
      if (value === undefined) continue;
      context.fillStyle = curve.colour;
      context.beginPath();
      context.arc(at, y(value), curve === hover.curve ? 4.5 : 3, 0, 2 * Math.PI);
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

export const nameOf = ({ channel, part }: Curve) => (part === "" ? channel.path : `${channel.path} ${part}`);

function vertical(context: CanvasRenderingContext2D, x: number, from: number, to: number, colour: string, width: number): void {
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.beginPath();
  context.moveTo(x, from);
  context.lineTo(x, to);
  context.stroke();
}

type Scale = (value: number) => number;

function drawCurve(context: CanvasRenderingContext2D, curve: Curve, palette: Palette, x: Scale, y: Scale, isNear: boolean): void {
  const { channel, component, colour } = curve;
  context.strokeStyle = colour;
  context.lineWidth = isNear ? 3 : 2;
  context.setLineDash(curve.dash);
  context.lineJoin = "round";
  context.beginPath();
  channel.points.forEach((point, k) => context[k === 0 ? "moveTo" : "lineTo"](x(point[0]), y(point[component])));
  context.stroke();
  context.setLineDash([]);
  context.lineWidth = 1;
  context.strokeStyle = palette.faint;
  for (const { key, tip } of channel.handles) {
    context.beginPath();
    context.moveTo(x(key[0]), y(key[component]));
    context.lineTo(x(tip[0]), y(tip[component]));
    context.stroke();
    context.fillStyle = palette.panel;
    context.beginPath();
    context.arc(x(tip[0]), y(tip[component]), 3, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
  }
  context.fillStyle = colour;
  for (const key of channel.keys) {
    diamond(context, x(key.at[0]), y(key.at[component]), 5);
    context.fill();
  }
}

/** From a point to a line segment. */
function distance(x: number, y: number, ax: number, ay: number, bx: number, by: number): number {
  const [dx, dy] = [bx - ax, by - ay];
  const length = dx * dx + dy * dy;
  const share = length > 0 ? Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / length, 0), 1) : 0;
  return Math.hypot(x - ax - share * dx, y - ay - share * dy);
}

/** The range of values of the curves, keys and handles over these frames, with a margin. */
function range(curves: Curve[], first: number, last: number): [number, number] {
  let low = Infinity;
  let high = -Infinity;
  const include = (value: number) => {
    if (!Number.isFinite(value)) return;
    low = Math.min(low, value);
    high = Math.max(high, value);
  };
  for (const { channel, component } of curves) {
    for (const point of channel.points) include(point[component]);
    for (const { tip } of channel.handles) if (tip[0] >= first && tip[0] <= last) include(tip[component]);
  }
  if (low > high) return [0, 1];
  const air = high > low ? 0.08 * (high - low) : Math.max(1, 0.1 * Math.abs(high));
  return [low - air, high + air];
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
