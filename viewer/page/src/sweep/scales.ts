// Axes of plots: linear, logarithmic, or a place for each text.

import { scaleLinear, scaleLog } from "d3-scale";

import { textsThat } from "./numbers";
import type { Measure, Path } from "./sweep";

export type ScaleChoice = "auto" | "linear" | "log";

/** A map from numbers to 0..1, with ticks. */
export interface Axis {
  at(value: number): number;
  ticks(most: number): { at: number; text: string }[];
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
  if (low === high) {
    const room = low === 0 ? 1 : Math.abs(low) / 2;
    [low, high] = [low - room, high + room];
    isLog = false;
  }
  // A margin, so that marks at the ends are whole.
  const margin = 0.04;
  const spread = isLog ? Math.exp(margin * (Math.log(Math.abs(high)) - Math.log(Math.abs(low)))) : 1;
  const inside = (value: number) => Math.sign(low) * Math.min(Math.max(Math.abs(value), Number.MIN_VALUE), Number.MAX_VALUE);
  const scale = isLog
    ? scaleLog().domain([inside(low / spread), inside(high * spread)])
    : scaleLinear().domain([low - margin * (high - low), high + margin * (high - low)]);
  return {
    at: (value) => (isLog && value === 0 ? NaN : scale(value)),
    ticks: (most) => {
      const ticksFor = (wanted: number) => scale.ticks(wanted).filter((value) => !isWhole || Number.isInteger(value));
      let ticks = ticksFor(most);
      // Round numbers stay round with fewer ticks: not every second of 0.5, 1, 1.5.
      for (let wanted = most - 1; wanted > 0 && ticks.length > most && !isLog; --wanted) ticks = ticksFor(wanted);
      for (const leading of isLog ? ["125", "1"] : []) {
        if (ticks.length <= most) break;
        const few = ticks.filter((value) => leading.includes(value.toExponential().replace("-", "")[0]));
        if (few.length >= 2) ticks = few;
      }
      const every = Math.ceil(ticks.length / Math.max(most, 1));
      const few = ticks.filter((_, k) => k % every === 0);
      const texts = tickTexts(few);
      return few.map((value, k) => ({ at: scale(value), text: texts[k] }));
    },
  };
}

/** With as many digits as say where the ticks are; a tick may be off by rounding. */
function tickTexts(ticks: number[]): string[] {
  const size = ticks.reduce((most, tick) => Math.max(most, Math.abs(tick)), 0);
  const step = ticks.length > 1 ? Math.abs(ticks[1] - ticks[0]) : size;
  return textsThat(ticks, (texts) => texts.every((text, k) => Math.abs(Number(text) - ticks[k]) <= Math.max(1e-3 * Math.min(step, Math.abs(ticks[k]) || step), 1e-12 * Math.abs(ticks[k]))));
}

function textAxis(texts: string[]): Axis {
  const at = (k: number) => (k + 0.5) / texts.length;
  return {
    at,
    ticks: (most) => {
      const every = Math.ceil(texts.length / Math.max(most, 1));
      return texts.map((text, k) => ({ at: at(k), text })).filter((_, k) => k % every === 0);
    },
  };
}

/** The axis of a path's values; a row is at its number, or that of its text. */
export function pathAxis(path: Path, choice: ScaleChoice): Axis {
  const { numbers, shortTexts } = path;
  if (!numbers) return textAxis(shortTexts);
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
