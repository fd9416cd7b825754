// The keys on the timeline, as buttons over its marks: those of what is selected, or all.

import type { Channel } from "../bake";
import { make } from "../element";
import type { FrameAxis } from "../frame_axis";
import type { Timeline } from "../timeline";
import type { Editor } from "./editor";
import { deleteKeys, readOnly, writable, type KeysOf } from "./key_set";
import type { Gesture } from "./session";

/** With more of them there are no buttons. */
const mostButtons = 500;
const leastMove = 3; // [px]
const leastWidth = 6; // [px]

/** Frames that are being moved, among those when it began. */
interface Drag {
  button: HTMLButtonElement;
  frame: number;
  all: number[];
  channels: Channel[];
  withLater: boolean;
  by: number;
  /** Null: by arrow keys. */
  pointer: { id: number; from: number } | null;
  hasMoved: boolean;
  gesture: Gesture | null;
  /** It was let go. */
  isOver: boolean;
  /** The document has answered; it waits for the scene to say so too. */
  isAnswered: boolean;
}

export class TimelineKeys {
  private readonly place = make("div", { className: "timeline-keys", role: "group", ariaLabel: "Keys" });
  private readonly buttons = new Map<number, HTMLButtonElement>();
  private pressed: number | null = null;
  private justDragged = false;
  private drag: Drag | null = null;

  constructor(
    private readonly editor: Editor,
    canvas: HTMLCanvasElement,
    private readonly timeline: Timeline,
    private readonly axis: FrameAxis,
  ) {
    canvas.after(this.place);
    editor.selection.onChange(() => {
      this.pressed = null;
      this.update();
    });
    editor.session.onChange(() => this.update());
    editor.scene.onChange((isNew) => {
      if (isNew) this.update();
    });
    editor.scene.onProgress(() => {
      timeline.ready = editor.scene.readyNow;
      timeline.draw();
    });
    editor.playback.onChange(() => this.settle());
    new ResizeObserver(() => this.update()).observe(canvas);
  }

  /** The keys at the frame that is pressed or has the focus. */
  get chosen(): KeysOf[] {
    const frame = this.focused ?? this.pressed;
    return frame === null ? [] : keysAt([frame], this.channels);
  }

  /** Keys are chosen, and the focus says nothing else. */
  get isMeant(): boolean {
    const { activeElement } = document;
    const isElsewhere = activeElement !== null && activeElement !== document.body && !activeElement.matches("#view, #timeline");
    return this.focused !== null || (this.pressed !== null && !isElsewhere);
  }

  delete(): Promise<void> {
    return deleteKeys(this.editor, this.chosen);
  }

  private get focused(): number | null {
    return [...this.buttons].find(([, button]) => button === document.activeElement)?.[0] ?? null;
  }

  /** Of what is selected, groups with what is in them, or all, as far as they have been moved. */
  private get channels(): Channel[] {
    if (this.drag) return this.drag.channels.map((channel) => ({ ...channel, keys: channel.keys.map((key) => ({ ...key, at: [this.moved(key.at[0]), ...key.at.slice(1)] })) }));
    const channels = this.editor.scene.head?.channels ?? [];
    const { selection, session } = this.editor;
    if (selection.names.length === 0) return channels;
    const names = session.objects.filter(({ name, group }) => selection.has(name) || (group !== undefined && selection.has(group))).map(({ name }) => name);
    return channels.filter(({ path }) => names.some((name) => path.startsWith(`${name}.`)));
  }

  private update(): void {
    const { drag } = this;
    if (drag?.isAnswered && this.isSettled) this.drag = null;
    const frames = framesOf(this.channels);
    if (this.pressed !== null && !frames.includes(this.pressed)) this.pressed = null;
    const { first, last } = this.editor.playback;
    const inWindow = [...new Set(frames)].filter((frame) => frame >= first && frame <= last).sort((a, b) => a - b);
    this.timeline.keyFrames = this.drag ? this.drag.all.filter((frame) => !this.isMoved(frame)) : frames;
    this.timeline.draw();
    const shown = inWindow.length > mostButtons ? inWindow.filter((frame) => this.drag && this.buttons.get(frame) === this.drag.button) : inWindow;
    for (const [frame, button] of this.buttons) {
      if (shown.includes(frame)) continue;
      const next = shown.find((each) => each > frame && this.buttons.has(each)) ?? shown.findLast((each) => each < frame && this.buttons.has(each));
      const hadFocus = button === document.activeElement;
      button.remove();
      this.buttons.delete(frame);
      if (hadFocus && next !== undefined) this.buttons.get(next)!.focus();
    }
    const width = matchMedia("(pointer: coarse)").matches ? 40 : 24; // [px]
    shown.forEach((frame, k) => {
      const button = this.buttons.get(frame) ?? this.newButton(frame);
      // Where marks are near each other, each has its part.
      const gap = this.axis.perFrame * Math.min(frame - (shown[k - 1] ?? -Infinity), (shown[k + 1] ?? Infinity) - frame);
      const { x, y } = this.timeline.placeOf(frame);
      button.style.left = `${x}px`;
      button.style.top = `${y}px`;
      button.style.width = `${Math.max(Math.min(width, gap), leastWidth)}px`;
      const isHeld = this.drag !== null && this.isMoved(frame - this.drag.by) && this.drag.all.includes(frame - this.drag.by);
      button.toggleAttribute("data-held", isHeld);
      this.describe(frame, button);
    });
  }

  private describe(frame: number, button: HTMLButtonElement): void {
    const label = `Keys at ${frame}`;
    if (button.title !== label) {
      button.title = label;
      button.setAttribute("aria-label", label);
    }
    button.setAttribute("aria-pressed", String(this.pressed === frame));
  }

  private newButton(frame: number): HTMLButtonElement {
    const button = make("button", { type: "button" });
    const frameNow = () => [...this.buttons].find(([, each]) => each === button)?.[0];
    button.addEventListener("pointerdown", (event) => this.press(button, frameNow(), event));
    button.addEventListener("pointermove", (event) => this.move(event));
    button.addEventListener("pointerup", (event) => {
      if (this.drag?.pointer?.id === event.pointerId) void this.end();
    });
    button.addEventListener("pointercancel", (event) => {
      if (this.drag?.pointer?.id === event.pointerId) void this.cancel();
    });
    // A drag ends with a click, too; those of keys have no detail.
    button.addEventListener("click", ({ detail }) => (detail === 0 || !this.justDragged) && this.choose(frameNow()));
    button.addEventListener("keydown", (event) => this.onKey(button, frameNow(), event));
    for (const name of ["keydown", "keyup"] as const) {
      button.addEventListener(name, (event) => {
        if (event.key !== "Alt" || !this.drag?.pointer || !this.drag.hasMoved || this.drag.isOver) return;
        event.preventDefault(); // it would open the browser's menu
        this.moveBy(this.drag.by, event.altKey);
      });
    }
    button.addEventListener("keyup", (event) => {
      if (event.key.startsWith("Arrow") && this.drag && !this.drag.pointer && !this.drag.isOver) void this.end();
    });
    button.addEventListener("blur", () => {
      if (this.drag && !this.drag.pointer && !this.drag.isOver) void this.end();
    });
    this.buttons.set(frame, button);
    // In their order, which is that of the Tab key.
    const next = [...this.buttons].filter(([each]) => each > frame).sort(([a], [b]) => a - b)[0]?.[1];
    this.place.insertBefore(button, next ?? null);
    return button;
  }

  private choose(frame: number | undefined): void {
    if (frame === undefined) return;
    this.editor.playback.pause();
    this.editor.playback.goTo(frame);
    this.pressed = frame;
    this.update();
  }

  private press(button: HTMLButtonElement, frame: number | undefined, event: PointerEvent): void {
    this.justDragged = false;
    if (event.button !== 0 || frame === undefined || (this.drag && !this.drag.isOver)) return;
    button.focus({ preventScroll: true });
    button.setPointerCapture(event.pointerId);
    this.begin(button, frame, { id: event.pointerId, from: event.clientX });
  }

  private move(event: PointerEvent): void {
    const { drag } = this;
    if (!drag || drag.isOver || drag.pointer?.id !== event.pointerId) return;
    const far = event.clientX - drag.pointer.from;
    if (!drag.hasMoved && Math.abs(far) < leastMove) return;
    drag.hasMoved = true;
    const { first, last } = this.editor.playback;
    const target = Math.min(Math.max(Math.round(drag.frame + far / this.axis.perFrame), first), last);
    this.moveBy(target - drag.frame, event.altKey);
  }

  private onKey(button: HTMLButtonElement, frame: number | undefined, event: KeyboardEvent): void {
    const take = () => {
      event.preventDefault();
      event.stopPropagation();
    };
    if (event.key === "Escape" && this.drag && !this.drag.isOver) {
      take();
      void this.cancel();
    } else if ((event.key === "Delete" || event.key === "Backspace") && frame !== undefined) {
      take();
      if (!this.drag || this.drag.isOver) void this.delete();
    } else if ((event.key === "ArrowLeft" || event.key === "ArrowRight") && frame !== undefined && !event.ctrlKey && !event.metaKey) {
      take();
      if (this.drag?.pointer && !this.drag.isOver) return;
      if (!this.drag || this.drag.isOver) {
        if (event.repeat) return; // it was taken back
        this.begin(button, frame, null);
      }
      const { drag } = this;
      if (!drag) return;
      drag.hasMoved = true;
      const way = event.key === "ArrowLeft" ? -1 : 1;
      // From between frames it goes to a whole one.
      const target = way < 0 ? Math.ceil(drag.frame + drag.by) - 1 : Math.floor(drag.frame + drag.by) + 1;
      const { first, last } = this.editor.playback;
      this.moveBy(Math.min(Math.max(target, first), last) - drag.frame, event.altKey);
    }
  }

  // One gesture

  private begin(button: HTMLButtonElement, frame: number, pointer: Drag["pointer"]): void {
    const { channels } = this;
    this.drag = { button, frame, all: framesOf(channels), channels, withLater: false, by: 0, pointer, hasMoved: false, gesture: null, isOver: false, isAnswered: false };
  }

  private moveBy(by: number, withLater: boolean): void {
    const drag = this.drag!;
    if (by === drag.by && withLater === drag.withLater) return;
    const framesBefore = new Map(drag.all.map((frame) => [frame, this.buttons.get(this.moved(frame))]));
    [drag.by, drag.withLater] = [by, withLater];
    const frames = drag.all.filter((frame) => this.isMoved(frame));
    const keys = writable(this.editor, keysAt(frames, drag.channels));
    if (keys.length === 0) {
      drag.by = 0;
      return this.editor.say(readOnly);
    }
    // The buttons go with their frames.
    this.buttons.clear();
    for (const [frame, button] of framesBefore) {
      if (!button) continue;
      const there = this.buttons.get(this.moved(frame));
      if (there && there !== button) (frame === drag.frame ? there : button).remove();
      if (!there || frame === drag.frame) this.buttons.set(this.moved(frame), button);
    }
    if (this.pressed !== null) this.pressed = drag.frame + drag.by;
    this.update();
    drag.gesture ??= this.editor.gesture();
    drag.gesture.send([{ op: "moveKeys", keys, frames: by }]);
  }

  private async end(): Promise<void> {
    const drag = this.drag!;
    this.justDragged = drag.hasMoved;
    drag.isOver = true;
    if (drag.by === 0) await drag.gesture?.cancel();
    else if (!(await drag.gesture?.end())) this.back(drag);
    drag.isAnswered = true;
    this.update();
  }

  private async cancel(): Promise<void> {
    const drag = this.drag!;
    drag.isOver = this.justDragged = true;
    this.back(drag);
    this.update();
    await drag.gesture?.cancel();
    drag.isAnswered = true;
    this.update();
  }

  // The dragged button to where it was, so that it keeps the focus.
  private back(drag: Drag): void {
    if (this.drag !== drag || drag.by === 0) return;
    this.buttons.delete(drag.frame + drag.by);
    this.buttons.get(drag.frame)?.remove();
    this.buttons.set(drag.frame, drag.button);
    if (this.pressed !== null) this.pressed = drag.frame;
    [drag.by, drag.withLater] = [0, false];
  }

  private settle(): void {
    if (this.drag?.isAnswered && this.isSettled) this.update();
  }

  private get isSettled(): boolean {
    const { session, scene } = this.editor;
    return session.failures.length > 0 || !session.isAlive || scene.head?.revision === session.revision;
  }

  private isMoved(frame: number): boolean {
    const drag = this.drag!;
    return frame === drag.frame || (drag.withLater && frame > drag.frame);
  }

  private moved(frame: number): number {
    return this.isMoved(frame) ? frame + this.drag!.by : frame;
  }
}

const framesOf = (channels: Channel[]) => [...new Set(channels.flatMap(({ keys }) => keys.map(({ at }) => at[0])))].sort((a, b) => a - b);

/** The keys of channels at some frames. */
function keysAt(frames: number[], channels: Channel[]): KeysOf[] {
  const there = new Set(frames);
  const all = channels.map(({ path, keys }) => ({ channel: path, frames: keys.map(({ at }) => at[0]).filter((frame) => there.has(frame)) }));
  return all.filter((each) => each.frames.length > 0);
}
