// Numbers as texts, with as many digits as needed.

import { numberText } from "../curve_plot";

/** Digits that tell all float64 numbers apart. */
const mostDigits = 17;

/** More numbers than this are not told apart by their texts: it would need too many digits. */
const mostApart = 1000;

/** Different texts for different numbers, of equal precision: four digits, or as many more as tell them apart. */
export function distinctTexts(numbers: number[]): string[] {
  const count = new Set(numbers).size;
  for (let digits = 4; ; ++digits) {
    const texts = numbers.map((value) => numberText(value, digits));
    if (digits >= mostDigits || count > mostApart || new Set(texts).size >= count) return texts;
  }
}
