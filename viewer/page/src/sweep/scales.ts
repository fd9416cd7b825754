// Axes of plots: linear, logarithmic, or a place for each text.

import { scaleLinear, scaleLog } from "d3-scale";

import { numberText } from "../curve_plot";
import type { Path } from "./sweep";

export type ScaleChoice = "auto" | "linear" | "log";

/** A map from numbers to 0..1, with ticks. */
export interface Axis {
  at(value: number): number;
  ticks(most: number): { at: number; text: string }[];
}

/** Whether a logarithm spreads the numbers more evenly: values at equal ratios, or over decades. */
function spreadsByLog(sorted: number[]): boolean {
  if (sorted.length < 3 || sorted[0] <= 0) return false;
  const widest = (values: number[]) => {
    let gap = 0;
    for (let k = 1; k < values.length; ++k) gap = Math.max(gap, values[k] - values[k - 1]);
    return gap / (values[values.length - 1] - values[0]);
  };
  return widest(sorted.map(Math.log)) < widest(sorted) / 1.5;
}

function numberAxis(low: number, high: number, isLog: boolean, isWhole: boolean): Axis {
  if (low === high) {
    const room = low === 0 ? 1 : Math.abs(low) / 2;
    [low, high] = [low - room, high + room];
    isLog = false;
  }
  // A margin, so that marks at the ends are whole.
  const margin = 0.04;
  const scale = isLog
    ? scaleLog().domain([low * (low / high) ** margin, high * (high / low) ** margin])
    : scaleLinear().domain([low - margin * (high - low), high + margin * (high - low)]);
  return {
    at: (value) => scale(value),
    ticks: (most) => {
      let ticks = scale.ticks(most).filter((value) => !isWhole || Number.isInteger(value));
      for (const leading of isLog ? ["125", "1"] : []) {
        if (ticks.length <= most) break;
        const few = ticks.filter((value) => leading.includes(value.toExponential()[0]));
        if (few.length >= 2) ticks = few;
      }
      const every = Math.ceil(ticks.length / Math.max(most, 1));
      return ticks.filter((_, k) => k % every === 0).map((value) => ({ at: scale(value), text: numberText(value) }));
    },
  };
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
  const isLog = choice === "log" ? sorted[0] > 0 : choice === "auto" && spreadsByLog(sorted);
  return numberAxis(sorted[0], sorted[sorted.length - 1], isLog, false);
}

/** Where a row is on the axis of its path. */
export function placeOf(path: Path, row: number): number {
  return path.numbers ? path.numbers[path.rows[row]] : path.rows[row];
}

/** The axis of a measure: of the finite numbers among the values; null: there is none. */
export function measureAxis(values: Float64Array, choice: ScaleChoice, isWhole: boolean): Axis | null {
  const sorted = values.filter(Number.isFinite).sort();
  if (sorted.length === 0) return null;
  const [low, high] = [sorted[0], sorted[sorted.length - 1]];
  // Over decades, but for a few takes.
  const share = (part: number) => sorted[Math.round(part * (sorted.length - 1))];
  const isWide = !isWhole && share(0.95) > 100 * share(0.05);
  return numberAxis(low, high, low > 0 && (choice === "log" || (choice === "auto" && isWide)), isWhole);
}
