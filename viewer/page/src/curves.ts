// The curve panel: the list of channels with keys, the curves of the chosen ones, and their values.

import type { Channel } from "./bake";
import { Changing } from "./changing";
import { CurvePlot, isOne, nameOf, valueAt, valueText, type Curve, type CurvePicture, type Hover, type KeyState, type Scales, type Trace } from "./curve_plot";
import { make } from "./element";
import type { FrameAxis } from "./frame_axis";
import type { Playback } from "./playback";
import type { ThemeChoice } from "./theme";

const names = ["x", "y", "z"];
/** Dash patterns, used when there are more curves than colours. */
const dashes = [[], [6, 3], [2, 3], [8, 3, 2, 3]];

/** What an editor adds to the drawing. */
export interface CurveDressing {
  /** Keys that are being moved are where they are meant to come. */
  moved: (channel: Channel) => Channel;
  stateOf: (curve: Curve, frame: number) => KeyState;
  traces: (curve: Curve) => Trace[];
  shaded: (channel: Channel) => [number, number][];
}

export class CurvePanel extends Changing {
  /** The frames and the values shown; null: all, and those of the curves. */
  frames: [number, number] | null = null;
  values: [number, number] | null = null;
  dressing: CurveDressing = { moved: (channel) => channel, stateOf: () => "plain", traces: () => [], shaded: () => [] };
  private channels: Channel[] = [];
  private readonly chosen = new Set<string>();
  private anchor = 0;
  /** The curve that uses each colour. A curve keeps its colour while it is shown. */
  private slots: (string | undefined)[] = [];
  private hover: Hover | null = null;
  private soon = 0;
  private readonly plot: CurvePlot;

  constructor(
    private readonly list: HTMLElement,
    private readonly canvas: HTMLCanvasElement,
    private readonly table: HTMLElement,
    private readonly playback: Playback,
    axis: FrameAxis,
    private readonly themes: ThemeChoice,
  ) {
    super();
    this.plot = new CurvePlot(canvas, axis);
    playback.onChange(() => this.draw());
    themes.onChange(() => this.fillList());
    new ResizeObserver(() => this.draw()).observe(canvas);
    list.addEventListener("keydown", (event) => this.onKey(event));
    const scrub = (event: PointerEvent) => playback.goTo(this.frameAt(event));
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      playback.pause();
      scrub(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      this.point(event);
      if (canvas.hasPointerCapture(event.pointerId)) scrub(event);
    });
    canvas.addEventListener("pointerleave", () => this.point(null));
  }

  /** Tells of what is at a pointer; null: it has left. */
  point(event: PointerEvent | null): void {
    this.hover = null;
    if (event) {
      // The engine uses whole frames.
      const frame = Math.min(Math.max(Math.round(this.frameAt(event)), this.playback.first), this.playback.last);
      this.hover = { frame, curve: this.plot.near(this.picture(), event.clientX, event.clientY) };
    }
    this.draw();
  }

  /** The channels whose curves are shown. */
  get shown(): Channel[] {
    return this.channels.filter((channel) => this.chosen.has(channel.path));
  }

  get curves(): Curve[] {
    return this.shown.flatMap((channel) => this.curvesOf(channel));
  }

  get scales(): Scales {
    return this.plot.scales(this.picture());
  }

  /** The curve nearest to a pointer; null: none is that near. [px] */
  nearAt({ clientX, clientY }: MouseEvent, reach: number): Curve | null {
    return this.plot.near(this.picture(), clientX, clientY, reach);
  }

  load(channels: Channel[]): void {
    const before = this.channels;
    this.channels = channels;
    this.hover = null;
    const paths = new Set(channels.map((channel) => channel.path));
    for (const path of [...this.chosen]) if (!paths.has(path)) this.chosen.delete(path);
    if (this.chosen.size === 0 && channels.length > 0) this.chosen.add(channels[0].path);
    const isSame = before.length === channels.length && channels.every(({ path, components }, k) => path === before[k].path && components === before[k].components);
    if (isSame) this.draw();
    else this.fillList();
  }

  /** Draws it with the next picture of the page. */
  drawSoon(): void {
    this.soon ||= requestAnimationFrame(() => this.draw());
  }

  draw(): void {
    cancelAnimationFrame(this.soon);
    this.soon = 0;
    if (this.canvas.offsetParent === null) return;
    this.giveColours();
    const picture = this.picture();
    this.plot.draw(picture);
    this.showValues(picture);
    const described = this.shown.map((channel) => `${channel.path}, ${channel.keys.length} keys`);
    this.canvas.setAttribute("aria-label", described.length > 0 ? `Curves: ${described.join("; ")}` : "No curve chosen");
    this.tell();
  }

  private frameAt({ clientX }: PointerEvent): number {
    return this.scales.frameAt(clientX - this.canvas.getBoundingClientRect().left);
  }

  private picture(): CurvePicture {
    const { first, last, time } = this.playback;
    const empty = this.channels.length === 0 ? "No channel of this scene has keys." : "";
    const { frames, values, dressing, curves } = this;
    const [traces, shaded] = [curves.flatMap(dressing.traces), this.shown.flatMap(dressing.shaded)];
    return { curves, palette: this.themes.palette, first, last, time, hover: this.hover, empty, frames, values, stateOf: dressing.stateOf, traces, shaded };
  }

  private curvesOf(channel: Channel): Curve[] {
    const colours = this.themes.palette.curves;
    const moved = this.dressing.moved(channel);
    return componentsOf(channel).map((part, k) => {
      const slot = Math.max(this.slots.indexOf(`${channel.path} ${k}`), 0);
      return { channel: moved, component: k + 1, part, colour: colours[slot % colours.length], dash: dashes[Math.floor(slot / colours.length) % dashes.length] };
    });
  }

  // Gives each new curve the first free colour.
  private giveColours(): void {
    const wanted = this.shown.flatMap((channel) => componentsOf(channel).map((_, k) => `${channel.path} ${k}`));
    this.slots = this.slots.map((key) => (key !== undefined && wanted.includes(key) ? key : undefined));
    for (const key of wanted) {
      if (this.slots.includes(key)) continue;
      const free = this.slots.indexOf(undefined);
      this.slots[free < 0 ? this.slots.length : free] = key;
    }
  }

  // Lists the curves with their colours and values at the cursor, or without a cursor at the frame
  // shown.
  private showValues({ curves, hover }: CurvePicture): void {
    const frame = hover?.frame ?? this.playback.frame;
    this.table.replaceChildren(make("p", {}, `frame ${frame}`), ...curves.map((curve) => this.valueRow(curve, frame, isOne(curve, hover?.curve))));
  }

  private valueRow(curve: Curve, frame: number, isNear: boolean): HTMLElement {
    const name = nameOf(curve);
    const number = valueAt(curve, frame);
    const value = make("b", {}, number === undefined ? "–" : valueText(number));
    return make("span", { className: isNear ? "near" : "", title: name }, swatch(curve), make("span", {}, name), value);
  }

  private fillList(): void {
    this.giveColours();
    this.list.replaceChildren(
      ...this.channels.map((channel, k) => {
        const isShown = this.chosen.has(channel.path);
        // A long path may break after the name of its element.
        const label = make("span", {}, ...channel.path.split(/(?<=\.)/).flatMap((part, n) => (n === 0 ? [part] : [make("wbr"), part])));
        const properties = { role: "option", id: `channel-${k}`, title: channel.path, ariaLabel: channel.path, ariaSelected: String(isShown) };
        const option = make("div", properties, label, ...(isShown ? this.curvesOf(channel).map(swatch) : []));
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
    this.values = null;
    this.anchor = k;
    this.list.setAttribute("aria-activedescendant", `channel-${k}`);
    this.fillList();
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
}

/** The names of a vector's components. */
const componentsOf = ({ components }: Channel) => (components === 1 ? [""] : names.slice(0, components));

function swatch(curve: Curve): HTMLElement {
  const mark = make("i", { title: curve.part });
  mark.style.background = curve.dash.length === 0 ? curve.colour : `repeating-linear-gradient(to right, ${curve.colour} 0 3px, transparent 3px 5px)`;
  return mark;
}
