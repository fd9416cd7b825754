// The plots of all measures: over each PATH, or maps over two axes.

import { make } from "../element";
import { velocityRamp } from "../ramp";
import type { Palette, ThemeChoice } from "../theme";
import { HeatMap } from "./heat_map";
import { Graph, type Joined, type TakePlot } from "./plot";
import type { Pointing } from "./pointing";
import { measureAxis, measureRange, pathAxis, placeOf, type ScaleChoice } from "./scales";
import { measureText, shortText, type Path, type Sweep } from "./sweep";

/** More lines are drawn as points only. */
const mostLines = 300;
/** More cells would be smaller than pixels. */
const mostCells = 200;

export type Kind = "lines" | "map";

/** The colours of an axis's values. */
interface Colours {
  /** They are a ramp for many numbers. */
  isRamp: boolean;
  /** The path, if it is one. */
  name: string;
  /** The values with their names, in the order of the colours. */
  texts: string[];
  of: (palette: Palette) => string[];
}

export class PlotGrid {
  kind: Kind = "lines";
  valueScale: ScaleChoice = "auto";
  measureScale: ScaleChoice = "auto";
  /** Axes of maps. */
  across = 0;
  up = 1;
  /** Axes that a map can have: they vary one PATH. */
  readonly mapAxes: number[];
  private plots: TakePlot[] = [];
  /** Colour the legends. */
  private legends: ((palette: Palette) => void)[] = [];
  private readonly seen: IntersectionObserver;

  constructor(
    private readonly place: HTMLElement,
    private readonly note: HTMLElement,
    private readonly sweep: Sweep,
    private readonly pointing: Pointing,
    private readonly themes: ThemeChoice,
  ) {
    const { axes } = sweep.head;
    this.mapAxes = axes.map((_, k) => k).filter((k) => axes[k].paths.length === 1 && axes[k].count > 1 && axes[k].count <= mostCells);
    if (this.mapAxes.length >= 2) [this.up, this.across] = this.mapAxes.slice(-2);
    const byElement = (element: Element) => this.plots.find((plot) => plot.element === element);
    this.seen = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) byElement(target)?.see(isIntersecting);
    }, { root: place.closest(".flow"), rootMargin: "300px" });
    themes.onChange(() => this.redraw());
    pointing.onChange(() => this.plots.forEach((plot) => plot.mark()));
    // A plot draws anew if its own size has changed.
    new ResizeObserver(() => this.plots.forEach((plot) => plot.show())).observe(place);
  }

  get hasMaps(): boolean {
    return this.mapAxes.length >= 2;
  }

  /** Makes all plots anew. */
  build(): void {
    this.seen.disconnect();
    const isMap = this.kind === "map" && this.hasMaps;
    this.place.classList.toggle("wraps", isMap || this.sweep.paths.length === 1);
    this.place.style.setProperty("--columns", String(this.sweep.paths.length));
    this.legends = [];
    const parts = isMap ? this.maps() : this.graphs();
    this.plots = parts.filter((part): part is TakePlot => !(part instanceof HTMLElement));
    this.place.replaceChildren(...parts.map((part) => (part instanceof HTMLElement ? part : part.element)));
    for (const { element } of this.plots) this.seen.observe(element);
  }

  private redraw(): void {
    for (const plot of this.plots) plot.redraw();
    for (const dress of this.legends) dress(this.themes.palette);
  }

  private graphs(): (TakePlot | HTMLElement)[] {
    const { sweep } = this;
    const columns = sweep.paths.map((path, k) => ({ path, ...this.joined(path, k) }));
    const heads = columns.map(({ path, colours }) => this.head(path, colours));
    const axes = columns.map(({ path }) => pathAxis(path, this.valueScale));
    const places = columns.map(({ path }) => Float64Array.from({ length: sweep.rowCount }, (_, row) => placeOf(path, row)));
    const notes = columns.some(({ lines }) => lines.length > 0) ? ["Lines join takes that differ in this value only."] : [];
    if (sweep.measures.some(({ values, isWhole }) => measureRange(values, this.measureScale, isWhole)?.isLog && values.includes(0))) notes.push("Logarithmic axes have no place for zeros.");
    this.note.textContent = notes.join(" ");
    this.note.hidden = notes.length === 0;
    const graphs = sweep.measures.flatMap((measure) => {
      const yAxis = measureAxis(measure, this.measureScale);
      return columns.map(({ path, lines, colourOf }, k) => new Graph({
        title: measure.name,
        unit: measure.unit,
        about: `${measure.about}, over ${path.title}`,
        over: path.title,
        x: places[k],
        y: measure.values,
        xAxis: axes[k],
        yAxis,
        lines,
        colourOf,
        text: (row) => measureText(measure, row),
      }, this.pointing, this.themes));
    });
    return [...heads, ...graphs];
  }

  /** The title of a column, and what its colours mean. */
  private head(path: Path, colours: Colours): HTMLElement {
    const head = make("div", { className: "column" }, make("b", {}, `over ${path.title}`));
    const { texts } = colours;
    // Many values have a ramp between the names of the first and the last.
    const items = colours.isRamp ? [texts.length - 1] : [...texts.keys()];
    for (const step of items) {
      const mark = make("i", { className: colours.isRamp ? "wide" : "" });
      const dress = (palette: Palette) => {
        const shades = colours.of(palette);
        mark.style.background = colours.isRamp ? `linear-gradient(to right, ${shades.join(", ")})` : shades[step];
      };
      dress(this.themes.palette);
      this.legends.push(dress);
      head.append(make("span", {}, ...(colours.isRamp ? [texts[0], mark, texts[step].slice(colours.name.length)] : [mark, texts[step]])));
    }
    return head;
  }

  /** What colours lines along the axis `own`: another axis, one with few values or else with numbers. */
  private coloursFor(own: number): Colours & { rankOf: (row: number) => number } {
    const { sweep } = this;
    const { axes } = sweep.head;
    const most = this.themes.palette.curves.length;
    const others = own < 0 ? [] : axes.map((_, k) => k).filter((k) => k !== own && axes[k].count > 1);
    const pathOf = (axis: number) => (axes[axis].paths.length === 1 ? sweep.paths[axes[axis].paths[0]] : null);
    const other = others.find((k) => axes[k].count <= most) ?? others.find((k) => axes[k].count <= mostLines && pathOf(k)?.numbers);
    if (other === undefined) return { isRamp: false, name: "", texts: [], of: (palette) => palette.curves, rankOf: () => 0 };
    const { rank, rows } = this.steps(other);
    const texts = rows.map((row) => axes[other].paths.map((each) => `${sweep.paths[each].name} ${shortText(sweep.paths[each], row)}`).join(", "));
    const isRamp = axes[other].count > most;
    const shades = new Map<Palette, string[]>();
    const of = (palette: Palette) => {
      if (!isRamp) return palette.curves;
      const [from, to] = palette.shades;
      const there = shades.get(palette) ?? texts.map((_, k) => velocityRamp.cssAt(from + ((to - from) * k) / (texts.length - 1)));
      shades.set(palette, there);
      return there;
    };
    return { isRamp, name: pathOf(other)?.name ?? "", texts, of, rankOf: (row) => rank[sweep.stepOf(other, row)] };
  }

  /** The steps of an axis, in the order of the numbers if it varies one path of these: the rank of each, and a row of each rank. */
  private steps(axis: number): { rank: number[]; rows: number[] } {
    const { sweep } = this;
    const { paths } = sweep.head.axes[axis];
    const path = sweep.paths[paths[0]];
    const rowOfStep: number[] = [];
    for (let row = 0; row < sweep.rowCount; ++row) rowOfStep[sweep.stepOf(axis, row)] ??= row;
    const order = Array.from(rowOfStep.keys()).filter((step) => rowOfStep[step] !== undefined);
    if (paths.length === 1 && path.numbers) order.sort((a, b) => placeOf(path, rowOfStep[a]) - placeOf(path, rowOfStep[b]));
    const rank: number[] = [];
    order.forEach((step, k) => (rank[step] = k));
    return { rank, rows: order.map((step) => rowOfStep[step]) };
  }

  /** Lines along the axis of a path, coloured by another axis. */
  private joined(path: Path, column: number): { lines: Joined[]; colours: Colours; colourOf: (row: number, palette: Palette) => string } {
    const { sweep } = this;
    const { axes } = sweep.head;
    const own = axes.findIndex((axis) => axis.paths.length === 1 && axis.paths[0] === column);
    const colours = this.coloursFor(own);
    const colourOf = (row: number, palette: Palette) => colours.of(palette)[colours.rankOf(row)];
    // Texts have no order that a line could follow; and some takes only would leave gaps unseen.
    if (own < 0 || !path.numbers || !sweep.hasAllTakes || sweep.rowCount / axes[own].count > mostLines) return { lines: [], colours, colourOf };
    const stride = axes.slice(own + 1).reduce((product, axis) => product * axis.count, 1);
    const groups = new Map<number, number[]>();
    for (let row = 0; row < sweep.rowCount; ++row) {
      const key = sweep.takes[row] - stride * sweep.stepOf(own, row);
      const rows = groups.get(key);
      if (rows) rows.push(row);
      else groups.set(key, [row]);
    }
    const lines = [...groups.values()].map((rows): Joined => ({
      rows: rows.sort((a, b) => placeOf(path, a) - placeOf(path, b)),
      colour: (palette) => colourOf(rows[0], palette),
    }));
    return { lines, colours, colourOf };
  }

  private maps(): TakePlot[] {
    const { sweep, across, up } = this;
    const { axes } = sweep.head;
    const stepsOf = (axis: number) => {
      const path = sweep.paths[axes[axis].paths[0]];
      const { rank, rows } = this.steps(axis);
      return { texts: rows.map((row) => shortText(path, row)), rank, path };
    };
    const [x, y] = [stepsOf(across), stepsOf(up)];
    const others = sweep.head.takes / (axes[across].count * axes[up].count);
    this.note.hidden = false;
    this.note.textContent = others > 1 ? `Each cell is the mean of its takes that are done, of at most ${others}; across ${x.path.title}, up ${y.path.title}.` : `Across ${x.path.title}, up ${y.path.title}.`;
    return sweep.measures.map((measure) => new HeatMap({
      measure,
      scale: this.measureScale,
      about: `${measure.about}, across ${x.path.title}, up ${y.path.title}`,
      xName: x.path.title,
      yName: y.path.title,
      across: x.texts,
      up: y.texts,
      cellOf: (row) => ({ x: x.rank[sweep.stepOf(across, row)], y: y.rank[sweep.stepOf(up, row)] }),
      text: (row) => measureText(measure, row),
    }, this.pointing, this.themes));
  }
}
