// The ruler of frames, for scrubbing, with keys as diamonds.

import type { FrameAxis } from "./frame_axis";
import type { Playback } from "./playback";
import type { ThemeChoice } from "./theme";

/** The smallest of 1, 2 or 5 times a power of ten that is at least `least`. */
export function niceStep(least: number): number {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((k) => k * power).find((each) => each >= least * 0.999999)!;
}

/** The size of small text on a canvas: like that of the page, it depends on the window. [px] */
export function textSize(): number {
  return 0.82 * parseFloat(getComputedStyle(document.documentElement).fontSize);
}

/**
 * Gives a canvas the resolution of the screen; returns its size in CSS pixels, or null if it has
 * none. `settings`: of its first context.
 */
export function prepare(canvas: HTMLCanvasElement, settings: CanvasRenderingContext2DSettings = {}): { context: CanvasRenderingContext2D; width: number; height: number } | null {
  const { width, height } = canvas.getBoundingClientRect();
  const context = canvas.getContext("2d", settings);
  if (!context || width === 0 || height === 0) return null;
  const [w, h] = pixelsOf(width, height);
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  // Not the device's ratio: the sizes in the window are not integers.
  context.setTransform(w / width, 0, 0, h / height, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

/** Whether it still has the pixels that `prepare` gave it. */
export function isAsLargeAsSeen(canvas: HTMLCanvasElement): boolean {
  const { width, height } = canvas.getBoundingClientRect();
  const [w, h] = pixelsOf(width, height);
  return canvas.width === w && canvas.height === h;
}

function pixelsOf(width: number, height: number): [number, number] {
  const ratio = devicePixelRatio || 1;
  return [Math.round(width * ratio), Math.round(height * ratio)];
}

export function diamond(context: CanvasRenderingContext2D, x: number, y: number, radius: number): void {
  context.beginPath();
  addDiamond(context, x, y, radius);
}

/** Adds it to the path. */
export function addDiamond(context: CanvasRenderingContext2D, x: number, y: number, radius: number): void {
  context.moveTo(x, y - radius);
  context.lineTo(x + radius, y);
  context.lineTo(x, y + radius);
  context.lineTo(x - radius, y);
  context.closePath();
}

/** A mark that is nearer to the one before it would not be seen. [px] */
const leastGap = 0.5;

const baseHeight = (height: number, text: number) => height - 1.45 * text;
const markHeight = (height: number, text: number) => baseHeight(height, text) - 10 - 0.8 * text;

export class Timeline {
  /** Frames with keys, ascending. */
  keyFrames: number[] = [];
  /** Ranges of frames that are ready, if some may not be. */
  ready: [number, number][] = [];
  /** Frames that are marked. */
  band: [number, number] | null = null;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly playback: Playback,
    private readonly axis: FrameAxis,
    private readonly themes: ThemeChoice,
  ) {
    canvas.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      canvas.setPointerCapture(event.pointerId);
      playback.pause();
      this.scrub(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (canvas.hasPointerCapture(event.pointerId)) this.scrub(event);
    });
    playback.onChange(() => this.draw());
    themes.onChange(() => this.draw());
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** Goes to the key before (-1) or after (1) the frame shown. */
  toKey(way: -1 | 1): void {
    const { frame } = this.playback;
    const inRange = this.keyFrames.filter((key) => key >= this.playback.first && key <= this.playback.last).map(Math.round);
    const key = way < 0 ? inRange.findLast((each) => each < frame) : inRange.find((each) => each > frame);
    if (key === undefined) return;
    this.playback.pause();
    this.playback.goTo(key);
  }

  /** The middle of the mark of a key, from the upper left corner. [CSS px] */
  placeOf(frame: number): { x: number; y: number } {
    const text = textSize();
    return { x: this.axis.x(frame, this.canvas), y: markHeight(this.canvas.clientHeight, text) };
  }

  draw(): void {
    this.describe();
    const surface = prepare(this.canvas);
    if (!surface) return;
    const { context, height } = surface;
    const { palette } = this.themes;
    const { first, last } = this.playback;
    const { perFrame } = this.axis;
    const start = this.axis.x(first, this.canvas);
    const x = (frame: number) => start + (frame - first) * perFrame;
    const text = textSize();
    const base = baseHeight(height, text);

    if (this.band) {
      const [left, right] = [Math.max(this.band[0] - 0.5, first), Math.min(this.band[1] + 0.5, last)].map(x);
      context.fillStyle = palette.pin;
      context.globalAlpha = 0.25;
      context.fillRect(left, 2, Math.max(right - left, 2), base - 2);
      context.globalAlpha = 1;
    }
    context.strokeStyle = palette.faint;
    context.fillStyle = palette.ink;
    context.font = `${text}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.textBaseline = "alphabetic";
    context.lineWidth = 1;
    const labelStep = Math.max(1, niceStep((4.2 * text) / perFrame));
    const tickStep = Math.max(1, niceStep(5 / perFrame));
    context.beginPath();
    for (let frame = Math.ceil(first / tickStep) * tickStep; frame <= last; frame += tickStep) {
      const isLabelled = Math.round(frame / labelStep) * labelStep === frame;
      context.moveTo(Math.round(x(frame)) + 0.5, base);
      context.lineTo(Math.round(x(frame)) + 0.5, base - (isLabelled ? 10 : 5));
    }
    context.moveTo(x(first), base + 0.5);
    context.lineTo(x(Math.max(last, first + 1)), base + 0.5);
    context.stroke();
    context.globalAlpha = 0.75;
    for (let frame = Math.ceil(first / labelStep) * labelStep; frame <= last; frame += labelStep) {
      context.fillText(String(frame), x(frame), height - 3);
    }
    context.globalAlpha = 1;

    context.fillStyle = palette.curves[0];
    let before = -Infinity;
    for (const key of this.keyFrames) {
      if (key < first || key > last || x(key) - before < leastGap) continue;
      before = x(key);
      diamond(context, x(key), markHeight(height, text), 0.41 * text);
      context.fill();
    }
    context.fillStyle = palette.ink;
    for (const [from, to] of this.ready) {
      const [left, right] = [Math.max(from - 0.5, first), Math.min(to + 0.5, last)].map(x);
      context.fillRect(left, base - 0.5, right - left, 2);
    }

    const now = x(this.playback.time);
    context.strokeStyle = context.fillStyle = palette.accent;
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(now, 4);
    context.lineTo(now, base + 2);
    context.stroke();
    context.beginPath();
    context.moveTo(now - 6, 0);
    context.lineTo(now + 6, 0);
    context.lineTo(now, 8);
    context.fill();
  }

  private describe(): void {
    const { frame, first, last, fps } = this.playback;
    const seconds = (frame - first) / fps;
    const isKey = this.keyFrames.some((key) => Math.round(key) === frame);
    this.canvas.setAttribute("aria-valuemin", String(first));
    this.canvas.setAttribute("aria-valuemax", String(last));
    this.canvas.setAttribute("aria-valuenow", String(frame));
    this.canvas.setAttribute("aria-valuetext", `frame ${frame}, ${seconds.toFixed(2)} s${isKey ? ", key" : ""}`);
  }

  private scrub(event: PointerEvent): void {
    this.playback.goTo(this.axis.frameAt(event.clientX));
  }
}
