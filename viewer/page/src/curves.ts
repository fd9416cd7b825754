// The curve panel: the list of channels with keys, the curves of the chosen ones, and their values.

import type { Channel } from "./bake";
import { CurvePlot, nameOf, valueAt, valueText, type Curve, type CurvePicture, type Hover } from "./curve_plot";
import { make } from "./element";
import type { FrameAxis } from "./frame_axis";
import type { Playback } from "./playback";
import type { ThemeChoice } from "./theme";

const names = ["x", "y", "z"];
/** Dash patterns, used when there are more curves than colours. */
const dashes = [[], [6, 3], [2, 3], [8, 3, 2, 3]];

export class CurvePanel {
  private channels: Channel[] = [];
  private readonly chosen = new Set<string>();
  private anchor = 0;
  /** The curve that uses each colour. A curve keeps its colour while it is shown. */
  private slots: (string | undefined)[] = [];
  private hover: Hover | null = null;
  private readonly plot: CurvePlot;

  constructor(
    private readonly list: HTMLElement,
    private readonly canvas: HTMLCanvasElement,
    private readonly values: HTMLElement,
    private readonly playback: Playback,
    axis: FrameAxis,
    private readonly themes: ThemeChoice,
  ) {
    this.plot = new CurvePlot(canvas, axis);
    playback.onChange(() => this.draw());
    themes.onChange(() => this.fillList());
    new ResizeObserver(() => this.draw()).observe(canvas);
    list.addEventListener("keydown", (event) => this.onKey(event));
    const scrub = (event: PointerEvent) => playback.goTo(axis.frameAt(event.clientX));
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      playback.pause();
      scrub(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      // The engine uses whole frames.
      const frame = Math.min(Math.max(Math.round(axis.frameAt(event.clientX)), playback.first), playback.last);
      this.hover = { frame, curve: this.plot.near(this.picture(), event.clientX, event.clientY) };
      if (canvas.hasPointerCapture(event.pointerId)) scrub(event);
      else this.draw();
    });
    canvas.addEventListener("pointerleave", () => {
      this.hover = null;
      this.draw();
    });
  }

  load(channels: Channel[]): void {
    this.channels = channels;
    this.hover = null;
    const paths = new Set(channels.map((channel) => channel.path));
    for (const path of [...this.chosen]) if (!paths.has(path)) this.chosen.delete(path);
    if (this.chosen.size === 0 && channels.length > 0) this.chosen.add(channels[0].path);
    this.fillList();
  }

  draw(): void {
    if (this.canvas.offsetParent === null) return;
    this.giveColours();
    const picture = this.picture();
    this.plot.draw(picture);
    this.tell(picture);
    const described = this.shown.map((channel) => `${channel.path}, ${channel.keys.length} keys`);
    this.canvas.setAttribute("aria-label", described.length > 0 ? `Curves: ${described.join("; ")}` : "No curve chosen");
  }

  private get shown(): Channel[] {
    return this.channels.filter((channel) => this.chosen.has(channel.path));
  }

  private picture(): CurvePicture {
    const { first, last, time } = this.playback;
    const empty = this.channels.length === 0 ? "No channel of this scene has keys." : "";
    return { curves: this.shown.flatMap((channel) => this.curvesOf(channel)), palette: this.themes.palette, first, last, time, hover: this.hover, empty };
  }

  private curvesOf(channel: Channel): Curve[] {
    const colours = this.themes.palette.curves;
    return componentsOf(channel).map((part, k) => {
      const slot = Math.max(this.slots.indexOf(`${channel.path} ${k}`), 0);
      return { channel, component: k + 1, part, colour: colours[slot % colours.length], dash: dashes[Math.floor(slot / colours.length) % dashes.length] };
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
  private tell({ curves, hover }: CurvePicture): void {
    const frame = hover?.frame ?? this.playback.frame;
    this.values.replaceChildren(make("p", {}, `frame ${frame}`), ...curves.map((curve) => this.valueRow(curve, frame, curve.channel === hover?.curve?.channel && curve.component === hover.curve.component)));
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
        const properties = { role: "option", id: `channel-${k}`, title: channel.path, ariaSelected: String(isShown) };
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
