// The curve panel: the channels that have keys, as curves with keys and handles.

import type { Channel } from "./bake";
import type { Playback } from "./playback";
import type { ThemeChoice } from "./theme";
import { diamond, niceStep, prepare, textSize } from "./timeline";

const names = ["x", "y", "z"];
const [right, top] = [16, 10];
const leftOf = (text: number) => 5.2 * text;
const bottomOf = (text: number) => 1.9 * text;

export class CurvePanel {
  private channels: Channel[] = [];
  private readonly chosen = new Set<string>();
  private anchor = 0;

  constructor(
    private readonly list: HTMLElement,
    private readonly canvas: HTMLCanvasElement,
    private readonly playback: Playback,
    private readonly themes: ThemeChoice,
  ) {
    playback.onChange(() => this.draw());
    themes.onChange(() => this.fillList());
    new ResizeObserver(() => this.draw()).observe(canvas);
    list.addEventListener("keydown", (event) => this.onKey(event));
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      playback.pause();
      this.scrub(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (canvas.hasPointerCapture(event.pointerId)) this.scrub(event);
    });
  }

  load(channels: Channel[]): void {
    this.channels = channels;
    const paths = new Set(channels.map((channel) => channel.path));
    for (const path of [...this.chosen]) if (!paths.has(path)) this.chosen.delete(path);
    if (this.chosen.size === 0 && channels.length > 0) this.chosen.add(channels[0].path);
    this.fillList();
  }

  draw(): void {
    const surface = prepare(this.canvas);
    if (!surface) return;
    const { context, width, height } = surface;
    const shown = this.channels.filter((channel) => this.chosen.has(channel.path));
    const { palette } = this.themes;
    const { first, last } = this.playback;
    const text = textSize();
    const [left, bottom] = [leftOf(text), bottomOf(text)];
    const [low, high] = range(shown, first, last);
    const x = (frame: number) => left + ((frame - first) / Math.max(last - first, 1)) * (width - left - right);
    const y = (value: number) => height - bottom - ((value - low) / (high - low)) * (height - top - bottom);

    context.font = `${text}px system-ui, sans-serif`;
    this.drawGrid(context, { x, y, low, high, width, height });
    context.save();
    context.beginPath();
    context.rect(left, top, width - left - right, height - top - bottom);
    context.clip();
    shown.forEach((channel, place) => this.drawChannel(context, channel, x, y, place));
    context.restore();

    context.strokeStyle = palette.accent;
    context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(x(this.playback.time), top);
    context.lineTo(x(this.playback.time), height - bottom);
    context.stroke();
    if (this.channels.length === 0) {
      context.fillStyle = palette.faint;
      context.textAlign = "center";
      context.fillText("No channel of this scene has keys.", width / 2, height / 2);
    }
    const described = shown.map((channel) => `${channel.path}, ${channel.keys.length} keys`);
    this.canvas.setAttribute("aria-label", described.length > 0 ? `Curves: ${described.join("; ")}` : "No curve chosen");
  }

  private drawGrid(context: CanvasRenderingContext2D, plot: { x: (f: number) => number; y: (v: number) => number; low: number; high: number; width: number; height: number }): void {
    const { x, y, low, high, width, height } = plot;
    const { palette } = this.themes;
    const { first, last } = this.playback;
    const text = textSize();
    const [left, bottom] = [leftOf(text), bottomOf(text)];
    const step = niceStep(((high - low) * 3 * text) / Math.max(height - top - bottom, 1));
    context.textBaseline = "middle";
    context.textAlign = "right";
    context.lineWidth = 1;
    for (let k = Math.ceil(low / step); k * step <= high; ++k) {
      context.strokeStyle = k === 0 ? palette.faint : palette.floor;
      context.beginPath();
      context.moveTo(left, Math.round(y(k * step)) + 0.5);
      context.lineTo(width - right, Math.round(y(k * step)) + 0.5);
      context.stroke();
      context.fillStyle = palette.ink;
      context.fillText(numberText(k * step), left - 6, y(k * step));
    }
    const frames = Math.max(1, niceStep((4.2 * text * Math.max(last - first, 1)) / (width - left - right)));
    context.textBaseline = "alphabetic";
    context.textAlign = "center";
    for (let frame = Math.ceil(first / frames) * frames; frame <= last; frame += frames) context.fillText(String(frame), x(frame), height - 0.45 * text);
  }

  private drawChannel(context: CanvasRenderingContext2D, channel: Channel, x: (f: number) => number, y: (v: number) => number, place: number): void {
    const { palette } = this.themes;
    for (let component = 1; component <= channel.components; ++component) {
      const colour = palette.curves[channel.components === 1 ? 0 : component - 1];
      context.strokeStyle = colour;
      context.lineWidth = 2;
      context.setLineDash([[], [6, 3], [2, 3], [8, 3, 2, 3]][place % 4]);
      context.lineJoin = "round";
      context.beginPath();
      channel.points.forEach((point, k) => context[k === 0 ? "moveTo" : "lineTo"](x(point[0]), y(point[component])));
      context.stroke();
      context.setLineDash([]);
      context.lineWidth = 1;
      context.strokeStyle = palette.faint;
      for (const { key, tip } of channel.handles) {
        context.beginPath();
        context.moveTo(x(key[0]), y(key[component]));
        context.lineTo(x(tip[0]), y(tip[component]));
        context.stroke();
        context.fillStyle = palette.panel;
        context.beginPath();
        context.arc(x(tip[0]), y(tip[component]), 3, 0, 2 * Math.PI);
        context.fill();
        context.stroke();
      }
      context.fillStyle = colour;
      for (const key of channel.keys) {
        diamond(context, x(key.at[0]), y(key.at[component]), 5);
        context.fill();
      }
    }
  }

  private fillList(): void {
    this.list.replaceChildren(
      ...this.channels.map((channel, k) => {
        const option = document.createElement("div");
        option.setAttribute("role", "option");
        option.id = `channel-${k}`;
        option.setAttribute("aria-selected", String(this.chosen.has(channel.path)));
        const swatches = Array.from({ length: channel.components }, (_, c) => {
          const swatch = document.createElement("i");
          swatch.style.background = this.themes.palette.curves[c];
          swatch.title = channel.components === 1 ? "" : names[c];
          return swatch;
        });
        const label = document.createElement("span");
        label.textContent = channel.path;
        option.append(label, ...swatches);
        option.addEventListener("click", (event) => this.choose(k, event.ctrlKey || event.metaKey || event.shiftKey));
        return option;
      }),
    );
    this.draw();
  }

  private choose(k: number, isAdded: boolean): void {
    const { path } = this.channels[k];
    if (!isAdded) this.chosen.clear();
    if (isAdded && this.chosen.has(path) && this.chosen.size > 1) this.chosen.delete(path);
    else this.chosen.add(path);
    this.anchor = k;
    [...this.list.children].forEach((option, n) => option.setAttribute("aria-selected", String(this.chosen.has(this.channels[n].path))));
    this.list.setAttribute("aria-activedescendant", `channel-${k}`);
    this.draw();
  }

  private onKey(event: KeyboardEvent): void {
    const way = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (way === undefined || this.channels.length === 0) return;
    event.preventDefault();
    event.stopPropagation();
    const next = Math.min(Math.max(this.anchor + way, 0), this.channels.length - 1);
    this.choose(next, event.shiftKey);
    this.list.children[next].scrollIntoView({ block: "nearest" });
  }

  private scrub(event: PointerEvent): void {
    const box = this.canvas.getBoundingClientRect();
    const left = leftOf(textSize());
    const share = (event.clientX - box.left - left) / (box.width - left - right);
    this.playback.goTo(this.playback.first + share * (this.playback.last - this.playback.first));
  }
}

/** What the curves, keys and handles over these frames take, with some air. */
function range(channels: Channel[], first: number, last: number): [number, number] {
  let low = Infinity;
  let high = -Infinity;
  const include = (row: number[]) => {
    for (const value of row.slice(1)) {
      if (!Number.isFinite(value)) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  };
  for (const channel of channels) {
    channel.points.forEach(include);
    for (const { tip } of channel.handles) if (tip[0] >= first && tip[0] <= last) include(tip);
  }
  if (low > high) return [0, 1];
  const air = high > low ? 0.08 * (high - low) : Math.max(1, 0.1 * Math.abs(high));
  return [low - air, high + air];
}

/** Four digits at most. */
export function numberText(value: number): string {
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e5 || size < 1e-3)) return value.toExponential(1).replace("e+", "e");
  return String(Number(value.toPrecision(4)));
}
