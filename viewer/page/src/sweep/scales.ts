// Axes of plots: linear, logarithmic, or a place for each text.

import type { AxisXOptions, ScaleOptions } from "@observablehq/plot";

import { numberText } from "../curve_plot";
import type { Measure, Path } from "./sweep";

export type ScaleChoice = "auto" | "linear" | "log";

/** An axis of Observable Plot. */
export interface Axis {
  scale: ScaleOptions;
  ticks: Pick<AxisXOptions, "ticks" | "tickFormat">;
}

/** A place for each text, named as far as there is room. */
export function textAxis(texts: string[], most: number): Axis {
  const every = Math.ceil(texts.length / most);
  return {
    scale: { type: "point", domain: [...texts.keys()], padding: 0.5 },
    ticks: { ticks: [...texts.keys()].filter((k) => k % every === 0), tickFormat: (k: number) => texts[k] },
  };
}

/** Whether a logarithm spreads the numbers more evenly: values at equal ratios, or over decades. */
function spreadsByLog(sorted: number[]): boolean {
  if (sorted.length < 3 || !hasOneSign(sorted)) return false;
  const widest = (values: number[]) => {
    let gap = 0;
    for (let k = 1; k < values.length; ++k) gap = Math.max(gap, values[k] - values[k - 1]);
    return gap / (values[values.length - 1] - values[0]);
  };
  const sizes = sorted[0] > 0 ? sorted : sorted.map((value) => -value).reverse();
  return widest(sizes.map(Math.log)) < widest(sizes) / 1.5;
}

/** Whether a logarithmic axis can have all of the numbers. */
const hasOneSign = (sorted: ArrayLike<number>) => sorted[0] > 0 || sorted[sorted.length - 1] < 0;

function numberAxis(low: number, high: number, isLog: boolean, isWhole: boolean): Axis {
  if (isLog && low < high) return { scale: { type: "log", domain: [low, high] }, ticks: { tickFormat: (value: number) => numberText(value) } };
  const room = low < high ? 0 : (Math.abs(low) || 2) / 2;
  return {
    scale: { type: "linear", domain: [low - room, high + room], nice: true },
    ticks: isWhole ? { tickFormat: (value: number) => (Number.isInteger(value) ? String(value) : "") } : {},
  };
}

/** The axis of a path's values; a row is at its number, or that of its text. */
export function pathAxis(path: Path, choice: ScaleChoice): Axis {
  const { numbers, shortTexts } = path;
  if (!numbers) return textAxis(shortTexts, 6);
  const sorted = [...new Set(numbers)].sort((a, b) => a - b);
  const isLog = choice === "log" ? hasOneSign(sorted) : choice === "auto" && spreadsByLog(sorted);
  return numberAxis(sorted[0], sorted[sorted.length - 1], isLog, false);
}

/** Where a row is on the axis of its path. */
export function placeOf(path: Path, row: number): number {
  return path.numbers ? path.numbers[path.rows[row]] : path.rows[row];
}

/** Ends of a measure's values. */
export interface Range {
  low: number;
  high: number;
  /** The scale is logarithmic; zeros are not on it. */
  isLog: boolean;
}

/** The range of the finite values, of those above zero if the scale is logarithmic; null: there is none. */
export function measureRange(values: Float64Array, choice: ScaleChoice, isWhole: boolean): Range | null {
  const sorted = values.filter(Number.isFinite).sort();
  if (sorted.length === 0) return null;
  // A take without any motion, as with a force of 0, must not hide the decades of the others.
  const above = sorted.filter((value) => value > 0);
  const high = sorted[sorted.length - 1];
  // Over decades, but for a few takes.
  const share = (part: number) => above[Math.round(part * (above.length - 1))];
  const isWide = !isWhole && share(0.95) > 100 * share(0.05);
  const isLog = sorted[0] >= 0 && above[0] < high && (choice === "log" || (choice === "auto" && isWide));
  return { low: isLog ? above[0] : sorted[0], high, isLog };
}

/** The axis of a measure; null: it has no value. */
export function measureAxis({ values, isWhole }: Measure, choice: ScaleChoice): Axis | null {
  const range = measureRange(values, choice, isWhole);
  return range && numberAxis(range.low, range.high, range.isLog, isWhole);
}
