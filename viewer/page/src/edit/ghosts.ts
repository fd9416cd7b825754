// The takes that are drawn behind the scene, at the frame of the playhead. One request at a time: those of the scene need
// the connections of the browser.

import * as THREE from "three";

import { Changing } from "../changing";
import type { ThemeChoice } from "../theme";
import type { Editor } from "./editor";
import { Ghost } from "./ghost";
import { Refusal } from "./requests";

/** As many as the command plays. */
const most = 2;
const retryAfter = 500; // [ms]

/** Tells when other takes are drawn. */
export class Ghosts extends Changing {
  readonly group = new THREE.Group();
  private readonly ghosts: Ghost[] = [];
  private isAsking = false;
  /** Until those that are not drawn any more have ended. */
  private ended: Promise<unknown> = Promise.resolve();
  /** The frame that is asked for. */
  private asked = { frame: 0, abort: new AbortController() };

  /** `say` gets why a take cannot be drawn. */
  constructor(
    private readonly editor: Editor,
    private readonly themes: ThemeChoice,
    private readonly say: (message: string) => void,
  ) {
    super();
    editor.viewer.stage.scene.add(this.group);
    editor.playback.onChange(() => {
      if (this.asked.frame !== editor.playback.frame) this.asked.abort.abort();
      this.show();
      void this.ask();
    });
    themes.onChange(() => this.colour());
  }

  has(take: number): boolean {
    return this.ghosts.some((each) => each.take === take);
  }

  /** Draws a take; the one drawn longest gives way if there are too many. */
  add(take: number): void {
    if (this.has(take)) return;
    if (this.ghosts.length === most) this.remove(this.ghosts[0]);
    const slot = [...Array(most).keys()].find((k) => !this.ghosts.some((each) => each.slot === k))!;
    const ghost = new Ghost(take, slot, this.editor.session.requests);
    this.ghosts.push(ghost);
    this.group.add(ghost.group);
    this.colour();
    this.tell();
    void this.ask();
  }

  drop(take: number): void {
    const ghost = this.ghosts.find((each) => each.take === take);
    if (!ghost) return;
    this.remove(ghost);
    const ended = this.editor.session.post("take", { id: take, ghost: false }).catch(() => {}); // it is gone, or the command
    this.ended = Promise.all([this.ended, ended]);
  }

  /** Draws those of these takes only; `areNew`: what they look like may have changed. */
  retain(takes: number[], areNew: boolean): void {
    for (const ghost of [...this.ghosts]) {
      const isThere = takes.includes(ghost.take);
      if (isThere && !areNew) continue;
      this.remove(ghost);
      if (isThere) this.add(ghost.take);
    }
  }

  get colours(): Map<number, string> {
    const { ghosts } = this.themes.palette;
    return new Map(this.ghosts.map(({ take, slot }) => [take, ghosts[slot]]));
  }

  /** What is drawn. */
  get shown(): { take: number; frame: number | null; positions: Record<string, Float32Array> }[] {
    return this.ghosts.map(({ take, shownFrame: frame, positions }) => ({ take, frame, positions }));
  }

  private remove(ghost: Ghost): void {
    this.ghosts.splice(this.ghosts.indexOf(ghost), 1);
    this.group.remove(ghost.group);
    this.asked.abort.abort();
    ghost.dispose();
    this.show();
    this.tell();
  }

  private colour(): void {
    const colours = this.colours;
    for (const ghost of this.ghosts) ghost.colour = colours.get(ghost.take)!;
    this.show();
  }

  private show(): void {
    for (const ghost of this.ghosts) ghost.show(this.editor.playback.frame);
    this.editor.viewer.stage.invalidate();
  }

  // Until everything is here: the frame shown of each ghost goes first.
  private async ask(): Promise<void> {
    if (this.isAsking) return;
    this.isAsking = true;
    for (let next; this.editor.session.isAlive && (next = this.next()); ) await this.try(next);
    this.isAsking = false;
  }

  private next(): { ghost: Ghost; frame: number | null } | null {
    const unread = this.ghosts.find(({ isRead }) => !isRead);
    if (unread) return { ghost: unread, frame: null };
    const { frame } = this.editor.playback;
    const missing = this.ghosts.map((ghost) => ({ ghost, frame: ghost.missing(frame) })).filter((each) => each.frame !== null);
    return missing.find((each) => each.frame === frame) ?? missing[0] ?? null;
  }

  private async try({ ghost, frame }: { ghost: Ghost; frame: number | null }): Promise<void> {
    const abort = new AbortController();
    try {
      if (frame === null) {
        await this.ended;
        await ghost.read();
      } else {
        this.asked = { frame, abort };
        await ghost.fetch(frame, abort.signal);
      }
    } catch (error) {
      if (abort.signal.aborted || !this.ghosts.includes(ghost)) return;
      // Other refusals are of the moment, the command has freed what it needs.
      if (error instanceof Refusal && error.status !== 422) return new Promise((resume) => setTimeout(resume, retryAfter));
      this.say((error as Error).message);
      if (frame === null) this.drop(ghost.take); // its files may be others next time
      else ghost.fail(frame);
    }
    if (this.ghosts.includes(ghost)) this.show();
  }
}
