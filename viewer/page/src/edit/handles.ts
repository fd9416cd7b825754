// The handles of what is selected, over the view: elements that sit where things are drawn, and are pulled by pointers and
// keys.

import { element, make } from "../element";
import type { Axis } from "../stage";
import type { ThemeChoice } from "../theme";
import { setAttribute } from "./arrange";
import type { Editor } from "./editor";
import { handlesOf, type Handle } from "./handle";
import { onContextMenu, type MenuEntry } from "./menu";
import type { Recording } from "./recorder";
import type { Gesture, SceneObject } from "./session";
import { aside, between, Sight, type Spot } from "./sight";

export function mountHandles(editor: Editor, themes: ThemeChoice): void {
  const container = element<HTMLElement>("handles");
  const dress = () => {
    for (const ink of ["deformation", "force", "background"] as const) container.style.setProperty(`--${ink}`, themes.palette[ink]);
  };
  themes.onChange(dress);
  dress();
  new Handles(editor, container);
}

interface Shown {
  handle: Handle;
  element: HTMLElement;
  /** From where its value is drawn, so that handles are apart from each other. */
  aside: Spot;
}

/** Something that is being pulled. */
interface Drag {
  shown: Shown;
  /** Null: by keys. */
  pointer: number | null;
  /** Where the pointer was last. */
  last: Spot;
  spot: Spot;
  hasMoved: boolean;
  gesture: Gesture | null;
  recording: Recording | null;
}

type Modifiers = Pick<KeyboardEvent, "shiftKey" | "ctrlKey" | "altKey">;

const arrows: Record<string, Spot> = { ArrowLeft: { x: -1, y: 0 }, ArrowRight: { x: 1, y: 0 }, ArrowUp: { x: 0, y: -1 }, ArrowDown: { x: 0, y: 1 } };
/** A pointer that moves less than this only touches. [px] */
const leastMove = 2;
/** An axis key that is down for longer counts while it is held, otherwise for this drag or the next one. [ms] */
const longestPress = 300;

const axisNames: Axis[] = ["x", "y", "z"];

function axisOf({ key }: KeyboardEvent): Axis | null {
  return axisNames.find((axis) => axis === key.toLowerCase()) ?? null;
}

class Handles {
  private readonly sight: Sight;
  private readonly ofObject = new Map<string, { labels: string; shown: Shown[] }>();
  private drag: Drag | null = null;
  private readonly arrowsDown = new Set<string>();
  private axis: Axis | null = null;
  private axisDown: { axis: Axis; since: number } | null = null;

  constructor(
    private readonly editor: Editor,
    private readonly container: HTMLElement,
  ) {
    this.sight = new Sight(editor.viewer);
    editor.selection.onChange(() => this.update());
    editor.session.onChange(() => this.update());
    editor.viewer.stage.onDraw(() => this.place());
    document.addEventListener("keydown", (event) => this.onKey(event), true);
    document.addEventListener("keyup", (event) => this.onKeyUp(event), true);
    onContextMenu(container, (target, place) => {
      const shown = this.all.find(({ element }) => element === target);
      if (!shown || this.drag?.hasMoved) return;
      this.cancel();
      editor.openMenu(shown.handle.object, place, this.axisEntries(shown.handle));
    });
    // Over a handle one zooms as beside it.
    container.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        editor.viewer.stage.canvas.dispatchEvent(new WheelEvent(event.type, event));
      },
      { passive: false },
    );
  }

  private get all(): Shown[] {
    return [...this.ofObject.values()].flatMap(({ shown }) => shown);
  }

  // What is shown stays the same elements.
  private update(): void {
    const objects = this.editor.selection.names.map((name) => this.editor.session.object(name)).filter((each) => each !== undefined);
    const names = new Set(objects.map(({ name }) => name));
    for (const name of this.ofObject.keys()) if (!names.has(name)) this.remove(name);
    for (const object of objects) {
      const handles = handlesOf(this.editor, this.sight, object);
      const labels = handles.map(({ label }) => label).join("\n");
      if (this.ofObject.get(object.name)?.labels === labels) continue;
      this.remove(object.name);
      this.ofObject.set(object.name, { labels, shown: handles.map((handle) => this.show(handle, object)) });
    }
    this.place();
  }

  private remove(name: string): void {
    const shown = this.ofObject.get(name)?.shown ?? [];
    if (this.drag && shown.includes(this.drag.shown)) this.cancel();
    for (const { element } of shown) element.remove();
    this.ofObject.delete(name);
  }

  private show(handle: Handle, { kind }: SceneObject): Shown {
    const made = make("div", { className: "handle", role: "slider", tabIndex: 0, ariaLabel: handle.label });
    Object.assign(made.dataset, { kind: handle.kind, of: kind });
    if (/^Deformation/.test(handle.label) || kind === "group") made.dataset.ink = "deformation";
    const shown = { handle, element: made, aside: { x: 0, y: 0 } };
    made.addEventListener("pointerdown", (event) => this.press(shown, event));
    made.addEventListener("pointermove", (event) => this.move(event));
    made.addEventListener("pointerup", (event) => {
      if (this.drag?.pointer !== event.pointerId) return;
      const { hasMoved, recording } = this.drag;
      void this.end();
      if (!hasMoved && !recording) this.editor.pick(event, handle.object);
    });
    made.addEventListener("pointercancel", (event) => {
      if (this.drag?.pointer === event.pointerId) this.cancel();
    });
    made.addEventListener("keydown", (event) => this.pullByKey(shown, event));
    made.addEventListener("blur", ({ relatedTarget }) => {
      if (this.drag?.pointer === null) void this.end();
      if (!(relatedTarget instanceof Element && relatedTarget.matches(".handle"))) this.axis = this.axisDown = null;
      this.place();
    });
    this.container.append(made);
    return shown;
  }

  // Elements to where their things are seen; those that would cover others give way.
  private place(): void {
    const { width, height } = this.sight.size;
    const room = matchMedia("(pointer: coarse)").matches ? 42 : 26;
    const taken: Spot[] = [];
    for (const shown of this.all) {
      const { handle, element } = shown;
      const place = handle.place;
      const spot = place && this.sight.seen(place);
      const isInside = spot && spot.x >= 0 && spot.y >= 0 && spot.x <= width && spot.y <= height;
      const isHeld = this.drag?.shown === shown;
      element.hidden = !isHeld && !isInside && document.activeElement !== element;
      if (!spot) continue;
      if (!isHeld) shown.aside = aside(spot, handle.outwards, taken, room);
      const there = { x: spot.x + shown.aside.x, y: spot.y + shown.aside.y };
      taken.push(there);
      element.style.transform = `translate(${Math.round(there.x)}px, ${Math.round(there.y)}px)`;
      this.describe(shown);
    }
  }

  private describe({ handle, element }: Shown): void {
    setAttribute(element, "aria-valuetext", handle.text);
    setAttribute(element, "aria-valuenow", String(handle.numbers[0] ?? 0));
    setAttribute(element, "aria-disabled", String(handle.obstacle !== "" || !this.editor.session.isAlive));
    element.toggleAttribute("data-held", this.drag?.shown.element === element && this.drag.hasMoved);
    setAttribute(element, "data-axis", document.activeElement === element ? this.axis : null);
  }

  // The same as their keys, without a keyboard.
  private axisEntries({ kind }: Handle): MenuEntry[] {
    if (kind !== "move" && kind !== "direction") return [];
    return axisNames.map((axis) => ({
      label: `Drag along ${axis}`,
      keys: axis.toUpperCase(),
      act: () => {
        this.axis = axis;
        this.place();
      },
    }));
  }

  // Pointers

  private press(shown: Shown, event: PointerEvent): void {
    if (event.button !== 0 || this.drag) return;
    event.preventDefault();
    shown.element.focus({ preventScroll: true });
    if (!this.begin(shown, event.pointerId, this.sight.spotOf(event))) return;
    shown.element.setPointerCapture(event.pointerId);
  }

  private move(event: PointerEvent): void {
    const { drag } = this;
    if (!drag || drag.pointer !== event.pointerId) return;
    const spot = this.sight.spotOf(event);
    if (!drag.hasMoved) {
      if (between(spot, drag.last) < leastMove) return;
      if (this.isHindered(drag.shown)) return this.cancel();
    }
    this.shift((spot.x - drag.last.x) * shareOf(event), (spot.y - drag.last.y) * shareOf(event));
    drag.last = spot;
    this.pull(event);
  }

  // Keys

  private pullByKey(shown: Shown, event: KeyboardEvent): void {
    const way = arrows[event.key];
    if (!way || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    if (this.drag && this.drag.pointer !== null) return;
    if (event.repeat && !this.drag) return; // it was taken back
    if (!this.drag && (this.isHindered(shown) || !this.begin(shown, null, { x: 0, y: 0 }))) return;
    this.arrowsDown.add(event.key);
    const place = shown.handle.place!;
    const step = ((this.editor.viewer.reach / 100) * shareOf(event)) / this.sight.pixelAt(place);
    const line = shown.handle.isLine ? shown.handle.outwards : null;
    const along = line ? step * (way.x - way.y) : 0;
    this.shift(line ? along * line.x : step * way.x, line ? along * line.y : step * way.y);
    this.pull({ shiftKey: false, ctrlKey: false, altKey: false });
  }

  // Ahead of everything else on the page: while something is pulled, keys belong to it.
  private onKey(event: KeyboardEvent): void {
    const isByPointer = this.drag !== null && this.drag.pointer !== null;
    const isFree = !event.ctrlKey && !event.metaKey && !event.altKey && !(event.target as HTMLElement).matches("input, select, textarea");
    const axis = axisOf(event);
    if (axis && (isByPointer || isFree) && !event.repeat) {
      this.axis = this.axis === axis ? null : axis;
      this.axisDown = { axis, since: performance.now() };
      this.place();
    }
    if (!this.drag) return;
    if (event.key === "Escape") this.cancel();
    else if (!isByPointer) return;
    event.preventDefault();
    event.stopPropagation();
    if (this.drag?.hasMoved) this.pull(event);
  }

  private onKeyUp(event: KeyboardEvent): void {
    const axis = axisOf(event);
    if (axis && this.axisDown?.axis === axis) {
      const isPressed = performance.now() - this.axisDown.since <= longestPress;
      const isWanted = this.drag !== null || (document.activeElement?.matches(".handle") ?? false);
      this.axisDown = null;
      if (!isPressed || !isWanted) this.axis = null;
      this.place();
    }
    const { drag } = this;
    if (!drag) return;
    if (drag.pointer !== null) {
      if (event.key === "Alt") event.preventDefault(); // it would open the browser's menu
      if (drag.hasMoved) this.pull(event);
    } else if (this.arrowsDown.delete(event.key) && this.arrowsDown.size === 0) {
      void this.end();
    }
  }

  // One gesture

  private begin(shown: Shown, pointer: number | null, last: Spot): boolean {
    this.editor.playback.pause();
    shown.handle.begin();
    const place = shown.handle.place;
    const spot = place && this.sight.seen(place);
    if (!spot) return false;
    const drag: Drag = (this.drag = { shown, pointer, last, spot, hasMoved: false, gesture: null, recording: null });
    if (!this.editor.recorder.isOn) return true;
    drag.recording = this.isHindered(shown) ? null : this.record(drag);
    if (!drag.recording) this.cancel();
    return drag.recording !== null;
  }

  private record(drag: Drag): Recording | null {
    const { facts, text } = drag.shown.handle;
    const letGo = () => {
      if (this.drag === drag) void this.end();
    };
    return this.editor.recorder.begin({ attributes: facts ? [facts] : [], text, part: null, tell: (refusal) => this.editor.say(refusal), letGo });
  }

  private isHindered({ handle: { obstacle } }: Shown): boolean {
    if (obstacle !== "") this.editor.say(obstacle);
    return obstacle !== "";
  }

  private shift(x: number, y: number): void {
    const { spot } = this.drag!;
    this.drag!.spot = { x: spot.x + x, y: spot.y + y };
    this.drag!.hasMoved = true;
  }

  private pull({ ctrlKey, altKey }: Modifiers): void {
    const drag = this.drag!;
    const { handle } = drag.shown;
    const isChanged = handle.pull({ spot: drag.spot, axis: this.axis, snap: ctrlKey ? "vertex" : altKey ? "surface" : null });
    this.place();
    if (!isChanged) return;
    if (drag.recording) return drag.recording.hold(handle.text);
    drag.gesture ??= this.editor.gesture();
    drag.gesture.send(handle.operations());
  }

  private async end(): Promise<void> {
    const drag = this.over();
    const held = drag?.recording ?? drag?.gesture;
    if (drag) this.letGo(drag, held ? await held.end() : false);
  }

  private cancel(): void {
    const drag = this.over();
    if (!drag) return;
    this.letGo(drag, false);
    void (drag.recording ?? drag.gesture)?.cancel();
  }

  private letGo({ shown }: Drag, isTaken: boolean): void {
    if (this.drag?.shown !== shown) shown.handle.letGo(isTaken);
    this.place();
  }

  private over(): Drag | null {
    const { drag } = this;
    this.drag = null;
    this.arrowsDown.clear();
    // One that is still down counts until it is let go.
    if (this.axisDown) this.axisDown.since = -Infinity;
    else this.axis = null;
    return drag;
  }
}

/** With Shift things go a tenth as far. */
const shareOf = ({ shiftKey }: { shiftKey: boolean }) => (shiftKey ? 0.1 : 1);
