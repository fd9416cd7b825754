// What the parts of the editor share: the document, what is selected, the playhead, and the one way to change a value.

import type { Channel } from "../bake";
import { Changing } from "../changing";
import { after } from "../curve_plot";
import type { Playback } from "../playback";
import type { Viewer } from "../viewer";
import type { SavePost } from "./disk_dialogs";
import type { LiveScene } from "./live_scene";
import type { MenuEntry, MenuPlace } from "./menu";
import { Recorder } from "./recorder";
import { Selection } from "./selection";
import { Gesture, type AttributeFacts, type Operation, type SceneObject, type Session } from "./session";

const axes = ["x", "y", "z"];

/** The numbers of a channel at a frame. */
export function numbersAt({ points }: Channel, frame: number): number[] | undefined {
  if (points.length === 0) return undefined;
  // Of two at one frame, the curve jumps there, the second counts.
  return points[after(points, Math.max(frame, points[0][0])) - 1].slice(1);
}

export class Editor extends Changing {
  readonly selection: Selection;
  readonly recorder: Recorder;
  private keys = false;

  constructor(
    readonly session: Session,
    readonly scene: LiveScene,
    readonly viewer: Viewer,
  ) {
    super();
    this.selection = new Selection(session);
    this.recorder = new Recorder(this);
  }

  get playback(): Playback {
    return this.viewer.playback;
  }

  /** Whether a change of a constant channel makes a key too. */
  get hasAutoKey(): boolean {
    return this.keys;
  }

  set hasAutoKey(isOn: boolean) {
    this.keys = isOn;
    this.tell();
  }

  /** The value of an attribute at the frame shown, as a file says it: that of its curve, or its constant. */
  textOf({ path, value, animated }: AttributeFacts): string {
    return animated ? (this.numbersOf(path) ?? []).map(String).join(" ") : value;
  }

  /** The numbers of an animated channel at the frame shown. */
  numbersOf(path: string, frame = this.playback.frame): number[] | undefined {
    const channel = this.channel(path);
    return channel && numbersAt(channel, frame);
  }

  /** An animated channel. */
  channel(path: string): Channel | undefined {
    return this.scene.head?.channels.find((channel) => channel.path === path);
  }

  /** Whether what moves it is known, and no curve. */
  hasNoCurve(path: string): boolean {
    const { head } = this.scene;
    return head?.revision === this.session.facts.revision && head.channels.every((channel) => channel.path !== path);
  }

  /** Frames of the keys of a channel. */
  keysOf(path: string): number[] {
    return this.channel(path)?.keys.map(({ at }) => at[0]) ?? [];
  }

  /** Whether it has a key at the frame shown. What is constant has none, also while the scene before is shown. */
  hasKeyHere({ path, animated }: AttributeFacts): boolean {
    return animated && this.keysOf(path).includes(this.playback.frame);
  }

  /** What gives an attribute a value at the frame shown: a key if it is animated, or if constants get keys too. */
  toSet({ path, animated, components }: AttributeFacts, value: string): Operation {
    return components > 0 && (animated || this.keys) ? { op: "setKey", channel: path, frame: this.playback.frame, value } : { op: "set", path, value };
  }

  /** The same of one of some components. */
  toSetComponent(attribute: AttributeFacts, component: number, value: string, count = 3): Operation {
    const { path, animated, components } = attribute;
    const numbers = this.textOf(attribute).trim().split(/\s+/).filter(Boolean);
    const isKnown = numbers.length === count;
    const makesKey = animated || (this.keys && components > 0);
    // The other components of a constant stay as they are written. Those of a curve must be known.
    if (count === axes.length && (makesKey ? animated && !isKnown : isKnown)) return { op: "set", path: `${path}.${axes[component]}`, value };
    const all = Array.from({ length: count }, (_, k) => (k === component ? value : (numbers[k] ?? "0")));
    return this.toSet(attribute, all.join(" "));
  }

  /** What the command warns of at an object. */
  warningsAt({ lines: [first, last], file }: SceneObject): string[] {
    const messages = this.scene.head?.messages ?? [];
    const isAt = (line: number, where?: string) => line >= first && line <= last && where === file;
    return messages.filter((each) => each.kind === "warning" && isAt(each.line, each.file)).map(({ text }) => text);
  }

  /** One whose refusals are told in the page. */
  gesture(): Gesture {
    return new Gesture(this.session, (refusal) => this.say(refusal));
  }

  /** Makes operations as one step, and returns whether they are made; a refusal is told in the page. */
  async apply(operations: Operation[], name?: string): Promise<boolean> {
    if (operations.length === 0) return false;
    try {
      await this.session.apply(operations, name);
      this.say("");
      return true;
    } catch (error) {
      this.say((error as Error).message);
      return false;
    }
  }

  /** A message about what was just tried; empty: none. */
  say: (message: string) => void = () => {};

  /** Opens the menu of an object at a place in the window; `more` stands above the others. */
  openMenu: (object: string, place: MenuPlace, more?: MenuEntry[]) => void = () => {};

  /** Selects what is drawn where a handle of an object was clicked. */
  pick: (event: PointerEvent, handleOf: string) => void = () => {};

  /** Saves the document; asks for what only a person can decide. */
  save: () => void = () => {};

  /** Asks for the file of what `post` saves. */
  askForFile: (file: string, post: SavePost) => void = () => {};

  /** Whether it stands in the file that is edited. */
  canChange(object: SceneObject): boolean {
    return object.file === undefined;
  }
}
