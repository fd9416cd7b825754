// Pictures of takes side by side.

import { make } from "../element";
import type { ThemeChoice } from "../theme";
import type { Pointing } from "./pointing";
import type { Studio } from "./studio";
import type { Sweep, TakeShape } from "./sweep";

export type TileSize = "small" | "medium" | "large";

interface Tile {
  shape: TakeShape;
  element: HTMLButtonElement;
  canvas: HTMLCanvasElement;
}

const mostValues = 3;
/** Degrees for a pixel that the pointer is dragged. */
const turnSpeed = 0.4;

export class ContactSheet {
  /** Called after a drag has turned the camera. */
  onTurn = () => this.redraw();
  private readonly tiles: Tile[];
  private readonly tileOf = new Map<number, Tile>();
  private stale = new Set<Tile>();
  private pending = 0;
  private marked: Tile[] = [];
  private listeners: { isWhole: boolean; tell: () => void }[] = [];

  constructor(
    private readonly place: HTMLElement,
    private readonly sweep: Sweep,
    private readonly studio: Studio,
    private readonly pointing: Pointing,
    themes: ThemeChoice,
  ) {
    this.tiles = sweep.shapes.map((shape) => this.tile(shape));
    this.tiles.forEach((tile) => this.tileOf.set(tile.shape.row, tile));
    place.replaceChildren(...this.tiles.map(({ element }) => element));
    place.classList.toggle("blind", !studio.canDraw);
    new ResizeObserver(() => this.redraw()).observe(place);
    const dress = () => {
      studio.colour(themes.palette);
      this.redraw();
    };
    themes.onChange(dress);
    dress();
    pointing.onChange((row, source) => {
      this.mark(row);
      // Keys go on to takes out of the window; plots and table stay where they are.
      if (source === "keys" && isInWindow(place)) this.tileOf.get(row!)?.element.scrollIntoView({ block: "nearest" });
    });
    this.turnByDragging();
  }

  set size(size: TileSize) {
    this.place.dataset.size = size;
    this.redraw();
  }

  /** Puts the pictures into the order of these rows. */
  order(rows: Uint32Array): void {
    const sorted: HTMLElement[] = [];
    for (const row of rows) {
      const tile = this.tileOf.get(row);
      if (tile) sorted.push(tile.element);
    }
    this.place.replaceChildren(...sorted);
  }

  /** Draws all pictures anew, those in the window first. */
  redraw(): void {
    this.stale = new Set(this.tiles);
    this.request();
  }

  /** Once the pictures in the window are drawn, or all. */
  drawn(isWhole: boolean): Promise<void> {
    return new Promise((tell) => {
      this.listeners.push({ isWhole, tell });
      this.request();
    });
  }

  private tile(shape: TakeShape): Tile {
    const { sweep, pointing } = this;
    const { row, frame } = shape;
    const canvas = make("canvas", { ariaHidden: "true" });
    const head = make("span", { className: "head" }, make("b", {}, String(sweep.takes[row])), make("span", {}, `frame ${frame}`));
    const lines = sweep.captions(row, mostValues).map(([name, value]) => make("span", { className: "line" }, make("span", {}, name), make("b", {}, value)));
    const words = sweep.captions(row, Infinity).map((each) => each.join(" ")).join(", ");
    const ariaLabel = `take ${sweep.takes[row]}, frame ${frame}, ${words}`;
    const element = make("button", { type: "button", className: "tile", ariaLabel, ariaPressed: "false" }, canvas, head, make("span", { className: "values" }, ...lines));
    element.dataset.row = String(row);
    element.addEventListener("pointerenter", () => pointing.point(row, this));
    element.addEventListener("pointerleave", () => pointing.point(null, this));
    element.addEventListener("focus", () => element.matches(":focus-visible") && pointing.point(row, this));
    element.addEventListener("blur", () => pointing.point(null, this));
    element.addEventListener("click", () => pointing.toggle(row, this));
    return { shape, element, canvas };
  }

  private mark(row: number | null): void {
    for (const { element } of this.marked) {
      element.classList.remove("pointed");
      element.setAttribute("aria-pressed", "false");
    }
    this.marked = [];
    for (const one of [row, this.pointing.keptRow]) {
      const tile = one === null ? undefined : this.tileOf.get(one);
      if (!tile) continue;
      tile.element.classList.toggle("pointed", one === row);
      tile.element.setAttribute("aria-pressed", String(one === this.pointing.keptRow));
      this.marked.push(tile);
    }
  }

  private request(): void {
    if (this.pending === 0) this.pending = requestAnimationFrame(() => this.drawSome());
  }

  private drawSome(): void {
    this.pending = 0;
    // All have one width, since they are the cells of one grid.
    const box = this.tiles[0]?.canvas.getBoundingClientRect();
    if (box && box.width > 0) {
      const ratio = Math.min(devicePixelRatio, 2);
      const [width, height] = [Math.round(box.width * ratio), Math.round(box.height * ratio)];
      const end = performance.now() + 40;
      const inWindow = this.tiles.filter(({ element }) => isInWindow(element));
      for (const tile of [...inWindow, ...this.stale]) {
        if (!this.stale.delete(tile)) continue;
        const { canvas, shape } = tile;
        if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
        this.studio.draw(shape, canvas.getContext("2d")!, 0, 0, width, height);
        if (performance.now() > end) break;
      }
      const isDone = inWindow.every((tile) => !this.stale.has(tile));
      if (isDone) this.tell(false);
      if (this.stale.size > 0) {
        this.request();
        return;
      }
    }
    this.tell(false);
    this.tell(true);
  }

  private tell(isWhole: boolean): void {
    const told = this.listeners.filter((each) => each.isWhole === isWhole);
    this.listeners = this.listeners.filter((each) => each.isWhole !== isWhole);
    for (const each of told) each.tell();
  }

  // The camera of all goes along with a drag; a click without one still chooses a take.
  private turnByDragging(): void {
    let last: { x: number; y: number } | null = null;
    let isTurning = false;
    this.place.addEventListener("pointerdown", (event) => {
      if (event.button !== 0 || event.pointerType === "touch") return;
      last = { x: event.clientX, y: event.clientY };
      isTurning = false;
    });
    addEventListener("pointermove", (event) => {
      if (!last) return;
      const [x, y] = [event.clientX - last.x, event.clientY - last.y];
      if (!isTurning && Math.hypot(x, y) < 5) return;
      isTurning = true;
      last = { x: event.clientX, y: event.clientY };
      this.studio.turnBy(-turnSpeed * x, turnSpeed * y);
      this.onTurn();
    });
    for (const end of ["pointerup", "pointercancel"]) {
      addEventListener(end, () => {
        last = null;
        // After the click that the browser may make of it.
        setTimeout(() => (isTurning = false));
      });
    }
    this.place.addEventListener("click", (event) => {
      if (!isTurning) return;
      event.stopPropagation();
      event.preventDefault();
    }, { capture: true });
  }
}

function isInWindow(element: Element): boolean {
  const box = element.getBoundingClientRect();
  return box.bottom > 0 && box.top < innerHeight;
}
