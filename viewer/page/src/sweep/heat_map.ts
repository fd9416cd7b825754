// A measure over two axes: a cell for each pair of their values.

import { numberText } from "../curve_plot";
import { velocityRamp } from "../ramp";
import type { Palette, ThemeChoice } from "../theme";
import { drawAxes, Plot, type Area, type Mark } from "./plot";
import type { Pointing } from "./pointing";
import { measureRange, type Axis, type Range, type ScaleChoice } from "./scales";
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

const cells = (texts: string[]): Axis => ({
  at: (k) => (k + 0.5) / texts.length,
  ticks: (most) => {
    const every = Math.ceil(texts.length / Math.max(most, 1));
    return texts.map((text, k) => ({ at: (k + 0.5) / texts.length, text })).filter((_, k) => k % every === 0);
  },
});

export class HeatMap extends Plot {
  private area: Area = { left: 0, top: 0, width: 0, height: 0 };
  /** Of each cell: the mean of its takes, and these. */
  private readonly means: Float64Array;
  private readonly rows: number[][];
  private readonly range: Range | null;

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
    const ends = this.range ? `, from ${numberText(this.range.low)} to ${numberText(this.range.high)}` : "";
    this.label = `${spec.measure.name} [${spec.measure.unit}]: ${spec.about}${ends}`;
  }

  protected draw(context: CanvasRenderingContext2D, width: number, height: number, palette: Palette): void {
    const { across, up, xName, yName } = this.spec;
    context.clearRect(0, 0, width, height);
    this.area = drawAxes(context, width, height, cells(across), cells(up), palette, { xName, yName, top: 24, hasGrid: false });
    this.drawScale(context, palette);
    this.means.forEach((mean, cell) => {
      const { left, top, width: w, height: h } = this.cell(cell);
      if (Number.isNaN(mean)) {
        // No take of this cell is done.
        context.strokeStyle = palette.faint;
        context.globalAlpha = 0.5;
        context.beginPath();
        context.moveTo(left + 2, top + h - 2);
        context.lineTo(left + w - 2, top + 2);
        context.stroke();
        context.globalAlpha = 1;
        return;
      }
      context.fillStyle = velocityRamp.cssAt(this.shareOf(mean));
      // Without gaps that would shimmer, and with none wider than a pixel.
      const gap = w > 6 && h > 6 ? 1 : 0;
      context.fillRect(left, top, w - gap, h - gap);
    });
  }

  /** Where a number is in the colours, 0 to 1. */
  private shareOf(value: number): number {
    const { low, high, isLog } = this.range!;
    if (!(high > low)) return 0;
    return isLog ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
  }

  // The colours' scale, above the cells.
  private drawScale(context: CanvasRenderingContext2D, palette: Palette): void {
    if (!this.range) return;
    const { low, high, isLog } = this.range;
    const { left, width } = this.area;
    const [first, last] = [numberText(low), `${numberText(high)}${isLog ? " (log)" : ""}`];
    context.fillStyle = palette.ink;
    context.textBaseline = "middle";
    context.textAlign = "left";
    context.fillText(first, left, 10);
    context.textAlign = "right";
    context.fillText(last, left + width, 10);
    const from = left + context.measureText(first).width + 6;
    const to = left + width - context.measureText(last).width - 6;
    for (let x = Math.round(from); x < to; ++x) {
      context.fillStyle = velocityRamp.cssAt((x - from) / (to - from));
      context.fillRect(x, 6, Math.min(2, to - x), 8); // no seams, since a pixel here is not quite one of the screen
    }
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
    const column = Math.floor(((x - this.area.left) / this.area.width) * across.length);
    const line = Math.floor((1 - (y - this.area.top) / this.area.height) * up.length);
    if (column < 0 || column >= across.length || line < 0 || line >= up.length) return null;
    return this.rows[line * across.length + column][0] ?? null;
  }

  protected textAt(row: number | null): string {
    if (row === null) return "";
    const { x, y } = this.spec.cellOf(row);
    const cell = y * this.spec.across.length + x;
    if (this.rows[cell].length === 1) return this.spec.text(row);
    const mean = this.means[cell];
    return Number.isNaN(mean) ? "" : `${numberText(mean)}, mean of ${this.rows[cell].length}`;
  }

  private cell(index: number): Area {
    const { across, up } = this.spec;
    const [x, y] = [index % across.length, Math.floor(index / across.length)];
    const left = this.area.left + Math.round((x / across.length) * this.area.width);
    const right = this.area.left + Math.round(((x + 1) / across.length) * this.area.width);
    const top = this.area.top + Math.round((1 - (y + 1) / up.length) * this.area.height);
    const bottom = this.area.top + Math.round((1 - y / up.length) * this.area.height);
    return { left, top, width: right - left, height: bottom - top };
  }
}
