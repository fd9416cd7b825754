// The plots of all measures: over each PATH, or maps over two axes.

import type { Palette, ThemeChoice } from "../theme";
import { HeatMap } from "./heat_map";
import { Graph, type Joined, type Plot } from "./plot";
import type { Pointing } from "./pointing";
import { measureAxis, pathAxis, placeOf, type ScaleChoice } from "./scales";
import { measureText, shortText, type Path, type Sweep } from "./sweep";

/** What each measure is, for a tooltip; docs/sweeps.md. */
export const aboutMeasures: Record<string, string> = {
  peak: "the largest displacement",
  peakFrame: "the first frame with the largest displacement",
  final: "the largest displacement at the last frame",
  rms: "the root mean square of displacements over frames and vertices",
  speed: "the largest speed of a vertex",
  energy: "the largest kinetic energy per mass",
  settle: "the frame after which nothing moves more than a thousandth of the peak",
};

/** More lines are drawn as points only. */
const mostLines = 300;
/** More cells would be smaller than pixels. */
const mostCells = 200;

export type Kind = "lines" | "map";

export class PlotGrid {
  kind: Kind = "lines";
  valueScale: ScaleChoice = "auto";
  measureScale: ScaleChoice = "auto";
  /** Axes of maps. */
  across = 0;
  up = 1;
  /** Axes that a map can have: they vary one PATH. */
  readonly mapAxes: number[];
  private plots: Plot[] = [];
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
    pointing.onChange(() => this.plots.forEach((plot) => plot.show()));
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
    const parts = isMap ? this.maps() : this.graphs();
    this.plots = parts.filter((part): part is Plot => !(part instanceof HTMLElement));
    this.place.replaceChildren(...parts.map((part) => (part instanceof HTMLElement ? part : part.element)));
    for (const { element } of this.plots) this.seen.observe(element);
  }

  private redraw(): void {
    for (const plot of this.plots) plot.redraw();
    this.place.querySelectorAll<HTMLElement>("[data-curve]").forEach((mark) => {
      mark.style.background = this.themes.palette.curves[Number(mark.dataset.curve)];
    });
  }

  private graphs(): (Plot | HTMLElement)[] {
    const { sweep } = this;
    const columns = sweep.paths.map((path, k) => ({ path, ...this.joined(path, k) }));
    const heads = columns.map(({ path, legend }) => this.head(path, legend));
    const axes = columns.map(({ path }) => pathAxis(path, this.valueScale));
    const places = columns.map(({ path }) => Float64Array.from({ length: sweep.rowCount }, (_, row) => placeOf(path, row)));
    const parts = columns.some(({ lines }) => lines.length > 0) ? "Lines join takes that differ in this value only." : "";
    this.note.textContent = parts;
    this.note.hidden = parts === "";
    const graphs = sweep.measures.flatMap((measure) => {
      const isWhole = measure.name === "peakFrame" || measure.name === "settle";
      const yAxis = measureAxis(measure.values, this.measureScale, isWhole);
      return columns.map(({ path, lines, colourOf }, k) => new Graph({
        title: measure.name,
        about: `${aboutMeasures[measure.name]}, over ${path.title}`,
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
  private head(path: Path, legend: string[]): HTMLElement {
    const head = document.createElement("div");
    head.className = "column";
    const title = document.createElement("b");
    title.textContent = `over ${path.title}`;
    head.append(title);
    legend.forEach((text, k) => {
      const item = document.createElement("span");
      const mark = document.createElement("i");
      mark.dataset.curve = String(k);
      mark.style.background = this.themes.palette.curves[k];
      item.append(mark, text);
      head.append(item);
    });
    return head;
  }

  /** Lines along the axis of a path, coloured by another axis that has few values. */
  private joined(path: Path, column: number): { lines: Joined[]; legend: string[]; colourOf: (row: number, palette: Palette) => string } {
    const { sweep } = this;
    const { axes } = sweep.head;
    const own = axes.findIndex((axis) => axis.paths.length === 1 && axis.paths[0] === column);
    const colours = this.themes.palette.curves.length;
    const other = own < 0 ? -1 : axes.findIndex((axis, k) => k !== own && axis.count > 1 && axis.count <= colours);
    const legend: string[] = [];
    if (other >= 0) {
      for (let row = 0; row < sweep.rowCount; ++row) {
        const step = sweep.stepOf(other, row);
        legend[step] ??= axes[other].paths.map((each) => `${sweep.paths[each].name} ${shortText(sweep.paths[each], row)}`).join(", ");
      }
    }
    const colourOf = (row: number, palette: Palette) => palette.curves[other >= 0 ? sweep.stepOf(other, row) : 0];
    // Texts have no order that a line could follow; and some takes only would leave gaps unseen.
    if (own < 0 || !path.numbers || !sweep.hasAllTakes || sweep.rowCount / axes[own].count > mostLines) return { lines: [], legend, colourOf };
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
    return { lines, legend, colourOf };
  }

  private maps(): Plot[] {
    const { sweep, across, up } = this;
    const { axes } = sweep.head;
    const steps = (axis: number) => {
      const path = sweep.paths[axes[axis].paths[0]];
      const rowOfStep: number[] = [];
      for (let row = 0; row < sweep.rowCount; ++row) rowOfStep[sweep.stepOf(axis, row)] ??= row;
      // In the order of the numbers, as a plot has them.
      const order = Array.from(rowOfStep.keys());
      if (path.numbers) order.sort((a, b) => placeOf(path, rowOfStep[a]) - placeOf(path, rowOfStep[b]));
      const rank: number[] = [];
      order.forEach((step, k) => (rank[step] = k));
      return { texts: order.map((step) => shortText(path, rowOfStep[step])), rank, path };
    };
    const [x, y] = [steps(across), steps(up)];
    const others = sweep.head.takes / (axes[across].count * axes[up].count);
    this.note.hidden = false;
    this.note.textContent = others > 1 ? `Each cell is the mean of its takes that are done, of at most ${others}; across ${x.path.title}, up ${y.path.title}.` : `Across ${x.path.title}, up ${y.path.title}.`;
    return sweep.measures.map((measure) => new HeatMap({
      title: measure.name,
      about: `${aboutMeasures[measure.name]}, across ${x.path.title}, up ${y.path.title}`,
      across: x.texts,
      up: y.texts,
      cellOf: (row) => ({ x: x.rank[sweep.stepOf(across, row)], y: y.rank[sweep.stepOf(up, row)] }),
      values: measure.values,
      text: (row) => measureText(measure, row),
    }, this.pointing, this.themes));
  }
}
