// The document as the command has it, and what changes it; docs/editor.md has the requests. The page knows nothing else:
// it shows what the document says at its revision.

import { Changing } from "../changing";
import { Requests } from "./requests";

/** The answer to `document`. */
export interface DocumentFacts {
  revision: number;
  /** Empty: it has no name yet. */
  file: string;
  /** Null on the first screen. */
  text: string | null;
  saved: boolean;
  changedOnDisk: boolean;
  /** What would be undone, or made again; empty: nothing. */
  undo: string;
  redo: string;
  start: number;
  end: number;
  fps: number;
  /** The last step that a command did not save before it ended. */
  journal: { time: string } | null;
  /** Why changes are not kept until they are saved; empty: they are. */
  journalFault: string;
}

/** The answer to `format`: what may stand in a scene. */
export interface Format {
  elements: ElementFormat[];
}

export interface ElementFormat {
  name: string;
  meaning: string;
  parents: string[];
  attributes: AttributeFormat[];
  children: { names: string[]; part: boolean; most?: number }[];
}

export interface AttributeFormat {
  name: string;
  type: string;
  meaning: string;
  keyable: boolean;
  required: boolean;
  unit?: string;
  /** For people. */
  range?: string;
  least?: number;
  most?: number;
  default?: string;
  words?: string[];
  /** It names one or several surfaces. */
  surfaces?: boolean;
}

/** What the scene says of one attribute. */
export interface AttributeFacts {
  name: string;
  /** The element in which it stands: that of the object, or a part of it. */
  element: string;
  /** For operations. */
  path: string;
  /** What it is, as a file says it; empty if it is animated, or neither given nor has a default. */
  value: string;
  /** What the file says, if that has a `$`. */
  written?: string;
  /** Whether the file gives it. */
  given: boolean;
  /** How many numbers a key of it has; 0: it cannot have keys. */
  components: number;
  animated: boolean;
  /** Why it must not be given here. */
  excluded?: string;
  /** The file in which it stands, if that is another one: it cannot be changed here. */
  file?: string;
}

/** A surface, force, group or collider, or the scene itself, named `scene`, which comes first. */
export interface SceneObject {
  name: string;
  /** Its element. */
  kind: string;
  /** The element of its shape. */
  shape?: string;
  group?: string;
  /** The file that it stands in, if that is another one: it cannot be changed here. */
  file?: string;
  /** The first and the last line of its element. */
  lines: [number, number];
  attributes: AttributeFacts[];
}

export type Operation = { op: string } & Record<string, unknown>;

/** The answer to what changes the document. */
export interface Outcome {
  revision: number;
  name: string;
  edits: { at: number; removed: string; inserted: string }[];
  parts: string[];
  /** The name of what was added. */
  object?: string;
}

/** The changes of one drag, scrub or held key: one step of the document, however many values it had. */
export class Gesture {
  private static count = 0;
  readonly id = `${Date.now().toString(36)}-${++Gesture.count}`;
  private readonly before: Promise<unknown>;
  private waiting: { route: string; body: object } | null = null;
  private sending: Promise<void> | null = null;
  private isOver = false;
  /** Of the operations that were sent last; empty: they are made. */
  private refusal = "";

  /**
   * `tell` gets the reason each time that operations are refused, and an empty one when they are not; `take` gets each
   * answer. The values come after those of the gestures before.
   */
  constructor(
    private readonly session: Session,
    private readonly tell: (refusal: string) => void,
    private readonly take: (outcome: Outcome) => void = () => {},
    /** Of the step; empty: what the command calls it. */
    private readonly name = "",
  ) {
    this.before = session.settled();
  }

  /** Makes these operations in place of those before; if the next ones come before they are sent, only those are. */
  send(operations: Operation[]): void {
    this.post("operations", this.bodyOf(operations));
  }

  /** The same with another request that changes the document. */
  post(route: string, body: object): void {
    if (this.isOver) return;
    this.waiting = { route, body };
    this.sending ??= this.session.hold(this.sendAll());
  }

  /**
   * Waits until the last operations are made, and tells whether they are. If not, everything is taken back, since which
   * of the values before was the last to be made is chance; the reason stays.
   */
  end(): Promise<boolean> {
    this.isOver = true;
    return this.session.hold(this.finish());
  }

  /** After its end: the same step with other operations, if the document still has that revision. Throws the reason if not. */
  amend(operations: Operation[], revision: number): Promise<Outcome> {
    return this.session.post("operations", { ...this.bodyOf(operations), gesture: this.id, revision });
  }

  /** Takes everything back, as if it had never been. */
  cancel(): Promise<void> {
    this.isOver = true;
    this.waiting = null;
    return this.session.hold(this.takeBack(() => ""));
  }

  private bodyOf(operations: Operation[]): object {
    return { operations, ...(this.name ? { name: this.name } : {}) };
  }

  private async finish(): Promise<boolean> {
    await this.sending;
    if (this.refusal === "") return true;
    await this.takeBack(() => this.refusal);
    return false;
  }

  // With the new revision, messages go.
  private async takeBack(reason: () => string): Promise<void> {
    await this.sending;
    await this.session.post("operations", { operations: [], gesture: this.id, cancel: true }).catch(() => {});
    this.tell(reason());
  }

  private async sendAll(): Promise<void> {
    await this.before;
    for (let next; (next = this.waiting); ) {
      this.waiting = null;
      this.refusal = "";
      try {
        this.take(await this.session.post(next.route, { ...next.body, gesture: this.id }));
      } catch (error) {
        this.refusal = (error as Error).message;
      }
      this.tell(this.refusal);
    }
    this.sending = null;
  }
}

/** Until a command that could not be reached is tried again. [ms] */
const retryAfter = 1000;

/** Tells of each new state of the document; `facts`, `objects` and the revision belong together. */
export class Session extends Changing {
  facts!: DocumentFacts;
  format!: Format;
  objects: SceneObject[] = [];
  /** The newest one that is known of; `facts` may be older for a moment. */
  revision = 0;
  /** Why the scene at its revision cannot be played, one line each. */
  failures: string[] = [];
  /** Whether the command can be reached. */
  isAlive = true;
  readonly requests = new Requests(() => this.lose());
  private readonly newer: ((revision: number) => void)[] = [];
  private posted: Promise<unknown> = Promise.resolve();
  /** What gestures are still to send, or to take back. */
  private readonly held = new Set<Promise<unknown>>();
  private reading: Promise<void> | null = null;
  private wanted = false;
  /** For the newest revision to be read. */
  private readonly waiting: (() => void)[] = [];

  /** Calls `listener` at once when there is a newer revision, ahead of what it says. */
  onNewer(listener: (revision: number) => void): void {
    this.newer.push(listener);
  }

  async open(): Promise<void> {
    this.format = await this.requests.json<Format>("format");
    await this.read();
  }

  object(name: string): SceneObject | undefined {
    return this.objects.find((each) => each.name === name);
  }

  attribute(name: string, attribute: string): AttributeFacts | undefined {
    return this.object(name)?.attributes.find((each) => each.name === attribute);
  }

  formatOf({ element, name }: { element: string; name: string }): AttributeFormat | undefined {
    return this.format.elements.find((each) => each.name === element)?.attributes.find((each) => each.name === name);
  }

  /** Operations as one step. Throws the reason if they are refused. */
  apply(operations: Operation[], name?: string): Promise<Outcome> {
    return this.post("operations", { operations, ...(name ? { name } : {}) });
  }

  /** Any request that changes the document, or what is known of its file. Throws the reason if it is refused. */
  async post(route: string, body: object = {}): Promise<Outcome> {
    // One after another, as they were made; the last value of a gesture goes ahead of what comes after that.
    if (!("gesture" in body) && this.held.size > 0) await this.settled();
    const posted = this.posted.then(() => this.requests.post<Outcome>(route, body));
    this.posted = posted.catch(() => {});
    return posted.then((outcome) => {
      this.take(outcome.revision);
      return outcome;
    });
  }

  /** Lets what comes after a gesture wait for it. */
  hold<T>(sending: Promise<T>): Promise<T> {
    this.held.add(sending);
    return sending.finally(() => this.held.delete(sending));
  }

  /** Waits for what gestures send now. */
  async settled(): Promise<void> {
    await Promise.all(this.held);
  }

  undo = () => this.post("undo").catch(() => {});
  redo = () => this.post("redo").catch(() => {});

  /** There is a revision, as an answer or an event says. */
  take(revision: number): void {
    if (revision > this.revision) {
      this.revision = revision;
      this.failures = [];
      for (const listener of this.newer) listener(revision);
    }
    this.read().catch(() => {}); // the page tells if the command has ended
  }

  /** Reads what the document says, until it is that of the newest revision. */
  read(): Promise<void> {
    this.wanted = true;
    this.reading ??= this.readAll().finally(() => (this.reading = null));
    return this.reading;
  }

  /** Waits until what the document says at the newest revision is known. */
  async known(): Promise<void> {
    if (this.facts.revision < this.revision) await new Promise<void>((resume) => this.waiting.push(resume));
  }

  /** It cannot be played, if it is still at that revision. */
  fail(revision: number, errors: { message: string; file?: string; line?: number }[]): void {
    if (revision !== this.revision) return;
    this.failures = errors.map(({ message, line }) => (line ? `line ${line}: ${message}` : message));
    this.tell();
  }

  /** The command could not be reached: it is tried again until it answers. */
  lose(): void {
    if (!this.isAlive) return;
    this.isAlive = false;
    this.tell();
    const retry = () => void setTimeout(() => this.requests.json("document").then(() => this.regain(), retry), retryAfter);
    retry();
  }

  private regain(): void {
    this.isAlive = true;
    for (const listener of this.newer) listener(this.revision);
    this.take(this.revision);
  }

  private async readAll(): Promise<void> {
    while (this.wanted) {
      this.wanted = false;
      const { document: facts, objects } = await this.requests.json<{ document: DocumentFacts; objects: SceneObject[] }>("objects");
      if (facts.revision !== this.facts?.revision) this.objects = objects;
      this.facts = facts;
      if (facts.revision > this.revision) {
        this.revision = facts.revision;
        for (const listener of this.newer) listener(facts.revision);
      }
      this.tell();
      if (facts.revision === this.revision) for (const resume of this.waiting.splice(0)) resume();
    }
  }
}
