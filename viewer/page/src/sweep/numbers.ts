// Numbers as texts, with as many digits as needed.

import { numberText } from "../curve_plot";

/** Digits that tell all float64 numbers apart. */
const mostDigits = 17;

/** Numbers as texts of equal precision, four digits or as many more as make them do. */
export function textsThat(numbers: number[], doThey: (texts: string[]) => boolean): string[] {
  for (let digits = 4; ; ++digits) {
    const texts = numbers.map((value) => numberText(value, digits));
    if (digits >= mostDigits || doThey(texts)) return texts;
  }
}

/** More numbers than this are not told apart by their texts: it would need too many digits. */
const mostApart = 1000;

/** Different texts for different numbers, short enough to read at a glance. */
export function distinctTexts(numbers: number[]): string[] {
  const count = new Set(numbers).size;
  return textsThat(numbers, (texts) => count > mostApart || new Set(texts).size >= count);
}
