// Recordings: what a hand gives a channel while time runs becomes its keys; docs/editor.md, "Perform".

import type { Channel } from "../bake";
import { Changing } from "../changing";
import { numbersAt, type Editor } from "./editor";
import { Gesture, type AttributeFacts, type Operation } from "./session";

/** What a hand gave a channel. */
export interface Recorded {
  path: string;
  first: number;
  last: number;
  /** Its curve before; null: it was constant. */
  before: Channel | null;
  /** The numbers of each frame from `first` to `last`. */
  raw: number[][];
}

/** What a hand takes hold of. */
export interface Grip {
  /** All get its values. */
  attributes: AttributeFacts[];
  /** The component that it moves; null: the whole value. */
  part: number | null;
  /** Its value at first, if the page may not show that yet. */
  text?: string;
  /** Gets what is refused, or an empty text. */
  tell: (refusal: string) => void;
  /** Time is over: ends it as the hand does. */
  letGo: () => void;
}

/** A channel and its values, as texts. */
interface Track {
  attribute: AttributeFacts;
  before: Channel | null;
  start: string;
  texts: string[];
}

const wordsOf = (text: string) => text.trim().split(/\s+/).filter(Boolean);

/** One step of the document, from when a hand takes hold of something. */
export class Recording {
  /** The revision that it made last. */
  revision = -1;
  isOver = false;
  readonly first: number;
  private readonly tracks: Track[];
  private readonly since = performance.now();
  private readonly speed: number;
  private readonly gesture: Gesture;
  /** Null: each has its own. */
  private held: string | null;
  private isMoved = false;
  private sentFrames = 0;
  private sending: Promise<void> | null = null;
  private answer = (_refusal: string) => {};
  /** Whether it begins with a key that keeps the curve before it. Not all curves can have one. */
  private keepsPast = true;

  constructor(
    private readonly editor: Editor,
    private readonly grip: Grip,
    private readonly recorder: Recorder,
  ) {
    const { session, playback } = editor;
    playback.pause();
    this.speed = recorder.speed;
    this.first = playback.frame;
    this.held = grip.text ?? null;
    this.tracks = grip.attributes.map((attribute) => ({ attribute, before: (attribute.animated && editor.channel(attribute.path)) || null, start: editor.textOf(attribute), texts: [] }));
    const take = ({ revision }: { revision: number }) => {
      this.revision = revision;
      playback.goTo(this.first + this.sentFrames - 1);
    };
    this.gesture = new Gesture(session, (refusal) => this.answer(refusal), take, `record ${this.paths}`);
    this.advance();
    requestAnimationFrame(this.tick);
  }

  get channels(): string[] {
    return this.tracks.map(({ attribute }) => attribute.path);
  }

  get paths(): string {
    return this.channels.join(", ");
  }

  /** The newest frame that passed. */
  get last(): number {
    return this.first + this.tracks[0].texts.length - 1;
  }

  get recorded(): Recorded[] {
    const { first, last } = this;
    return this.tracks.map(({ attribute: { path }, before, texts }) => ({ path, first, last, before, raw: texts.map((text) => wordsOf(text).map(Number)) }));
  }

  get isSending(): boolean {
    return this.sending !== null;
  }

  /** Has this value from now on. */
  hold(text: string): void {
    if (this.isOver) return;
    this.advance();
    this.held = text;
    this.isMoved = true;
  }

  /** Lets go of it, and tells whether the document has what was recorded. */
  end(): Promise<boolean> {
    if (!this.isOver) this.advance();
    this.isOver = true;
    const isClick = !this.isMoved && this.last === this.first && this.last < this.editor.playback.last;
    return this.editor.session.hold(isClick ? this.cancel().then(() => true) : this.finish());
  }

  /** Ends it as the hand does. */
  stop(): void {
    this.grip.letGo();
  }

  /** Takes everything back, as if it had never been. */
  async cancel(): Promise<void> {
    this.isOver = true;
    this.answer = this.grip.tell;
    this.recorder.forget(this);
    await this.gesture.cancel();
    this.editor.playback.goTo(this.first);
  }

  /** The same step, simplified to another tolerance. */
  async simplify(tolerance: number): Promise<void> {
    this.sending = this.gesture.amend(this.operations(tolerance), this.revision).then(({ revision }) => void (this.revision = revision));
    await this.sending.finally(() => (this.sending = null));
  }

  private async finish(): Promise<boolean> {
    await this.sending;
    // No later frame tells what the hand did.
    if (this.last === this.first) for (const track of this.tracks) track.texts[0] = this.textAt(track, this.first);
    await this.send(this.recorder.tolerance);
    const isTaken = await this.gesture.end();
    if (isTaken) this.recorder.keep(this);
    else this.recorder.forget(this);
    return isTaken;
  }

  // The frames that have passed have the value from before.
  private advance(): void {
    const { first, editor } = this;
    const passed = Math.floor(((performance.now() - this.since) / 1000) * editor.playback.fps * this.speed);
    const newest = Math.min(first + passed, editor.playback.last);
    for (let frame = this.last + 1; frame <= newest; ++frame) for (const track of this.tracks) track.texts.push(this.textAt(track, frame));
  }

  // What is not held goes on as it did.
  private textAt({ attribute, before, start }: Track, frame: number): string {
    const { held, grip } = this;
    if (grip.part === null) return held ?? start;
    const [own, others] = [wordsOf(start), before ? numbersAt(before, frame)!.map(String) : wordsOf(start)];
    const length = Math.max(others.length, attribute.components);
    return Array.from({ length }, (_, k) => (k === grip.part ? (held ?? own[k]) : others[k]) ?? "0").join(" ");
  }

  // A slow scene shows each frame that is sent; time goes on meanwhile.
  private readonly tick = () => {
    if (this.isOver) return;
    const { scene, session, playback } = this.editor;
    this.advance();
    this.recorder.goOn();
    if (this.last === playback.last || !session.isAlive) return this.stop();
    const isSeen = this.sentFrames === 0 || session.failures.length > 0 || scene.shown.isExact;
    if (!this.isSending && isSeen && this.first + this.sentFrames <= this.last) void this.send(0);
    requestAnimationFrame(this.tick);
  };

  private send(tolerance: number): Promise<void> {
    this.sending = this.sendAll(tolerance);
    return this.sending.finally(() => (this.sending = null));
  }

  private async sendAll(tolerance: number): Promise<void> {
    this.sentFrames = this.tracks[0].texts.length;
    const refusal = () =>
      new Promise<string>((resume) => {
        this.answer = resume;
        this.gesture.send(this.operations(tolerance));
      });
    let reason = await refusal();
    if (reason !== "" && this.keepsPast) {
      this.keepsPast = false;
      reason = await refusal();
    }
    this.answer = this.grip.tell;
    this.grip.tell(reason);
  }

  private operations(tolerance: number): Operation[] {
    return this.tracks.flatMap((track) => this.operationsOf(track, tolerance));
  }

  private operationsOf({ attribute: { path }, before, start, texts }: Track, tolerance: number): Operation[] {
    const { first, last } = this;
    const spliced = (from: number): Operation => {
      const keys = texts.slice(from - first).map((value, k) => `<key frame="${from + k}" value="${value}" interpolation="linear"/>`);
      return { op: "splice", channel: path, first: from, last, curve: `<animate attribute="${path.split(".").pop()}">${keys.join("")}</animate>` };
    };
    const operations: Operation[] = [];
    if (before && this.keepsPast) {
      operations.push({ op: "setKey", channel: path, frame: first, ...(texts[0] === start ? {} : { value: texts[0] }) });
      if (last > first) operations.push(spliced(first + 1));
      operations.push({ op: "setInterpolation", keys: [{ channel: path, frames: [first] }], interpolation: "linear" });
    } else {
      operations.push(spliced(first));
    }
    if (tolerance > 0 && last > first) operations.push({ op: "simplifyKeys", channels: [path], tolerance: tolerance * (rangeOf(texts) || 1e-9), first, last });
    return operations;
  }
}

/** The largest range of a component. */
function rangeOf(texts: string[]): number {
  const rows = texts.map((text) => wordsOf(text).map(Number));
  return Math.max(...rows[0].map((_, k) => Math.max(...rows.map((row) => row[k])) - Math.min(...rows.map((row) => row[k]))));
}

/** Tells when a recording goes on, ends, or cannot be changed any more. */
export class Recorder extends Changing {
  /** Of time, while something is recorded. */
  speed = 1;
  private isWanted = false;
  /** The one that runs, or made the last step. */
  private newest: Recording | null = null;
  /** Those that ended, the newest one last. */
  private kept: Recording[] = [];
  private share = 0.01;
  private isChanging = false;
  /** Of each channel of the newest one. */
  private keyCounts: number[] = [];
  private hasStopped = false;

  constructor(private readonly editor: Editor) {
    super();
    const { session, scene, playback } = editor;
    session.onNewer((revision) => {
      const { newest } = this;
      if (newest?.isOver && !newest.isSending && revision !== newest.revision) this.forget(newest);
    });
    scene.onChange((isNew) => {
      if (isNew) this.count();
    });
    playback.onChange(() => {
      if (this.isRunning && playback.isPlaying) playback.pause();
    });
    addEventListener("keydown", (event) => this.onKey(event), true);
  }

  /** Whether the next hand records. */
  get isOn(): boolean {
    return this.isWanted;
  }

  set isOn(isOn: boolean) {
    this.isWanted = isOn;
    this.tell();
  }

  get isRunning(): boolean {
    return this.newest !== null && !this.newest.isOver;
  }

  /** How far simplified keys may be from what was recorded, as a share of its range; 0: each frame has a key. */
  get tolerance(): number {
    return this.share;
  }

  /** Also that of the last step, if it is a recording. */
  set tolerance(share: number) {
    this.share = share;
    this.tell();
    if (this.newest?.isOver) void this.simplify(this.newest);
  }

  /** What is recorded, or was by the last step: of each channel. */
  get recorded(): Recorded[] {
    return this.newest?.recorded ?? [];
  }

  get paths(): string {
    return this.newest?.paths ?? "";
  }

  /** The frames that have passed. */
  get frames(): [number, number] | null {
    return this.newest && [this.newest.first, this.newest.last];
  }

  /** What was made of it, in words. */
  get account(): string {
    const { newest, keyCounts } = this;
    if (!newest) return "";
    const { first, last, paths } = newest;
    const [keys, frames] = [keyCounts.join(", "), last - first + 1];
    const made = newest.isOver && keys !== "" ? `: ${keys} ${keys === "1" ? "key" : "keys"} of ${frames} ${frames === 1 ? "frame" : "frames"}` : "";
    const under = this.kept.filter((each) => each !== newest && each.first <= last && first <= each.last).flatMap((each) => each.recorded);
    const others = under.filter((each) => !newest.channels.includes(each.path) && this.isThere(each)).map((each) => `${each.path} ${each.first}–${each.last}`);
    return `${paths} ${first}–${last}${made}${others.length > 0 ? `, over ${others.join(", ")}` : ""}`;
  }

  /** Starts time. Null: it is refused, and the reason is told. */
  begin(grip: Grip): Recording | null {
    const obstacle = this.obstacleTo(grip);
    grip.tell(obstacle);
    if (obstacle !== "" || this.isRunning) return null;
    this.keyCounts = [];
    this.newest = new Recording(this.editor, grip, this);
    this.tell();
    return this.newest;
  }

  /** It goes on. */
  goOn(): void {
    this.tell();
  }

  /** It has ended. */
  keep(recording: Recording): void {
    // One over another takes its place.
    const isUnder = (each: Recording) => each.first >= recording.first && each.last <= recording.last && each.channels.every((path) => recording.channels.includes(path));
    this.kept = [...this.kept.filter((each) => !isUnder(each)), recording];
    this.count();
    if (this.editor.session.revision !== recording.revision) this.forget(recording);
  }

  /** Something else is done. */
  forget(recording: Recording): void {
    if (this.newest !== recording) return;
    this.newest = null;
    this.tell();
  }

  private obstacleTo({ attributes }: Grip): string {
    const still = attributes.find(({ components }) => components === 0);
    if (still) return `${still.path} cannot have keys, and is not recorded`;
    const moved = attributes.find(({ path, animated }) => animated && !this.editor.channel(path)?.points.length);
    return moved ? `${moved.path} is moved by what is no curve, or not known yet, and cannot be recorded` : "";
  }

  // The newest tolerance is the only one that counts.
  private async simplify(recording: Recording): Promise<void> {
    if (this.isChanging) return;
    this.isChanging = true;
    try {
      for (let made; made !== this.share && this.newest === recording; ) await recording.simplify((made = this.share));
      if (this.editor.session.revision !== recording.revision) this.forget(recording);
    } catch (error) {
      this.forget(recording);
      this.editor.say((error as Error).message);
    }
    this.isChanging = false;
  }

  // The keys are known once the scene is that of its revision.
  private count(): void {
    const { newest, editor } = this;
    if (newest?.isOver && editor.scene.head?.revision === newest.revision) {
      this.keyCounts = newest.channels.map((path) => editor.keysOf(path).filter((frame) => frame >= newest.first && frame <= newest.last).length);
    }
    this.tell();
  }

  // Its first and last key stay, also when others go.
  private isThere({ path, first, last }: Recorded): boolean {
    const keys = this.editor.keysOf(path);
    return keys.includes(first) && keys.includes(last);
  }

  private onKey(event: KeyboardEvent): void {
    if (event.key !== " ") return;
    if (!event.repeat) this.hasStopped = this.isRunning;
    if (!this.hasStopped) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    if (this.isRunning) this.newest!.stop();
  }
}
