// A measure over two axes: a cell for each pair of their values.

import * as Plot from "@observablehq/plot";

import { numberText } from "../curve_plot";
import { make } from "../element";
import { velocityRamp } from "../ramp";
import type { Palette, ThemeChoice } from "../theme";
import { axisLook, TakePlot, type Area, type Mark } from "./plot";
import type { Pointing } from "./pointing";
import { measureRange, textAxis, type Range, type ScaleChoice } from "./scales";
import type { Measure } from "./sweep";

export interface MapSpec {
  measure: Measure;
  scale: ScaleChoice;
  about: string;
  /** What the axes are. */
  xName: string;
  yName: string;
  /** Cells across and up, and the texts of their values. */
  across: string[];
  up: string[];
  /** The cell of each row. */
  cellOf: (row: number) => { x: number; y: number };
  text: (row: number) => string;
}

const cells = { type: "band", padding: 0, round: true } as const;

export class HeatMap extends TakePlot {
  /** Of each cell: the mean of its takes, and these. */
  private readonly means: Float64Array;
  private readonly rows: number[][];
  private readonly range: Range | null;
  private cell: (index: number) => Area = () => ({ left: 0, top: 0, width: 0, height: 0 });

  constructor(
    private readonly spec: MapSpec,
    pointing: Pointing,
    themes: ThemeChoice,
  ) {
    super(spec.measure.name, spec.measure.unit, spec.about, pointing, themes);
    const count = spec.across.length * spec.up.length;
    this.rows = Array.from({ length: count }, () => []);
    const sums = new Float64Array(count);
    const counts = new Uint32Array(count);
    spec.measure.values.forEach((value, row) => {
      const { x, y } = spec.cellOf(row);
      const cell = y * spec.across.length + x;
      this.rows[cell].push(row);
      if (Number.isNaN(value)) return;
      sums[cell] += value;
      ++counts[cell];
    });
    this.means = sums.map((sum, cell) => sum / counts[cell]);
    this.range = measureRange(this.means, spec.scale, spec.measure.isWhole);
    if (!this.range) return;
    const { low, high, isLog } = this.range;
    const ends = [numberText(low), numberText(high)];
    this.label = `${spec.measure.name} [${spec.measure.unit}]: ${spec.about}, from ${ends.join(" to ")}`;
    const ramp = make("i");
    ramp.style.background = velocityRamp.css();
    this.place.before(make("p", {}, ends[0], ramp, ends[1], isLog ? " (log)" : ""));
  }

  protected options(): Plot.PlotOptions {
    const { across, up, xName, yName } = this.spec;
    const [x, y] = [textAxis(across, 4), textAxis(up, 4)];
    return {
      inset: 0,
      marginLeft: 68,
      x: { ...x.scale, ...cells },
      y: { ...y.scale, ...cells, reverse: true },
      marks: [Plot.axisX({ ...axisLook, ...x.ticks, label: xName }), Plot.axisY({ ...axisLook, ...y.ticks, label: yName, lineWidth: 4 }), Plot.frame({ strokeOpacity: 0.25 })],
    };
  }

  protected draw(context: CanvasRenderingContext2D, axes: Plot.Plot, palette: Palette): void {
    const [x, y] = [axes.scale("x")!, axes.scale("y")!];
    const { length } = this.spec.across;
    this.cell = (index) => ({ left: x.apply(index % length), top: y.apply(Math.floor(index / length)), width: x.bandwidth!, height: y.bandwidth! });
    context.strokeStyle = palette.faint;
    this.means.forEach((mean, cell) => {
      const { left, top, width, height } = this.cell(cell);
      if (Number.isNaN(mean)) {
        // No take of this cell is done.
        context.stroke(new Path2D(`M${left + 2} ${top + height - 2}L${left + width - 2} ${top + 2}`));
        return;
      }
      context.fillStyle = velocityRamp.cssAt(this.shareOf(mean));
      // Without gaps that would shimmer, and with none wider than a pixel.
      const gap = width > 6 && height > 6 ? 1 : 0;
      context.fillRect(left, top, width - gap, height - gap);
    });
  }

  /** Where a number is in the colours, 0 to 1. */
  private shareOf(value: number): number {
    const { low, high, isLog } = this.range!;
    if (!(high > low)) return 0;
    return isLog ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
  }

  protected marksOf({ left, top, width, height }: Area, palette: Palette): Mark[] {
    return [{ shape: "rect", at: { x: left, y: top, width, height }, colour: palette.accent, width: 2, ground: 4 }];
  }

  protected placeAt(row: number): Area {
    const { x, y } = this.spec.cellOf(row);
    return this.cell(y * this.spec.across.length + x);
  }

  /** The first take of the cell there. */
  protected rowAt(x: number, y: number): number | null {
    const { across, up } = this.spec;
    const { left, top, width, height } = this.cell(0);
    const [column, line] = [Math.floor((x - left) / width), Math.floor((top + height - y) / height)];
    if (column < 0 || column >= across.length || line < 0 || line >= up.length) return null;
    return this.rows[line * across.length + column][0] ?? null;
  }

  protected textAt(row: number): string {
    const { x, y } = this.spec.cellOf(row);
    const cell = y * this.spec.across.length + x;
    if (this.rows[cell].length === 1) return this.spec.text(row);
    const mean = this.means[cell];
    return Number.isNaN(mean) ? "" : `${numberText(mean)}, mean of ${this.rows[cell].length}`;
  }
}
