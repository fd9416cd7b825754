// A plot on a canvas whose marks are takes: a measure over a PATH, or a map over two of them.

import type { Palette, ThemeChoice } from "../theme";
import { isAsLargeAsSeen, prepare } from "../timeline";
import type { Pointing } from "./pointing";
import type { Axis } from "./scales";

export interface Area {
  left: number;
  top: number;
  width: number;
  height: number;
}

const nearest = 28; // px from a mark to the pointer

/** A mark over a plot: a shape of SVG, its ground in the colour of the panel, and itself. */
export interface Mark {
  shape: "circle" | "path" | "rect";
  at: Record<string, string | number>;
  colour: string;
  /** Width of the line, and of its ground. [px] */
  width: number;
  ground: number;
}

const svg = <K extends keyof SVGElementTagNameMap>(name: K) => document.createElementNS("http://www.w3.org/2000/svg", name);

/** Draws when it is seen. The marks of the take pointed at are above the drawing, which stays. */
export abstract class Plot {
  readonly element = document.createElement("figure");
  protected readonly canvas = document.createElement("canvas");
  private readonly caption = document.createElement("figcaption");
  private readonly value = document.createElement("b");
  private readonly marks = svg("svg");
  private isSeen = false;
  private isStale = true;

  constructor(
    title: string,
    unit: string,
    about: string,
    protected readonly pointing: Pointing,
    protected readonly themes: ThemeChoice,
  ) {
    this.element.className = "plot";
    const name = document.createElement("span");
    name.textContent = title;
    const measured = document.createElement("small");
    measured.textContent = `[${unit}]`;
    this.caption.title = `${about} [${unit}]`;
    this.caption.append(name, measured, this.value);
    this.canvas.setAttribute("role", "img");
    // In the processor's memory: a hundred thousand points are no work for graphics.
    this.canvas.getContext("2d", { willReadFrequently: true });
    this.marks.setAttribute("aria-hidden", "true");
    const both = document.createElement("div");
    both.append(this.canvas, this.marks);
    this.element.append(this.caption, both);
    this.canvas.addEventListener("pointermove", (event) => {
      const box = this.canvas.getBoundingClientRect();
      this.pointing.point(this.rowAt(event.clientX - box.left, event.clientY - box.top), this);
    });
    this.canvas.addEventListener("pointerleave", () => this.pointing.point(null, this));
    this.canvas.addEventListener("click", () => this.pointing.row !== null && this.pointing.toggle(this.pointing.row, this));
  }

  protected set label(text: string) {
    this.canvas.setAttribute("aria-label", text);
  }

  /** Call when it comes into the window or leaves it. */
  see(isSeen: boolean): void {
    this.isSeen = isSeen;
    this.show();
  }

  /** Call after a change of the theme or the size. */
  redraw(): void {
    this.isStale = true;
    this.show();
  }

  /** Draws what has changed, if it is seen. */
  show(): void {
    if (!this.isSeen) return;
    const { palette } = this.themes;
    if (this.isStale || !isAsLargeAsSeen(this.canvas)) {
      const place = prepare(this.canvas);
      if (!place) return;
      this.draw(place.context, place.width, place.height, palette);
      this.isStale = false;
    }
    this.mark();
  }

  /** Marks the take pointed at, if it is seen. */
  mark(): void {
    if (!this.isSeen || this.isStale) return;
    const { palette } = this.themes;
    const row = this.pointing.row;
    this.value.textContent = this.textAt(row);
    const at = row === null ? null : this.placeAt(row);
    this.marks.replaceChildren(...(at ? this.marksOf(at, palette, row!) : []).flatMap(({ shape, at, colour, width, ground }) =>
      ([[palette.panel, ground], [colour, width]] as const).map(([stroke, wide]) => {
        const one = svg(shape);
        for (const [name, value] of Object.entries({ ...at, stroke, "stroke-width": wide, fill: "none" })) one.setAttribute(name, String(value));
        return one;
      })));
  }

  protected abstract draw(context: CanvasRenderingContext2D, width: number, height: number, palette: Palette): void;
  protected abstract marksOf(at: Area, palette: Palette, row: number): Mark[];
  /** The place of a row's mark, as the last drawing has it. */
  protected abstract placeAt(row: number): Area | null;
  protected abstract rowAt(x: number, y: number): number | null;
  protected abstract textAt(row: number | null): string;
}

/** What is around a plot. */
interface Surroundings {
  /** Names of the axes; empty: none. */
  xName: string;
  yName: string;
  /** Pixels above it. */
  top: number;
  hasGrid: boolean;
}

const nameHeight = 15; // px

/** The frame of a plot with the ticks and names of both axes. Returns the area inside. */
export function drawAxes(context: CanvasRenderingContext2D, width: number, height: number, x: Axis, y: Axis, palette: Palette, { xName, yName, top, hasGrid }: Surroundings): Area {
  context.font = "11px system-ui, sans-serif";
  context.fillStyle = palette.ink;
  context.strokeStyle = palette.faint;
  context.lineWidth = 1;
  context.textBaseline = "middle";
  const yTicks = y.ticks(Math.max(2, Math.floor(height / 34)));
  const widest = Math.min(Math.max(0, ...yTicks.map(({ text }) => context.measureText(text).width)), 0.35 * width);
  const area = { left: Math.ceil(widest) + 12 + (yName === "" ? 0 : nameHeight), top, width: 0, height: height - top - 22 - nameHeight };
  area.width = width - area.left - 8;
  context.textAlign = "center";
  context.fillText(cut(context, xName, area.width), area.left + area.width / 2, height - nameHeight / 2);
  context.save();
  context.translate(nameHeight / 2, area.top + area.height / 2);
  context.rotate(-Math.PI / 2);
  context.fillText(cut(context, yName, area.height), 0, 0);
  context.restore();
  for (const { at, text } of yTicks) {
    const place = Math.round(area.top + (1 - at) * area.height) + 0.5;
    line(context, area.left, place, area.left + area.width, place, hasGrid ? 0.25 : 0);
    context.textAlign = "right";
    context.fillText(cut(context, text, widest), area.left - 6, place);
  }
  context.textAlign = "center";
  let end = -Infinity;
  for (const { at, text } of x.ticks(Math.max(2, Math.floor(area.width / 46)))) {
    const place = Math.round(area.left + at * area.width) + 0.5;
    line(context, place, area.top, place, area.top + area.height, hasGrid ? 0.25 : 0);
    const words = cut(context, text, 0.5 * area.width);
    const room = context.measureText(words).width / 2;
    const middle = Math.min(Math.max(place, room + 1), width - room - 1);
    if (middle - room < end + 6) continue;
    end = middle + room;
    context.fillText(words, middle, area.top + area.height + 12);
  }
  context.globalAlpha = 0.6;
  context.strokeRect(area.left + 0.5, area.top + 0.5, area.width, area.height);
  context.globalAlpha = 1;
  return area;
}

function line(context: CanvasRenderingContext2D, x0: number, y0: number, x1: number, y1: number, strength: number): void {
  if (strength === 0) return;
  context.globalAlpha = strength;
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
  context.stroke();
  context.globalAlpha = 1;
}

/** The text, with some of its middle left out if there is no room: names often differ at the end. [px] */
export function cut(context: CanvasRenderingContext2D, text: string, room: number): string {
  if (context.measureText(text).width <= room) return text;
  const letters = [...text];
  const shortened = (count: number) => `${letters.slice(0, Math.ceil(count / 2)).join("")}…${letters.slice(letters.length - Math.floor(count / 2)).join("")}`;
  let count = letters.length - 1;
  while (count > 1 && context.measureText(shortened(count)).width > room) --count;
  return shortened(count);
}

/** Rows that are joined by lines, in one colour. */
export interface Joined {
  rows: number[];
  colour: (palette: Palette) => string;
}

export interface GraphSpec {
  title: string;
  unit: string;
  about: string;
  /** What the axis across is. */
  over: string;
  /** Of each row, in the axes' units; NaN: none. */
  x: Float64Array;
  y: Float64Array;
  xAxis: Axis;
  yAxis: Axis | null;
  /** Rows that no line joins are points only. */
  lines: Joined[];
  colourOf: (row: number, palette: Palette) => string;
  text: (row: number) => string;
}

/** A measure over a PATH. */
export class Graph extends Plot {
  private readonly places: Float32Array;

  constructor(
    private readonly spec: GraphSpec,
    pointing: Pointing,
    themes: ThemeChoice,
  ) {
    super(spec.title, spec.unit, spec.about, pointing, themes);
    this.places = new Float32Array(2 * spec.x.length).fill(NaN);
    this.label = `${spec.title} [${spec.unit}]: ${spec.about}`;
  }

  protected draw(context: CanvasRenderingContext2D, width: number, height: number, palette: Palette): void {
    const { spec, places } = this;
    context.clearRect(0, 0, width, height);
    if (!spec.yAxis) {
      context.font = "12px system-ui, sans-serif";
      context.textAlign = "center";
      context.fillStyle = palette.ink;
      context.fillText("no take is done", width / 2, height / 2);
      return;
    }
    const area = drawAxes(context, width, height, spec.xAxis, spec.yAxis, palette, { xName: spec.over, yName: "", top: 6, hasGrid: true });
    let count = 0;
    for (let row = 0; row < spec.x.length; ++row) {
      places[2 * row] = area.left + spec.xAxis.at(spec.x[row]) * area.width;
      places[2 * row + 1] = area.top + (1 - spec.yAxis.at(spec.y[row])) * area.height;
      if (!Number.isNaN(spec.y[row])) ++count;
    }
    context.lineWidth = spec.lines.length > 12 ? 1 : 1.5;
    context.globalAlpha = spec.lines.length > 40 ? 0.4 : spec.lines.length > 12 ? 0.7 : 1;
    context.lineJoin = "round";
    for (const { rows, colour } of spec.lines) {
      context.strokeStyle = colour(palette);
      context.beginPath();
      this.trace(rows, (x, y) => context.moveTo(x, y), (x, y) => context.lineTo(x, y));
      context.stroke();
    }
    context.globalAlpha = count > 20_000 ? 0.2 : count > 2000 ? 0.5 : count > 300 ? 0.8 : 1;
    let last = "";
    const radius = count > 2000 ? 1 : count > 300 ? 1.6 : 2.4;
    for (let row = 0; row < spec.x.length; ++row) {
      const [x, y] = [places[2 * row], places[2 * row + 1]];
      if (Number.isNaN(x) || Number.isNaN(y)) continue;
      const colour = spec.colourOf(row, palette);
      if (colour !== last) context.fillStyle = last = colour; // to set it is slow
      if (count > 2000) {
        context.fillRect(x - radius, y - radius, 2 * radius, 2 * radius);
        continue;
      }
      context.beginPath();
      context.arc(x, y, radius, 0, 2 * Math.PI);
      context.fill();
    }
    context.globalAlpha = 1;
  }

  private trace(rows: number[], moveTo: (x: number, y: number) => void, lineTo: (x: number, y: number) => void): void {
    let isDown = false; // a take without a result interrupts the line
    for (const row of rows) {
      const [x, y] = [this.places[2 * row], this.places[2 * row + 1]];
      if (Number.isNaN(y)) isDown = false;
      else if (isDown) lineTo(x, y);
      else moveTo(x, y), (isDown = true);
    }
  }

  // The line of the take stands out from others that it crosses.
  protected marksOf({ left, top }: Area, palette: Palette, row: number): Mark[] {
    const marks: Mark[] = [];
    const line = this.spec.lines.length > 1 ? this.spec.lines.find(({ rows }) => rows.includes(row)) : undefined;
    if (line) {
      const words: string[] = [];
      this.trace(line.rows, (x, y) => words.push(`M${x} ${y}`), (x, y) => words.push(`L${x} ${y}`));
      marks.push({ shape: "path", at: { d: words.join("") }, colour: line.colour(palette), width: 3, ground: 6 });
    }
    return [...marks, { shape: "circle", at: { cx: left, cy: top, r: 5.5 }, colour: palette.accent, width: 2.5, ground: 5 }];
  }

  protected placeAt(row: number): Area | null {
    const [left, top] = [this.places[2 * row], this.places[2 * row + 1]];
    return Number.isNaN(left) || Number.isNaN(top) ? null : { left, top, width: 0, height: 0 };
  }

  protected rowAt(x: number, y: number): number | null {
    let best: number | null = null;
    let least = nearest * nearest;
    for (let row = 0; 2 * row < this.places.length; ++row) {
      const away = (this.places[2 * row] - x) ** 2 + (this.places[2 * row + 1] - y) ** 2;
      if (away < least) [best, least] = [row, away];
    }
    return best;
  }

  protected textAt(row: number | null): string {
    return row === null ? "" : this.spec.text(row);
  }
}
