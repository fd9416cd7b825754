// Which take is pointed at, in all parts of the page.

import { Changing } from "../changing";

/** Tells the row pointed at, and the part of the page that did it. */
export class Pointing extends Changing<[row: number | null, source: unknown]> {
  private pointed: number | null = null;
  private kept: number | null = null;

  /** The row pointed at, else the one that was kept by a click. */
  get row(): number | null {
    return this.pointed ?? this.kept;
  }

  get keptRow(): number | null {
    return this.kept;
  }

  /** `source`: the part of the page that does it; null row: nothing is pointed at any more. */
  point(row: number | null, source: unknown): void {
    if (row === this.pointed) return;
    this.pointed = row;
    this.tell(this.row, source);
  }

  /** Keeps a row; the same row again: lets it go. */
  toggle(row: number | null, source: unknown): void {
    this.kept = row === this.kept ? null : row;
    this.tell(this.row, source);
  }

  /** Keeps a row wherever the pointer is, for keys; null: none. */
  keep(row: number | null, source: unknown): void {
    this.kept = row;
    this.pointed = null;
    this.tell(this.row, source);
  }
}
