// The table of takes. Only the rows in the window are in the page, however many there are.

import { Changing } from "../changing";
import { make } from "../element";
import type { Pointing } from "./pointing";
import { measureText, textOf, type Sweep } from "./sweep";

export interface Column {
  title: string;
  isNumber: boolean;
  text: (row: number) => string;
  /** What rows are sorted by: a number, NaN last, or else the text. */
  number?: (row: number) => number;
}

const rowHeight = 26; // px, as in style.css
const margin = 12; // rows beyond the window

export function columnsOf(sweep: Sweep): Column[] {
  return [
    { title: "take", isNumber: true, text: (row) => String(sweep.takes[row]), number: (row) => sweep.takes[row] },
    { title: "status", isNumber: false, text: (row) => sweep.stateOf(row) },
    ...sweep.paths.map((path): Column => ({
      title: path.title,
      isNumber: path.numbers !== null,
      text: (row) => textOf(path, row),
      number: path.numbers ? (row) => path.numbers![path.rows[row]] : undefined,
    })),
    ...sweep.measures.map((measure): Column => ({
      title: measure.name,
      isNumber: true,
      text: (row) => measureText(measure, row),
      number: (row) => measure.values[row],
    })),
    { title: "hash", isNumber: false, text: (row) => sweep.hashOf(row) },
    { title: "error", isNumber: false, text: (row) => sweep.errorOf(row) },
  ];
}

/** Tells when it has sorted. */
export class TakeTable extends Changing {
  readonly columns: Column[];
  /** The rows of the sweep in the order of the table. */
  readonly order: Uint32Array;
  sortedBy = 0;
  isDescending = false;
  private readonly body = make("tbody");
  private readonly heads: HTMLTableCellElement[];
  private readonly ranks: Uint32Array;
  private shownFrom = -1;

  constructor(
    private readonly place: HTMLElement,
    sweep: Sweep,
    private readonly pointing: Pointing,
  ) {
    super();
    this.columns = columnsOf(sweep);
    this.order = Uint32Array.from({ length: sweep.rowCount }, (_, row) => row);
    this.ranks = this.order.slice();
    const widths = make("colgroup");
    this.heads = this.columns.map((column, k) => {
      const button = make("button", { type: "button" }, column.title);
      button.addEventListener("click", () => this.sort(k, this.sortedBy === k && !this.isDescending));
      const width = make("col");
      width.style.width = `${widthOf(column, sweep)}ch`;
      widths.append(width);
      return make("th", { scope: "col", className: column.isNumber ? "number" : "" }, button);
    });
    const head = make("thead", {}, make("tr", {}, ...this.heads));
    place.replaceChildren(make("table", { ariaRowCount: String(sweep.rowCount + 1) }, widths, head, this.body));
    place.style.setProperty("--rows", String(Math.min(sweep.rowCount, 18)));
    place.addEventListener("scroll", () => this.show());
    new ResizeObserver(() => this.show(true)).observe(place);
    const rowOf = (event: Event) => {
      const line = (event.target as Element).closest<HTMLElement>("tr[data-row]");
      return line ? Number(line.dataset.row) : null;
    };
    this.body.addEventListener("pointermove", (event) => pointing.point(rowOf(event), this));
    this.body.addEventListener("pointerleave", () => pointing.point(null, this));
    this.body.addEventListener("click", (event) => {
      const row = rowOf(event);
      if (row !== null && getSelection()?.isCollapsed !== false) pointing.toggle(row, this);
    });
    pointing.onChange((row, source) => {
      if (row !== null && source !== this) this.reach(row);
      this.mark();
    });
    this.markSort();
    this.show(true);
  }

  sort(column: number, isDescending: boolean): void {
    [this.sortedBy, this.isDescending] = [column, isDescending];
    const { number, text } = this.columns[column];
    const sign = isDescending ? -1 : 1;
    if (number) {
      const keys = Float64Array.from(this.ranks, (_, row) => number(row));
      this.order.sort((a, b) => {
        const [x, y] = [keys[a], keys[b]];
        if (Number.isNaN(x) || Number.isNaN(y)) return Number(Number.isNaN(x)) - Number(Number.isNaN(y)) || a - b;
        return sign * (x - y) || a - b;
      });
    } else {
      const keys = Array.from(this.ranks, (_, row) => text(row));
      // Rows without a text come last.
      this.order.sort((a, b) => {
        const [x, y] = [keys[a], keys[b]];
        if (x === "" || y === "") return Number(x === "") - Number(y === "") || a - b;
        return (x < y ? -sign : x > y ? sign : 0) || a - b;
      });
    }
    this.order.forEach((row, rank) => (this.ranks[row] = rank));
    this.markSort();
    this.place.scrollTop = 0;
    this.show(true);
    this.tell();
  }

  /** The row `step` further in the order; from none, the first. */
  beside(row: number | null, step: number): number {
    if (row === null) return this.order[0];
    return this.order[Math.min(Math.max(this.ranks[row] + step, 0), this.order.length - 1)];
  }

  private markSort(): void {
    this.heads.forEach((cell, k) => {
      if (this.sortedBy === k) cell.setAttribute("aria-sort", this.isDescending ? "descending" : "ascending");
      else cell.removeAttribute("aria-sort");
    });
  }

  /** Scrolls the table, not the page, to a row. */
  private reach(row: number): void {
    const top = this.ranks[row] * rowHeight;
    const room = this.place.clientHeight - rowHeight - 4; // below the heads
    if (top < this.place.scrollTop) this.place.scrollTop = top;
    else if (top + rowHeight > this.place.scrollTop + room) this.place.scrollTop = top + rowHeight - room;
    this.show();
  }

  private show(isChanged = false): void {
    const first = Math.max(0, Math.floor(this.place.scrollTop / rowHeight) - margin);
    // Some rows at a time, so that scrolling by one does not build all anew.
    const from = first - (first % margin);
    if (from === this.shownFrom && !isChanged) return;
    this.shownFrom = from;
    const to = Math.min(this.order.length, from + Math.ceil(this.place.clientHeight / rowHeight) + 3 * margin);
    const lines: HTMLElement[] = [space(from * rowHeight)];
    for (let rank = from; rank < to; ++rank) lines.push(this.line(rank));
    lines.push(space((this.order.length - to) * rowHeight));
    this.body.replaceChildren(...lines);
    this.mark();
  }

  private line(rank: number): HTMLElement {
    const row = this.order[rank];
    const line = make("tr", { ariaRowIndex: String(rank + 2) });
    line.dataset.row = String(row);
    for (const column of this.columns) {
      const text = column.text(row);
      const cell = make("td", { className: column.title === "status" ? text : column.isNumber ? "number" : "" }, text);
      if (text.length > 12) cell.title = text;
      line.append(cell);
    }
    return line;
  }

  private mark(): void {
    const { row, keptRow } = this.pointing;
    for (const line of this.body.querySelectorAll<HTMLElement>("tr[data-row]")) {
      const own = Number(line.dataset.row);
      line.classList.toggle("pointed", own === row);
      line.classList.toggle("kept", own === keptRow);
    }
  }
}

function space(height: number): HTMLElement {
  const line = make("tr", { ariaHidden: "true" });
  line.style.height = `${height}px`;
  return line;
}

/** The width for a column's texts, from some of its rows. [ch] */
function widthOf(column: Column, sweep: Sweep): number {
  let widest = column.title.length + 2;
  const every = Math.max(1, Math.floor(sweep.rowCount / 200));
  for (let row = 0; row < sweep.rowCount; row += every) widest = Math.max(widest, column.text(row).length);
  return Math.min(widest, column.title === "error" ? 60 : column.title === "hash" ? 33 : 26) + 2.5;
}
