// A measure over two axes: a cell for each pair of their values.

import { numberText } from "../curve_plot";
import { velocityRamp } from "../ramp";
import type { Palette, ThemeChoice } from "../theme";
import { drawAxes, Plot, type Area } from "./plot";
import type { Pointing } from "./pointing";
import type { Axis } from "./scales";

export interface MapSpec {
  title: string;
  about: string;
  /** Cells across and up, and the texts of their values. */
  across: string[];
  up: string[];
  /** The cell of each row. */
  cellOf: (row: number) => { x: number; y: number };
  /** Of each row; NaN: none. */
  values: Float64Array;
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
  private readonly low: number;
  private readonly high: number;

  constructor(
    private readonly spec: MapSpec,
    pointing: Pointing,
    themes: ThemeChoice,
  ) {
    super(spec.title, spec.about, pointing, themes);
    const count = spec.across.length * spec.up.length;
    this.rows = Array.from({ length: count }, () => []);
    const sums = new Float64Array(count);
    const counts = new Uint32Array(count);
    spec.values.forEach((value, row) => {
      const { x, y } = spec.cellOf(row);
      const cell = y * spec.across.length + x;
      this.rows[cell].push(row);
      if (Number.isNaN(value)) return;
      sums[cell] += value;
      ++counts[cell];
    });
    this.means = sums.map((sum, cell) => sum / counts[cell]);
    const known = this.means.filter((mean) => !Number.isNaN(mean));
    this.low = known.reduce((a, b) => Math.min(a, b), Infinity);
    this.high = known.reduce((a, b) => Math.max(a, b), -Infinity);
    this.label = `${spec.title}: ${spec.about}, from ${numberText(this.low)} to ${numberText(this.high)}`;
  }

  protected draw(context: CanvasRenderingContext2D, width: number, height: number, palette: Palette): void {
    const { across, up } = this.spec;
    context.clearRect(0, 0, width, height);
    this.area = drawAxes(context, width, height, cells(across), cells(up), palette, false);
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
      context.fillStyle = velocityRamp.cssAt(this.high > this.low ? (mean - this.low) / (this.high - this.low) : 0);
      // Without gaps that would shimmer, and with none wider than a pixel.
      const gap = w > 6 && h > 6 ? 1 : 0;
      context.fillRect(left, top, w - gap, h - gap);
    });
  }

  protected drawMark(context: CanvasRenderingContext2D, { left, top, width, height }: Area, palette: Palette): void {
    for (const [colour, line] of [[palette.panel, 4], [palette.accent, 2]] as const) {
      context.strokeStyle = colour;
      context.lineWidth = line;
      context.strokeRect(left, top, width, height);
    }
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
    if (row === null) return Number.isFinite(this.low) ? `${numberText(this.low)} … ${numberText(this.high)}` : "";
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
