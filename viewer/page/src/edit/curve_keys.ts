// The keys of the curve panel and their handles, as buttons over the plot: chosen, moved, scaled, and turned. What is done
// is drawn at once, and holds when the document says so.

import type { Channel } from "../bake";
import { Changing } from "../changing";
import { after, type Curve, type Scales } from "../curve_plot";
import type { CurvePanel } from "../curves";
import { make } from "../element";
import { arrange, setAttribute } from "./arrange";
import { digitsTo, placeOf, rounded, stepOf } from "./arithmetic";
import type { Editor } from "./editor";
import { deleteKeys, KeySet, readOnly, writable, type KeyPlace, type KeysOf } from "./key_set";
import { onContextMenu, openMenu } from "./menu";
import type { Gesture, Operation } from "./session";
import { aside, between, type Spot } from "./sight";

/** With more keys in the window there are no buttons: they are drawn only. */
const mostButtons = 500;
/** With more of them values are moved together, else each to a short number. */
const mostTexts = 64;
const leastMove = 3; // [px]
/** A pointer takes hold of what is this near. [px] */
const reach = { mouse: 12, touch: 20 };
/** From what is chosen to the box around it. [px] */
const boxMargin = 16;
/** The box stays this far inside of the plot. [px] */
const boxEdge = 5;

type Side = "in" | "out";
type Modifiers = Pick<KeyboardEvent, "shiftKey" | "ctrlKey" | "altKey">;

/** A key that is being moved knows where it was. */
type ShownKey = Channel["keys"][number] & { from?: number };

/** What a button stands for. */
type Held = { kind: "key"; place: KeyPlace } | { kind: "handle"; place: KeyPlace; side: Side } | { kind: "scale"; x: -1 | 0 | 1; y: -1 | 0 | 1 };

interface ShownButton {
  element: HTMLButtonElement;
  held: Held;
  spot: Spot;
  /** Of the button, which is not on another. */
  free: Spot;
}

/** How far a pull has gone, as what is drawn and what is asked for. */
interface Change {
  frameOf: (frame: number) => number;
  valueOf: (value: number) => number;
  /** Of one key. */
  tips: { side: Side; tip: number[] }[];
  operations: Operation[];
}

interface Drag {
  /** Null: by arrow keys. */
  pointer: number | null;
  start: Spot;
  spot: Spot;
  hasMoved: boolean;
  /** What is moved, and the channels as they were. */
  set: KeySet;
  channels: Map<string, Channel>;
  scales: Scales;
  /** Null: only the window, or what is chosen, changes. */
  pull: (spot: Spot, modifiers: Modifiers) => Change | null;
  change: Change | null;
  gesture: Gesture | null;
  letGo: (modifiers: Modifiers) => void;
  putBack: () => void;
  /** The values shown, to which the window comes back. */
  values: [number, number] | null;
  isOver: boolean;
  /** The document has answered; it waits for the scene to say so too. */
  isAnswered: boolean;
}

const unchanged = { frameOf: (frame: number) => frame, valueOf: (value: number) => value, tips: [] };
const edges: Record<string, [-1 | 0 | 1, -1 | 0 | 1]> = {
  left: [-1, 0], right: [1, 0], top: [0, 1], bottom: [0, -1], "top left": [-1, 1], "top right": [1, 1], "bottom left": [-1, -1], "bottom right": [1, -1],
};
const arrows: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

const modifierKeys = ["Shift", "Control", "Alt"];

const partOf = ({ component }: Curve) => component - 1;
const keyName = ({ channel, part }: Curve, frame: number) => `${channel.path}${part === "" ? "" : ` ${part}`} key ${frame}`;

/** Tells when others are chosen, and when those that are change. */
export class CurveKeys extends Changing {
  private set = new KeySet();
  /** Whose tangents were parted, though they are still in one line. */
  private parted = new KeySet();
  private readonly layer = make("div", { className: "curve-keys", role: "group", ariaLabel: "Keys of the curves", tabIndex: -1 });
  private readonly box = make("div", { className: "choice-box", hidden: true });
  private readonly frame = make("div", { className: "scale-box", hidden: true });
  private buttons = new Map<string, ShownButton>();
  private known: Channel[] = [];
  private drag: Drag | null = null;
  private told: unknown[] = [];
  private isHeld = false;
  private next: Map<string, Channel> | null = null;
  private readonly fingers = new Map<number, Spot>();
  private clashes = new Map<string, Set<number>>();
  private movedOf = new Map<Channel, Channel>();

  constructor(
    private readonly editor: Editor,
    private readonly panel: CurvePanel,
    private readonly canvas: HTMLCanvasElement,
  ) {
    super();
    canvas.after(this.layer);
    const recordedOf = (path: string) => editor.recorder.recorded.filter((each) => each.path === path);
    panel.dressing = {
      moved: (channel) => this.moved(channel),
      stateOf: ({ channel: { path }, component }, frame) => (this.clashes.get(path)?.has(frame) ? "clash" : this.shownSet.has({ path, frame, part: component - 1 }) ? "selected" : "plain"),
      traces: ({ channel: { path }, component }) =>
        recordedOf(path).flatMap(({ first, before, raw }) => [
          ...(before ? [{ kind: "before" as const, points: before.points.map((point): [number, number] => [point[0], point[component]]) }] : []),
          { kind: "hand" as const, points: raw.map((numbers, k): [number, number] => [first + k, numbers[component - 1]]) },
        ]),
      shaded: ({ path }) => recordedOf(path).map(({ first, last }) => [first, last]),
    };
    editor.recorder.onChange(() => panel.drawSoon());
    panel.onChange(() => this.update());
    editor.session.onChange(() => this.settle());
    editor.scene.onChange(() => this.settle());
    const { layer } = this;
    layer.addEventListener("pointerdown", (event) => this.press(event));
    layer.addEventListener("pointermove", (event) => this.move(event));
    layer.addEventListener("pointerleave", () => panel.point(null));
    for (const name of ["pointerup", "pointercancel"] as const) layer.addEventListener(name, (event) => this.release(event));
    layer.addEventListener("click", (event) => this.click(event));
    layer.addEventListener("dblclick", (event) => this.add(event));
    layer.addEventListener("wheel", (event) => this.zoom(event), { passive: false });
    layer.addEventListener("keydown", (event) => this.onKey(event));
    layer.addEventListener("keyup", ({ key }) => key in arrows && this.endByKeys());
    layer.addEventListener("focusout", () => this.endByKeys());
    document.addEventListener("keydown", (event) => this.stop(event), true);
    for (const name of ["keydown", "keyup"] as const) document.addEventListener(name, (event) => this.modify(event), true);
    onContextMenu(layer, (target, place) => this.openMenu(target, place));
  }

  // What is chosen

  get chosen(): KeysOf[] {
    return this.set.keys;
  }

  get places(): KeyPlace[] {
    return this.set.places;
  }

  /** Keys are chosen, and the focus is at them. */
  get isMeant(): boolean {
    return !this.set.isEmpty && this.hasFocus;
  }

  get hasFocus(): boolean {
    const { activeElement } = document;
    if (activeElement === null || activeElement.matches("input, select")) return false;
    // Or at what has just opened the panel.
    return activeElement.closest("#curves") !== null || activeElement.matches("#curves-toggle[aria-pressed=true]");
  }

  /** The channels whose curves are shown. */
  get channels(): Channel[] {
    return this.panel.shown;
  }

  delete(): Promise<void> {
    return deleteKeys(this.editor, this.chosen);
  }

  chooseAll(): void {
    const all = new KeySet();
    for (const { path, components, keys } of this.panel.shown) for (const { at } of keys) for (let part = 0; part < components; ++part) all.add({ path, frame: at[0], part });
    this.choose(all);
  }

  /** Chooses these once they are there. */
  choose(set: KeySet): void {
    this.set = set;
    this.panel.draw();
  }

  /** What a key of a component is. */
  keyAt({ path, frame }: KeyPlace): Channel["keys"][number] | undefined {
    const keys = this.panel.shown.find((channel) => channel.path === path)?.keys ?? [];
    const key = keys[after(keys, frame, ({ at }) => at[0]) - 1];
    return key?.at[0] === frame ? key : undefined;
  }

  /** Keeps the choice while its keys get other frames or values, and tells how to say these. */
  hold(): { toFrame: (frame: number) => Operation[]; toValue: (value: string) => Operation[] } {
    this.isHeld = true;
    const { set, firstFrame } = this;
    const channels = new Map(this.panel.shown.map((channel) => [channel.path, channel]));
    return {
      toFrame: (frame) => [{ op: "moveKeys", keys: writable(this.editor, set.keys), frames: frame - firstFrame }],
      toValue: (value) => this.valueOperations(set, channels, (place) => (set.has(place) ? value : null), unchanged.frameOf),
    };
  }

  /** After `hold`; `frame`: to which the first key came. */
  letGo(frame = this.firstFrame): void {
    const by = frame - this.firstFrame;
    [this.set, this.parted] = [this.set, this.parted].map((set) => set.at((each) => each + by));
    this.isHeld = false;
    this.panel.draw();
  }

  /** Of what is chosen. */
  get firstFrame(): number {
    return Math.min(...this.set.places.map(({ frame }) => frame));
  }

  /** Whether the tangents of all that is chosen, if there are two, turn by themselves. */
  get isBroken(): boolean {
    const turning = this.set.places.filter((place) => this.handleOf(place, "in") && this.handleOf(place, "out"));
    return turning.length > 0 && turning.every((place) => !this.isJoined(place));
  }

  /** Parts the tangents of what is chosen, or joins them. */
  async toggleBreak(): Promise<void> {
    if (!this.isBroken) {
      this.parted = this.parted.copy();
      for (const place of this.set.places) this.parted.add(place);
      return this.panel.draw();
    }
    const operations: Operation[] = [];
    this.parted = this.parted.copy();
    for (const place of this.set.places) {
      this.parted.delete(place);
      const [before, out] = [this.handleOf(place, "in"), this.handleOf(place, "out")];
      if (!before || !out || this.isJoined(place)) continue;
      operations.push(handleOperation(place.path, "in", before, turned(before.tip, slopeOf(out, place.part), before.key, place.part)));
    }
    await this.editor.apply(operations, operations.length > 1 ? "join tangents" : undefined);
    this.panel.draw();
  }

  /** Shows all of what is chosen, or of the curves. */
  fit(): void {
    const { places } = this.set;
    this.panel.frames = this.panel.values = null;
    const numbers = places.map((place) => this.keyAt(place)?.at[1 + place.part] ?? 0);
    const frames = places.map(({ frame }) => frame);
    if (places.length > 1) {
      const around = (all: number[], least: number): [number, number] => {
        const [low, high] = [Math.min(...all), Math.max(...all)];
        const air = Math.max(0.1 * (high - low), least);
        return [low - air, high + air];
      };
      this.panel.frames = around(frames, 1);
      this.panel.values = around(numbers, 0.05 * (Math.max(...numbers.map(Math.abs)) || 1));
    }
    this.panel.draw();
  }

  // What is drawn

  private get shownSet(): KeySet {
    return this.drag?.change ? (this.movedSet ??= this.drag.set.at(this.drag.change.frameOf)) : this.set;
  }

  private movedSet: KeySet | null = null;

  private moved(channel: Channel): Channel {
    const { drag } = this;
    const before = drag?.change && drag.channels.get(channel.path);
    if (!drag?.change || !before || !drag.set.paths.includes(channel.path)) return channel;
    const known = this.movedOf.get(channel);
    if (known) return known;
    const { frameOf, valueOf, tips } = drag.change;
    const masks = drag.set.framesOf(channel.path);
    const keys = before.keys.map((key): ShownKey => {
      const [frame, ...values] = key.at;
      const mask = masks.get(frame);
      if (mask === undefined || tips.length > 0) return key;
      return { ...key, at: [frameOf(frame), ...values.map((value, part) => (mask & (1 << part) ? valueOf(value) : value))], from: frame };
    });
    keys.sort((a, b) => a.at[0] - b.at[0]);
    const handles = tips.length === 0 ? channel.handles : before.handles.map((handle) => ({ ...handle, tip: (masks.has(handle.key[0]) && tips.find(({ side }) => side === handle.side)?.tip) || handle.tip }));
    const moved = { ...channel, keys, handles };
    this.movedOf.set(channel, moved);
    return moved;
  }

  private update(): void {
    const { panel, drag } = this;
    const { shown } = panel;
    if (!drag && !this.isHeld && (shown.length !== this.known.length || shown.some((channel, k) => channel !== this.known[k]))) {
      this.known = [...shown];
      // While the scene is that of before, what was just made is not there.
      if (this.isSettled) [this.set, this.parted] = [this.set.of(shown), this.parted.of(this.editor.scene.head?.channels ?? shown)];
    }
    this.layOut();
    const now = [this.set, this.parted, this.known, this.drag?.change];
    if (now.every((each, k) => each === this.told[k])) return;
    this.told = now;
    this.tell();
  }

  private layOut(): void {
    const { scales } = this.panel;
    this.layer.style.bottom = `${this.canvas.clientHeight - scales.floor}px`;
    const wanted = new Map<string, { held: Held; name: string; spot: Spot; isChosen: boolean; frame: number }>();
    const [first, last] = scales.frames;
    const curves = this.panel.curves.map((curve) => ({ curve, keys: (curve.channel.keys as ShownKey[]).filter(({ at }) => at[0] >= first && at[0] <= last) }));
    const count = curves.reduce((sum, { keys }) => sum + keys.length, 0);
    for (const { curve, keys } of count > mostButtons ? [] : curves) {
      const { channel: { path, handles }, component } = curve;
      const part = partOf(curve);
      for (const { at, from } of keys) {
        const [frame] = at;
        const place = { path, frame: from ?? frame, part };
        const isChosen = this.shownSet.has({ path, frame, part });
        const id = `${path} ${part} ${place.frame}`;
        const name = keyName(curve, frame);
        wanted.set(id, { held: { kind: "key", place }, name, spot: { x: scales.x(frame), y: scales.y(at[component]) }, isChosen, frame });
        if (from !== undefined) continue; // those of what moves come when it rests
        for (const { key, tip, side } of handlesAt(handles, frame)) {
          if (key[0] !== frame) continue;
          wanted.set(`${id} ${side}`, { held: { kind: "handle", place, side }, name: `${name} ${side}`, spot: { x: scales.x(tip[0]), y: scales.y(tip[component]) }, isChosen, frame });
        }
      }
    }
    for (const [name, held] of this.scaleHandles(scales)) wanted.set(name, held);
    for (const [id, { element }] of this.buttons) {
      if (wanted.has(id)) continue;
      const hadFocus = element === document.activeElement;
      element.remove();
      this.buttons.delete(id);
      if (hadFocus) this.layer.focus({ preventScroll: true });
    }
    const room = matchMedia("(pointer: coarse)").matches ? 26 : 16; // beyond half a button
    const taken = new Map<number, Spot[]>();
    const freeSpot = (frame: number, spot: Spot) => {
      const others = taken.get(frame) ?? [];
      const far = aside(spot, { x: spot.x + 2 * room > scales.right ? -1 : 1, y: 0 }, others, room);
      const free = { x: spot.x + far.x, y: spot.y };
      taken.set(frame, [...others, free]);
      return free;
    };
    for (const [id, { held, name, spot, isChosen, frame }] of wanted) {
      const free = held.kind === "key" ? freeSpot(frame, spot) : spot;
      const shown = this.buttons.get(id) ?? { element: make("button", { type: "button" }), held, spot, free };
      this.buttons.set(id, Object.assign(shown, { held, spot, free }));
      const { element } = shown;
      setAttribute(element, "aria-label", name);
      setAttribute(element, "title", name);
      element.dataset.kind = held.kind;
      if (held.kind === "key") {
        const isClash = this.clashes.get(held.place.path)?.has(frame) ?? false;
        setAttribute(element, "aria-pressed", String(isChosen));
        setAttribute(element, "aria-description", isClash ? "another key is at this frame" : null);
        element.toggleAttribute("data-clash", isClash);
      }
      element.tabIndex = held.kind === "handle" && !isChosen ? -1 : 0;
      element.toggleAttribute("data-passive", held.kind === "handle" && !isChosen);
      element.style.transform = `translate(${Math.round(2 * free.x) / 2}px, ${Math.round(2 * free.y) / 2}px)`;
    }
    const order = [...wanted.keys()].map((id) => this.buttons.get(id)!.element);
    arrange(this.layer, [this.box, this.frame, ...order]);
  }

  // At the sides and corners of the box around what is chosen.
  private scaleHandles(scales: Scales): [string, { held: Held; name: string; spot: Spot; isChosen: boolean; frame: number }][] {
    const bounds = this.bounds;
    this.frame.hidden = bounds === null;
    if (!bounds) return [];
    const { frames, values } = bounds;
    const within = (place: number, most: number) => Math.min(Math.max(place, boxEdge), most - boxEdge);
    const [left, right] = [scales.x(frames[0]) - boxMargin, scales.x(frames[1]) + boxMargin].map((x) => within(x, this.canvas.clientWidth));
    const [over, under] = [scales.y(values[1]) - boxMargin, scales.y(values[0]) + boxMargin].map((y) => within(y, scales.floor));
    Object.assign(this.frame.style, { left: `${left}px`, top: `${over}px`, width: `${right - left}px`, height: `${under - over}px` });
    return Object.entries(edges)
      .filter(([, [x, y]]) => (x === 0 || frames[1] > frames[0]) && (y === 0 || values[1] > values[0]))
      .map(([name, [x, y]]) => {
        const spot = { x: [left, (left + right) / 2, right][x + 1], y: [under, (over + under) / 2, over][y + 1] };
        return [`scale ${name}`, { held: { kind: "scale", x, y }, name: `Scale keys ${name}`, spot, isChosen: true, frame: 0 }];
      });
  }

  /** Of at least two chosen keys, the frames and values that they reach over; as they are shown. */
  private get bounds(): { frames: [number, number]; values: [number, number] } | null {
    const { shownSet } = this;
    const [frames, values] = [[Infinity, -Infinity], [Infinity, -Infinity]];
    let count = 0;
    for (const curve of this.panel.curves) {
      const masks = shownSet.framesOf(curve.channel.path);
      if (masks.size === 0) continue;
      for (const { at } of curve.channel.keys) {
        if (!((masks.get(at[0]) ?? 0) & (1 << partOf(curve)))) continue;
        ++count;
        [frames[0], frames[1]] = [Math.min(frames[0], at[0]), Math.max(frames[1], at[0])];
        [values[0], values[1]] = [Math.min(values[0], at[curve.component]), Math.max(values[1], at[curve.component])];
      }
    }
    return count > 1 ? { frames: frames as [number, number], values: values as [number, number] } : null;
  }

  // Pointers

  private spotOf({ clientX, clientY }: MouseEvent): Spot {
    const { left, top } = this.canvas.getBoundingClientRect();
    return { x: clientX - left, y: clientY - top };
  }

  // The nearest of what can be taken hold of; where several are, that on which the pointer is.
  private heldAt(event: MouseEvent): Held | null {
    const spot = this.spotOf(event);
    const isTouch = event instanceof PointerEvent && event.pointerType === "touch";
    let [best, least]: [Held | null, number] = [null, isTouch ? reach.touch : reach.mouse];
    for (const { element, held, spot: drawn, free } of this.buttons.values()) {
      if (element.hasAttribute("data-passive")) continue;
      const far = Math.min(between(spot, drawn), between(spot, free)) - (element === event.target ? 1e-3 : 0);
      if (far < least) [best, least] = [held, far];
    }
    if (best || [...this.buttons.values()].some(({ held }) => held.kind === "key")) return best;
    const scales = this.panel.scales;
    for (const curve of this.panel.curves) {
      for (const { at } of curve.channel.keys) {
        const far = between(spot, { x: scales.x(at[0]), y: scales.y(at[curve.component]) });
        if (far < least) [best, least] = [{ kind: "key", place: { path: curve.channel.path, frame: at[0], part: partOf(curve) } }, far];
      }
    }
    return best;
  }

  private press(event: PointerEvent): void {
    const spot = this.spotOf(event);
    if (event.pointerType === "touch") this.fingers.set(event.pointerId, spot);
    if (this.fingers.size === 2 && !this.drag?.hasMoved) {
      void this.cancel();
      this.layer.setPointerCapture(event.pointerId);
      return;
    }
    if (event.button > 1 || (this.drag && !this.drag.isOver) || this.fingers.size > 1) return;
    this.takeOver();
    // Or the focus would leave what is pressed.
    event.preventDefault();
    this.layer.setPointerCapture(event.pointerId);
    const held = event.button === 1 ? null : this.heldAt(event);
    const shown = held && [...this.buttons.values()].find((each) => each.held === held);
    (shown?.element ?? this.layer).focus({ preventScroll: true });
    this.editor.playback.pause();
    if (!held && (event.button === 1 || event.altKey)) this.beginPan(event.pointerId, spot);
    else if (!held) this.beginBox(event.pointerId, spot, event.shiftKey);
    else this.begin(held, event.pointerId, spot, event);
  }

  private move(event: PointerEvent): void {
    const spot = this.spotOf(event);
    if (this.fingers.has(event.pointerId) && this.fingers.size === 2) return this.pinch(event.pointerId, spot);
    const { drag } = this;
    if (!drag || drag.isOver || drag.pointer !== event.pointerId) {
      if (!drag || drag.isOver) this.panel.point(event);
      return;
    }
    drag.spot = spot;
    if (!drag.hasMoved && between(spot, drag.start) < leastMove) return;
    drag.hasMoved = true;
    this.pull(event);
  }

  private release(event: PointerEvent): void {
    this.fingers.delete(event.pointerId);
    const { drag } = this;
    if (!drag || drag.isOver || drag.pointer !== event.pointerId) return;
    if (event.type === "pointercancel") void this.cancel();
    else void this.end(event);
  }

  // Of keys; those of pointers are done.
  private click(event: MouseEvent): void {
    if (event.detail !== 0) return;
    const shown = [...this.buttons.values()].find(({ element }) => element === event.target);
    if (shown?.held.kind !== "key") return;
    const { place } = shown.held;
    const isTaken = event.shiftKey && this.set.has(place);
    this.set = event.shiftKey ? this.set.copy() : new KeySet();
    if (isTaken) this.set.delete(place);
    else this.set.add(place);
    this.panel.draw();
  }

  // A key without changing the curve.
  private async add(event: MouseEvent): Promise<void> {
    if (this.heldAt(event)?.kind === "key") return;
    const { panel } = this;
    const curves = panel.curves;
    // A finger has not hovered before.
    const curve = panel.nearAt(event, reach.touch) ?? (panel.shown.length === 1 ? curves[0] : null);
    if (!curve) return this.editor.say("Double click a curve to add a key to it");
    const { path } = curve.channel;
    const frame = Math.round(panel.scales.frameAt(this.spotOf(event).x));
    const set = new KeySet();
    set.add({ path, frame, part: partOf(curve) });
    if (await this.editor.apply([{ op: "setKey", channel: path, frame }])) this.choose(set);
  }

  // Zooms about the pointer.
  private zoom(event: WheelEvent): void {
    event.preventDefault();
    const turn = (event.deltaY || event.deltaX) * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 30 : 1);
    const times = Math.exp(0.0015 * Math.max(Math.min(turn, 400), -400));
    this.zoomAt(this.spotOf(event), event.shiftKey ? 1 : times, event.ctrlKey ? 1 : times);
  }

  private zoomAt(spot: Spot, alongFrames: number, alongValues: number, shift: Spot = { x: 0, y: 0 }): void {
    const { panel } = this;
    const { frameAt, valueAt, frames, values } = panel.scales;
    const [frame, value] = [frameAt(spot.x), valueAt(spot.y)];
    const [df, dv] = [frameAt(spot.x + shift.x) - frame, valueAt(spot.y + shift.y) - value];
    const about = ([low, high]: [number, number], middle: number, times: number, by: number, least: number): [number, number] => {
      const most = Math.max(Math.min(times, 1e12 / (high - low)), least / (high - low));
      return [middle + (low - middle) * most - by, middle + (high - middle) * most - by];
    };
    panel.frames = about(frames, frame, alongFrames, df, 0.1);
    panel.values = about(values, value, alongValues, dv, 1e-9 * Math.max(Math.abs(value), 1e-9));
    panel.drawSoon();
  }

  private pinch(moved: number, spot: Spot): void {
    const [a, b] = [...this.fingers];
    const [still, before] = a[0] === moved ? [b[1], a[1]] : [a[1], b[1]];
    this.fingers.set(moved, spot);
    const apart = (from: number, to: number) => (Math.abs(from) > 30 && Math.abs(to) > 30 ? from / to : 1);
    const times = [apart(before.x - still.x, spot.x - still.x), apart(before.y - still.y, spot.y - still.y)].map((each) => Math.min(Math.max(each, 0.5), 2));
    const shift = { x: (spot.x - before.x) / 2, y: (spot.y - before.y) / 2 };
    this.zoomAt({ x: (still.x + before.x) / 2, y: (still.y + before.y) / 2 }, times[0], times[1], shift);
  }

  // Gestures

  /** Keys are pulled, in a window that stays meanwhile. */
  private start(pointer: number | null, start: Spot, set: KeySet, pull: Drag["pull"], letGo: Drag["letGo"] = () => {}): void {
    const { panel } = this;
    const { values, scales } = panel;
    this.startView(pointer, start, pull, letGo);
    Object.assign(this.drag!, { set, values });
    panel.values = scales.values;
  }

  /** Only the window or the choice changes. */
  private startView(pointer: number | null, start: Spot, pull: Drag["pull"], letGo: Drag["letGo"] = () => {}, putBack = () => {}): void {
    const { panel } = this;
    const channels = this.next ?? new Map(panel.shown.map((channel) => [channel.path, channel]));
    this.next = null;
    this.drag = { pointer, start, spot: start, hasMoved: pointer === null, set: new KeySet(), channels, scales: panel.scales, pull, change: null, gesture: null, letGo, putBack, values: panel.values, isOver: false, isAnswered: false };
  }

  private beginPan(pointer: number, start: Spot): void {
    let last = start;
    this.startView(pointer, start, (spot) => {
      this.zoomAt(last, 1, 1, { x: spot.x - last.x, y: spot.y - last.y });
      this.drag!.values = this.panel.values;
      last = spot;
      return null;
    });
  }

  private beginBox(pointer: number, start: Spot, isAdded: boolean): void {
    const old = this.set;
    const before = isAdded ? old : new KeySet();
    const pull = (spot: Spot) => {
      const { scales, curves } = this.panel;
      const [left, right, over, under] = [Math.min(start.x, spot.x), Math.max(start.x, spot.x), Math.min(start.y, spot.y), Math.max(start.y, spot.y)];
      Object.assign(this.box.style, { left: `${left}px`, top: `${over}px`, width: `${right - left}px`, height: `${under - over}px` });
      this.box.hidden = false;
      this.set = before.copy();
      for (const curve of curves) {
        for (const { at } of curve.channel.keys) {
          const [x, y] = [scales.x(at[0]), scales.y(at[curve.component])];
          if (x >= left && x <= right && y >= over && y <= under) this.set.add({ path: curve.channel.path, frame: at[0], part: partOf(curve) });
        }
      }
      this.panel.drawSoon();
      return null;
    };
    const letGo = () => {
      this.box.hidden = true;
      if (!this.drag!.hasMoved) this.set = before;
    };
    this.startView(pointer, start, pull, letGo, () => (this.set = old));
  }

  private begin(held: Held, pointer: number | null, spot: Spot, { shiftKey }: Modifiers): void {
    if (held.kind === "scale") return this.beginScale(held, pointer, spot);
    const { place } = held;
    if (held.kind === "handle") return this.beginTurn(place, held.side, pointer, spot);
    const wasChosen = this.set.has(place);
    if (!wasChosen) {
      this.set = shiftKey ? this.set.copy() : new KeySet();
      this.set.add(place);
      this.panel.draw();
    }
    // A click on one of several chooses it alone, or takes it away.
    const letGo = (modifiers: Modifiers) => {
      if (!wasChosen || this.drag!.hasMoved) return;
      this.set = modifiers.shiftKey ? this.set.copy() : new KeySet();
      if (modifiers.shiftKey) this.set.delete(place);
      else this.set.add(place);
    };
    const values = this.bounds?.values ?? [0];
    this.start(pointer, spot, this.set, (there, modifiers) => this.shifted(place, values, there, modifiers), letGo);
  }

  // `values`: the least and the largest of all, before.
  private shifted({ frame }: KeyPlace, values: number[], spot: Spot, { shiftKey, ctrlKey }: Modifiers): Change {
    const { start, set, scales, pointer } = this.drag!;
    let [dx, dy] = [spot.x - start.x, spot.y - start.y];
    if (shiftKey && pointer !== null) [dx, dy] = Math.abs(dx) >= Math.abs(dy) ? [dx, 0] : [0, dy];
    const perPixel = { frame: scales.frameAt(1) - scales.frameAt(0), value: scales.valueAt(0) - scales.valueAt(1) };
    const raw = dx * perPixel.frame;
    const isWhole = pointer === null ? Number.isInteger(Math.round(1e6 * raw) / 1e6) : !ctrlKey;
    // What stands between frames goes to a whole one only if it is meant to leave its place.
    const base = pointer !== null && Math.abs(dx) < leastMove ? 0 : frame;
    const by = Math.abs(dx) < 1e-9 ? 0 : isWhole ? Math.round(base + raw) - base : Number(rounded(raw, stepOf(perPixel.frame)));
    const step = stepOf(perPixel.value);
    const rise = dy === 0 ? 0 : Number(rounded(-dy * perPixel.value, step));
    const frameOf = (each: number) => each + by;
    const isFew = set.places.length <= mostTexts;
    const textOf = (value: number) => rounded(value + rise, step);
    const digits = digitsTo(step, ...values.map((value) => value + rise));
    const valueOf = (value: number) => (rise === 0 ? value : Number(isFew ? textOf(value) : (value + rise).toPrecision(digits)));
    const operations: Operation[] = by === 0 ? [] : [{ op: "moveKeys", keys: writable(this.editor, set.keys), frames: by }];
    if (rise !== 0 && isFew) {
      operations.push(...this.valueOperations(set, this.drag!.channels, (place, value) => (set.has(place) ? textOf(value) : null), frameOf));
    } else if (rise !== 0) {
      for (const { parts, keys } of set.byParts) {
        const moved = writable(this.editor, keys).map(({ channel, frames }) => ({ channel, frames: frames.map(frameOf) }));
        operations.push({ op: "moveKeys", keys: moved, rise: moved.length > 0 ? this.perPart(moved[0].channel, parts, rise, 0) : [], digits });
      }
    }
    return { ...unchanged, frameOf, valueOf, operations };
  }

  // One number for each component of a channel.
  private perPart(path: string, parts: number[], one: number, other: number): number[] {
    const components = this.drag?.channels.get(path)?.components ?? 1;
    return Array.from({ length: components }, (_, part) => (parts.includes(part) ? one : other));
  }

  // What gives keys other values; `textOf`: of a component, null if it stays.
  private valueOperations(set: KeySet, channels: Map<string, Channel>, textOf: (place: KeyPlace, value: number) => string | null, frameOf: (frame: number) => number): Operation[] {
    return writable(this.editor, set.keys).flatMap(({ channel, frames }) => {
      const { keys = [], isSwitch = false } = channels.get(channel) ?? {};
      const chosen = new Set(frames);
      return keys.flatMap(({ at: [frame, ...values] }) => {
        if (!chosen.has(frame)) return [];
        const value = values.map((each, part) => textOf({ path: channel, frame, part }, each) ?? String(each)).join(" ");
        return [{ op: "setKey", channel, frame: frameOf(frame), value: isSwitch ? String(Number(value) >= 0.5) : value }];
      });
    });
  }

  private beginScale({ x, y }: { x: number; y: number }, pointer: number | null, spot: Spot): void {
    const bounds = this.bounds;
    if (!bounds) return;
    const { frames, values } = bounds;
    const pull: Drag["pull"] = (there, { ctrlKey, altKey }) => {
      const { start, set, scales } = this.drag!;
      const perPixel = { frame: scales.frameAt(1) - scales.frameAt(0), value: scales.valueAt(0) - scales.valueAt(1) };
      const side = ([low, high]: [number, number], way: number) => ({ edge: way < 0 ? low : high, pivot: altKey ? (low + high) / 2 : way < 0 ? high : low });
      const [alongFrames, alongValues] = [side(frames, x), side(values, y)];
      let times = 1;
      if (x !== 0) {
        const least = alongFrames.pivot + x * (ctrlKey ? perPixel.frame : 1);
        const wanted = alongFrames.edge + (there.x - start.x) * perPixel.frame;
        const target = ctrlKey ? Number(rounded(wanted, stepOf(perPixel.frame))) : Math.round(wanted);
        times = ((x > 0 ? Math.max(target, least) : Math.min(target, least)) - alongFrames.pivot) / (alongFrames.edge - alongFrames.pivot);
      }
      const steps = { frame: ctrlKey ? stepOf(perPixel.frame) : 1, value: stepOf(perPixel.value) };
      const target = Number(rounded(alongValues.edge - (there.y - start.y) * perPixel.value, steps.value));
      const factor = y === 0 ? 1 : (target - alongValues.pivot) / (alongValues.edge - alongValues.pivot);
      const frameOf = (frame: number) => (times === 1 ? frame : Number(rounded(alongFrames.pivot + times * (frame - alongFrames.pivot), steps.frame)));
      const exact = (value: number) => alongValues.pivot + factor * (value - alongValues.pivot);
      const digits = digitsTo(steps.value, ...values.map(exact));
      const valueOf = (value: number) => (exact(value) === value ? value : Number(exact(value).toPrecision(digits)));
      const operations: Operation[] = [];
      if (factor !== 1) {
        for (const { parts, keys } of set.byParts) {
          const own = writable(this.editor, keys);
          for (const each of own) operations.push({ op: "scaleKeys", keys: [each], value: this.perPart(each.channel, parts, alongValues.pivot, 0), valueFactor: this.perPart(each.channel, parts, factor, 1), digits });
        }
      }
      if (times !== 1) operations.push({ op: "scaleKeys", keys: writable(this.editor, set.keys), frame: alongFrames.pivot, timeFactor: times, step: steps.frame });
      return { ...unchanged, frameOf, valueOf, operations };
    };
    this.start(pointer, spot, this.set, pull);
  }

  private handleOf({ path, frame }: KeyPlace, side: Side): Channel["handles"][number] | undefined {
    const channel = this.drag?.channels.get(path) ?? this.panel.shown.find((each) => each.path === path);
    return channel && handlesAt(channel.handles, frame).find((each) => each.side === side && each.key[0] === frame);
  }

  // Its tangents are in one line, and nobody has parted them.
  private isJoined(place: KeyPlace): boolean {
    const [before, out] = [this.handleOf(place, "in"), this.handleOf(place, "out")];
    if (!before || !out || this.parted.has(place)) return false;
    const slopes = [slopeOf(before, place.part), slopeOf(out, place.part)];
    const apart = Math.abs(slopes[0] - slopes[1]);
    if (apart <= 1e-6 * Math.max(Math.abs(slopes[0]), Math.abs(slopes[1]))) return true;
    // A drag has rounded one of them, to the place at which both end, and nobody sees that.
    const step = Math.min(...[before, out].map((handle) => placeOf(riseOf(handle, place.part))));
    const far = apart * Math.min(...[before, out].map(({ key, tip }) => Math.abs(tip[0] - key[0])));
    return far <= 0.51 * step && far < this.panel.scales.valueAt(0) - this.panel.scales.valueAt(1);
  }

  private beginTurn(place: KeyPlace, side: Side, pointer: number | null, spot: Spot): void {
    const { path, part } = place;
    const handle = this.handleOf(place, side);
    if (!handle) return;
    const set = new KeySet();
    set.add(place);
    const other = this.isJoined(place) ? this.handleOf(place, side === "in" ? "out" : "in") : undefined;
    const pull: Drag["pull"] = (there) => {
      const { start, scales } = this.drag!;
      const perPixel = { frame: scales.frameAt(1) - scales.frameAt(0), value: scales.valueAt(0) - scales.valueAt(1) };
      const [frame, ...values] = handle.key;
      const wanted = handle.tip[0] - frame + (there.x - start.x) * perPixel.frame;
      const frames = Number(rounded(side === "in" ? Math.min(wanted, 0) : Math.max(wanted, 0), stepOf(perPixel.frame)));
      const step = stepOf(perPixel.value);
      const tip = handle.tip.map((each, k) => {
        if (k === 0) return frame + frames;
        if (k - 1 === part) return values[part] + Number(rounded(each - values[part] - (there.y - start.y) * perPixel.value, step));
        // The others keep their slopes.
        return frames === 0 || handle.tip[0] === frame ? each : handle.key[k] + slopeOf(handle, k - 1) * frames;
      });
      const tips = [{ side, tip }];
      const operations = [handleOperation(path, side, handle, tip)];
      if (other && frames !== 0) {
        const across = turned(other.tip, (tip[1 + part] - values[part]) / frames, other.key, part, step);
        tips.push({ side: other.side, tip: across });
        operations.push(handleOperation(path, other.side, other, across));
      }
      return { ...unchanged, tips, operations };
    };
    this.start(pointer, spot, set, pull);
  }

  private pull(modifiers: Modifiers): void {
    const drag = this.drag!;
    if (!drag.set.isEmpty && writable(this.editor, drag.set.keys).length === 0) {
      void this.cancel();
      return this.editor.say(readOnly);
    }
    const change = drag.pull(drag.spot, modifiers);
    if (!change) return;
    const isSame = JSON.stringify(change.operations) === JSON.stringify(drag.change?.operations);
    drag.change = change;
    this.movedOf.clear();
    this.movedSet = null;
    this.findClashes();
    this.panel.drawSoon();
    if (isSame || (change.operations.length === 0 && !drag.gesture)) return;
    drag.gesture ??= this.editor.gesture();
    // Where it began, it is as if nothing had been.
    drag.gesture.send(change.operations.length > 0 ? change.operations : [{ op: "moveKeys", keys: writable(this.editor, drag.set.keys), frames: 0 }]);
  }

  // Where two keys of a channel would come to one frame.
  private findClashes(): void {
    this.clashes.clear();
    const { set, channels, change } = this.drag!;
    if (!change || change.frameOf === unchanged.frameOf) return;
    for (const path of set.paths) {
      const masks = set.framesOf(path);
      const taken = new Set<number>();
      const clashes = new Set<number>();
      for (const { at } of channels.get(path)?.keys ?? []) {
        const frame = masks.has(at[0]) ? change.frameOf(at[0]) : at[0];
        if (taken.has(frame)) clashes.add(frame);
        taken.add(frame);
      }
      if (clashes.size > 0) this.clashes.set(path, clashes);
    }
  }

  private async end(modifiers: Modifiers): Promise<void> {
    const drag = this.drag!;
    drag.isOver = true;
    drag.letGo(modifiers);
    this.panel.values = drag.values;
    if (!drag.change) return this.over(drag);
    const isChanged = drag.change.operations.length > 0;
    if (isChanged && (await drag.gesture?.end()) === true) return this.answered(drag);
    await this.putBack(drag, isChanged ? undefined : drag.gesture?.cancel());
  }

  private async cancel(): Promise<void> {
    const { drag } = this;
    if (!drag || drag.isOver) return;
    drag.isOver = true;
    this.box.hidden = true;
    drag.putBack();
    this.panel.values = drag.values;
    await this.putBack(drag, drag.gesture?.cancel());
  }

  // All is drawn as it was, until the document and the scene say so too.
  private async putBack(drag: Drag, taken: Promise<unknown> | undefined): Promise<void> {
    if (!drag.gesture) return this.over(drag);
    drag.change = { ...unchanged, operations: [] };
    this.clashes.clear();
    this.movedOf.clear();
    this.movedSet = null;
    this.panel.draw();
    await taken;
    this.answered(drag);
  }

  private answered(drag: Drag): void {
    drag.isAnswered = true;
    this.settle();
  }

  private over(drag: Drag): void {
    if (this.drag !== drag) return;
    this.drag = null;
    this.clashes.clear();
    this.movedOf.clear();
    this.movedSet = null;
    this.panel.draw();
  }

  private get isSettled(): boolean {
    const { session, scene } = this.editor;
    return session.failures.length > 0 || !session.isAlive || scene.head?.revision === session.revision;
  }

  private settle(): void {
    const { drag } = this;
    if (!drag?.isAnswered || !this.isSettled) return;
    this.adopt(drag);
    this.over(drag);
  }

  // What was done counts: the choice and the focus stay with the keys.
  private adopt(drag: Drag): void {
    const frameOf = drag.change?.frameOf ?? unchanged.frameOf;
    if (frameOf === unchanged.frameOf) return;
    const frames = (frame: number, path: string) => (drag.set.framesOf(path).has(frame) ? frameOf(frame) : frame);
    [this.set, this.parted] = [this.set.at(frames), this.parted.at(frames)];
    this.buttons = new Map(
      [...this.buttons].map(([id, shown]) => {
        if (shown.held.kind !== "key") return [id, shown];
        const { path, frame, part } = shown.held.place;
        const place = { path, frame: frames(frame, path), part };
        return [`${path} ${part} ${place.frame}`, { ...shown, held: { kind: "key", place } }];
      }),
    );
  }

  // The next drag begins where the last one ends, also if the scene does not say so yet.
  private takeOver(): void {
    const { drag } = this;
    if (!drag) return;
    const settled = (channel: Channel) => ({ ...channel, keys: channel.keys.map((key) => ({ ...key, from: undefined })) });
    this.next = new Map(this.panel.shown.map((channel) => [channel.path, settled(this.moved(channel))]));
    this.adopt(drag);
    this.drag = null;
    this.movedOf.clear();
    this.movedSet = null;
  }

  // Keys

  private onKey(event: KeyboardEvent): void {
    const take = () => {
      event.preventDefault();
      event.stopPropagation();
    };
    const way = arrows[event.key];
    if ((event.key === "Delete" || event.key === "Backspace") && !this.set.isEmpty) {
      take();
      if (!this.drag || this.drag.isOver) void this.delete();
    } else if (way && !event.ctrlKey && !event.metaKey) {
      const shown = [...this.buttons.values()].find(({ element }) => element === document.activeElement);
      if (!shown) return;
      take();
      if (this.drag && !this.drag.isOver && this.drag.pointer !== null) return;
      if (!this.drag || this.drag.isOver) {
        if (event.repeat) return; // it was taken back
        this.takeOver();
        const { held } = [...this.buttons.values()].find(({ element }) => element === shown.element)!;
        this.begin(held, null, { x: 0, y: 0 }, event);
      }
      const { drag } = this;
      if (!drag) return;
      // A frame, or a hundredth of what is seen.
      const { frames, values, x, y } = drag.scales;
      const across = (x(1) - x(0)) * (shown.held.kind === "handle" ? (frames[1] - frames[0]) / 100 : 1) * (event.shiftKey && shown.held.kind === "handle" ? 0.1 : 1);
      const up = ((y(values[0]) - y(values[1])) / 100) * (event.shiftKey ? 0.1 : 1);
      drag.spot = { x: drag.spot.x + way[0] * across, y: drag.spot.y - way[1] * up };
      this.pull({ shiftKey: false, ctrlKey: false, altKey: false });
    }
  }

  private endByKeys(): void {
    if (this.drag && !this.drag.isOver && this.drag.pointer === null) void this.end({ shiftKey: false, ctrlKey: false, altKey: false });
  }

  // Ahead of everything else on the page: while something is pulled, Escape belongs to it.
  private stop(event: KeyboardEvent): void {
    if (event.key !== "Escape" || !this.drag || this.drag.isOver) return;
    event.preventDefault();
    event.stopPropagation();
    void this.cancel();
  }

  // Where the pointer is, other keys are held.
  private modify(event: KeyboardEvent): void {
    const { drag } = this;
    if (!modifierKeys.includes(event.key) || !drag?.hasMoved || drag.isOver || drag.pointer === null) return;
    event.preventDefault(); // Alt would open the browser's menu
    this.pull(event);
  }

  private openMenu(target: HTMLElement, place: Parameters<typeof openMenu>[2]): void {
    const shown = [...this.buttons.values()].find(({ element }) => element === target);
    if (this.drag?.hasMoved) return;
    void this.cancel();
    if (!shown || shown.held.kind === "scale") return;
    const { held } = shown;
    if (held.kind === "handle") {
      const words = this.editor.session.format.elements.find(({ name }) => name === "key")?.attributes.find(({ name }) => name === held.side)?.words ?? [];
      const keys = [{ channel: held.place.path, frames: [held.place.frame] }];
      return openMenu(`Tangent ${held.side}`, words.map((word) => ({ label: word, act: () => void this.editor.apply([{ op: "setTangent", keys, side: held.side, tangent: word }]) })), place);
    }
    if (!this.set.has(held.place)) {
      this.set = new KeySet();
      this.set.add(held.place);
      this.panel.draw();
    }
    openMenu("Keys", [
      { label: "Delete", keys: "Delete", act: () => void this.delete() },
      { label: this.isBroken ? "Join tangents" : "Break tangents", act: () => void this.toggleBreak() },
    ], place);
  }
}

function slopeOf({ key, tip }: Channel["handles"][number], part: number): number {
  return (tip[1 + part] - key[1 + part]) / (tip[0] - key[0]);
}

/** How far a handle rises, without the rounding of its tip. */
function riseOf({ key, tip }: Channel["handles"][number], part: number): number {
  const [from, to] = [key[1 + part], tip[1 + part]];
  return Number(rounded(to - from, stepOf(1e-12 * Math.max(Math.abs(from), Math.abs(to)))));
}

/** A tip with another slope of one component, as far from its key in time; `step`: to which it is rounded. */
function turned(tip: number[], slope: number, key: number[], part: number, step?: number): number[] {
  const rise = slope * (tip[0] - key[0]);
  return tip.map((each, k) => (k === 1 + part ? key[k] + Number(step ? rounded(rise, step) : rise.toPrecision(12)) : each));
}

function handleOperation(channel: string, side: Side, { key }: { key: number[] }, tip: number[]): Operation {
  return { op: "setHandle", channel, frame: key[0], side, handle: tip.map((each, k) => Number((each - key[k]).toPrecision(12))).join(" ") };
}

/** The two before the next key; handles ascend with their keys. */
function handlesAt(handles: Channel["handles"], frame: number): Channel["handles"] {
  const end = after(handles, frame, ({ key }) => key[0]);
  return handles.slice(Math.max(end - 2, 0), end);
}
