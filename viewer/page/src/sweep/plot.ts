// A plot whose marks are takes: a measure over a PATH, or a map over two of them. Observable Plot
// makes scales and axes; what may be a hundred thousand marks is on a canvas below these.

import * as Plot from "@observablehq/plot";

import { make, makeSvg } from "../element";
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

/** What is the same in all plots: their class is that of the style that the page's policy allows. */
export const around = { inset: 6, marginLeft: 52, marginRight: 10, marginTop: 6, marginBottom: 36, className: "takes" } as const;

/** Texts beside a plot, with their middle left out if there is no room: names often differ at the end. */
export const axisLook = { tickSize: 0, labelAnchor: "center", labelArrow: "none", textOverflow: "ellipsis-middle" } as const;

/** Draws when it is seen. The marks of the take pointed at are above the drawing, which stays. */
export abstract class TakePlot {
  readonly element: HTMLElement;
  protected readonly place = make("div", { role: "img" });
  private readonly value = make("b");
  private readonly canvas = make("canvas");
  private readonly marks = makeSvg("svg", { "aria-hidden": "true" });
  private axes: Element | null = null;
  private isStale = true;
  private isSeen = false;

  constructor(
    title: string,
    unit: string,
    about: string,
    protected readonly pointing: Pointing,
    protected readonly themes: ThemeChoice,
  ) {
    const measured = make("small", {}, `[${unit}]`);
    const caption = make("figcaption", { title: `${about} [${unit}]` }, make("span", {}, title), measured, this.value);
    this.element = make("figure", { className: "plot" }, caption, this.place);
    this.label = `${title} [${unit}]: ${about}`;
    // In the processor's memory: a hundred thousand points are no work for graphics.
    this.canvas.getContext("2d", { willReadFrequently: true });
    this.place.append(this.canvas, this.marks);
    this.place.addEventListener("pointermove", (event) => {
      const box = this.place.getBoundingClientRect();
      this.pointing.point(this.rowAt(event.clientX - box.left, event.clientY - box.top), this);
    });
    this.place.addEventListener("pointerleave", () => this.pointing.point(null, this));
    this.place.addEventListener("click", () => this.pointing.row !== null && this.pointing.toggle(this.pointing.row, this));
  }

  protected set label(text: string) {
    this.place.setAttribute("aria-label", text);
  }

  /** Call when it comes into the window or leaves it. */
  see(isSeen: boolean): void {
    this.isSeen = isSeen;
    this.show();
  }

  /** Call after a change of the theme. */
  redraw(): void {
    this.isStale = true;
    this.show();
  }

  /** Draws what has changed, if it is seen. */
  show(): void {
    if (!this.isSeen) return;
    if (this.isStale || !isAsLargeAsSeen(this.canvas)) {
      const place = prepare(this.canvas);
      if (!place) return;
      const axes = Plot.plot({ ...around, width: place.width, height: place.height, ...this.options() });
      this.axes?.remove();
      this.canvas.after((this.axes = axes));
      this.draw(place.context, axes, this.themes.palette);
      this.isStale = false;
    }
    this.mark();
  }

  /** Marks the take pointed at, if it is seen. */
  mark(): void {
    if (!this.isSeen || this.isStale) return;
    const { palette } = this.themes;
    const row = this.pointing.row;
    this.value.textContent = row === null ? "" : this.textAt(row);
    const at = row === null ? null : this.placeAt(row);
    this.marks.replaceChildren(...(at ? this.marksOf(at, palette, row!) : []).flatMap(({ shape, at, colour, width, ground }) =>
      ([[palette.panel, ground], [colour, width]] as const).map(([stroke, wide]) => makeSvg(shape, { ...at, stroke, "stroke-width": wide, fill: "none" }))));
  }

  protected abstract options(): Plot.PlotOptions;
  protected abstract draw(context: CanvasRenderingContext2D, axes: Plot.Plot, palette: Palette): void;
  protected abstract marksOf(at: Area, palette: Palette, row: number): Mark[];
  /** The place of a row's mark, as the last drawing has it. */
  protected abstract placeAt(row: number): Area | null;
  protected abstract rowAt(x: number, y: number): number | null;
  protected abstract textAt(row: number): string;
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
export class Graph extends TakePlot {
  private readonly places: Float32Array;

  constructor(
    private readonly spec: GraphSpec,
    pointing: Pointing,
    themes: ThemeChoice,
  ) {
    super(spec.title, spec.unit, spec.about, pointing, themes);
    this.places = new Float32Array(2 * spec.x.length).fill(NaN);
  }

  protected options(): Plot.PlotOptions {
    const { xAxis, yAxis, over } = this.spec;
    if (!yAxis) return { marks: [Plot.text(["no take is done"], { frameAnchor: "middle" })] };
    return {
      x: xAxis.scale,
      y: yAxis.scale,
      marks: [
        Plot.gridX(xAxis.ticks), Plot.gridY(yAxis.ticks), Plot.frame({ strokeOpacity: 0.25 }),
        Plot.axisX({ ...axisLook, tickSpacing: 46, label: over, ...xAxis.ticks }),
        Plot.axisY({ ...axisLook, tickSpacing: 34, label: null, ...yAxis.ticks, lineWidth: 4 }),
      ],
    };
  }

  protected draw(context: CanvasRenderingContext2D, axes: Plot.Plot, palette: Palette): void {
    const { spec, places } = this;
    if (!spec.yAxis) return;
    const [x, y] = [axes.scale("x")!, axes.scale("y")!];
    let count = 0;
    for (let row = 0; row < spec.x.length; ++row) {
      [places[2 * row], places[2 * row + 1]] = [x.apply(spec.x[row]), y.apply(spec.y[row])];
      if (this.placeAt(row)) ++count;
    }
    context.lineWidth = spec.lines.length > 12 ? 1 : 1.5;
    context.globalAlpha = spec.lines.length > 40 ? 0.4 : spec.lines.length > 12 ? 0.7 : 1;
    context.lineJoin = "round";
    for (const { rows, colour } of spec.lines) {
      context.strokeStyle = colour(palette);
      context.stroke(new Path2D(this.path(rows)));
    }
    context.globalAlpha = count > 20_000 ? 0.2 : count > 2000 ? 0.5 : count > 300 ? 0.8 : 1;
    const radius = count > 2000 ? 1 : count > 300 ? 1.6 : 2.4;
    let last = "";
    for (let row = 0; row < spec.x.length; ++row) {
      const at = this.placeAt(row);
      if (!at) continue;
      const colour = spec.colourOf(row, palette);
      if (colour !== last) context.fillStyle = last = colour; // to set it is slow
      if (count > 2000) {
        context.fillRect(at.left - radius, at.top - radius, 2 * radius, 2 * radius);
        continue;
      }
      context.beginPath();
      context.arc(at.left, at.top, radius, 0, 2 * Math.PI);
      context.fill();
    }
  }

  // A take without a result interrupts the line.
  private path(rows: number[]): string {
    const places = rows.map((row) => this.placeAt(row));
    return places.map((at, k) => (at ? `${places[k - 1] ? "L" : "M"}${at.left} ${at.top}` : "")).join("");
  }

  // The line of the take stands out from others that it crosses.
  protected marksOf({ left, top }: Area, palette: Palette, row: number): Mark[] {
    const marks: Mark[] = [];
    const line = this.spec.lines.length > 1 ? this.spec.lines.find(({ rows }) => rows.includes(row)) : undefined;
    if (line) marks.push({ shape: "path", at: { d: this.path(line.rows) }, colour: line.colour(palette), width: 3, ground: 6 });
    return [...marks, { shape: "circle", at: { cx: left, cy: top, r: 5.5 }, colour: palette.accent, width: 2.5, ground: 5 }];
  }

  protected placeAt(row: number): Area | null {
    const [left, top] = [this.places[2 * row], this.places[2 * row + 1]];
    return Number.isFinite(left) && Number.isFinite(top) ? { left, top, width: 0, height: 0 } : null;
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

  protected textAt(row: number): string {
    return this.spec.text(row);
  }
}
