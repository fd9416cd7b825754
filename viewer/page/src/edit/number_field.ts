// A field for a number: arithmetic may be typed, arrow keys step, and a drag sideways scrubs. Each scrub and each held
// arrow is one step of the document, and Escape takes it back.

import { valueText } from "../curve_plot";
import { setAttribute } from "./arrange";
import { evaluated, numberTyped } from "./arithmetic";
import type { Problem } from "./problem";
import { TextField } from "./text_field";

export interface NumberRange {
  least?: number;
  most?: number;
  isWhole: boolean;
  /** Whether quotients stay as they are typed. */
  isRatio: boolean;
}

/** What a hand holds: its values until it lets go, or takes all back. */
export interface Held {
  hold(text: string): void;
  end(): Promise<unknown>;
  cancel(): Promise<unknown>;
}

/** How a number changes while a hand moves. */
export interface Moving {
  /** A size for a step where the number is 0. */
  size: () => number;
  /** `tell` gets what is refused, or an empty text; `letGo` ends it as the hand does. Null: it is refused. */
  begin: (tell: (refusal: string) => void, letGo: () => void) => Held | null;
  /** Waits for the document as it is then; `isMade`: the last value was not refused, nor taken back. */
  ended: (isMade: boolean) => Promise<void>;
}

interface Move {
  held: Held;
  start: number;
  step: number;
  /** How far it is from the start. */
  way: number;
  text: string;
}

const threshold = 3; // pixels before a press is a scrub

export class NumberField extends TextField {
  private move: Move | null = null;
  private arrow = "";
  private press: { id: number; x: number } | null = null;

  constructor(
    name: string,
    give: (text: string) => Promise<unknown>,
    problem: Problem,
    private readonly range: NumberRange,
    private readonly moving: Moving,
  ) {
    super(name, give, problem);
    const { input } = this;
    input.setAttribute("role", "spinbutton");
    input.classList.add("number");
    if (range.least !== undefined) input.setAttribute("aria-valuemin", String(range.least));
    if (range.most !== undefined) input.setAttribute("aria-valuemax", String(range.most));
    input.addEventListener("keyup", ({ key }) => key === this.arrow && this.end());
    input.addEventListener("blur", () => this.arrow && this.end());
    this.listenForScrub();
  }

  override show(text: string, isMixed: boolean, absent: string): void {
    super.show(text, isMixed, absent);
    if (this.move) return;
    const value = evaluated(text);
    setAttribute(this.input, "aria-valuenow", isMixed || !Number.isFinite(value) ? null : String(value));
  }

  protected override valueTyped(text: string): string {
    return this.range.isRatio ? text : numberTyped(text);
  }

  protected override shortened(text: string): string {
    return text.length > 9 && Number.isFinite(Number(text)) ? valueText(Number(text)) : text;
  }

  protected override write(): void {
    if (!this.move) super.write();
  }

  protected override onKey(event: KeyboardEvent): void {
    if (this.move && event.key === "Escape") return; // `stop` has it
    super.onKey(event);
    const way = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (way === undefined || event.altKey || event.metaKey || this.input.readOnly) return;
    event.preventDefault();
    if (this.arrow !== event.key || !this.move) {
      if (event.repeat) return; // it was taken back
      if (this.move) this.end();
      if (!this.begin()) return;
      this.arrow = event.key;
    }
    this.go(way, event, 2);
  }

  // A press that moves sideways scrubs; another one sets the cursor.
  private listenForScrub(): void {
    const { input } = this;
    let wasScrubbed = false;
    input.addEventListener("pointerdown", (event) => {
      wasScrubbed = false;
      const canScrub = event.button === 0 && event.isPrimary && !input.readOnly && !this.isTyped;
      this.press = canScrub ? { id: event.pointerId, x: event.clientX } : null;
    });
    input.addEventListener("mousedown", (event) => {
      if (this.press && document.activeElement !== input) event.preventDefault();
    });
    input.addEventListener("click", () => {
      if (!wasScrubbed && document.activeElement !== input) input.focus();
    });
    input.addEventListener("pointermove", (event) => {
      const { press } = this;
      if (!press || press.id !== event.pointerId) return;
      const way = event.clientX - press.x;
      if (!input.hasPointerCapture(press.id)) {
        if (Math.abs(way) < threshold) return;
        if (!this.begin()) return void (this.press = null);
        wasScrubbed = true;
        input.setPointerCapture(press.id);
      }
      if (!this.move || way === 0) return;
      press.x = event.clientX;
      this.go(way, event, 1);
    });
    const release = (act: () => void) => () => {
      if (!this.press) return;
      this.press = null;
      if (wasScrubbed) act();
    };
    input.addEventListener("pointerup", release(() => this.end()));
    input.addEventListener("pointercancel", release(() => this.cancel()));
  }

  private begin(): boolean {
    const start = evaluated(this.move?.text ?? (this.isTyped ? this.input.value : this.known));
    if (!Number.isFinite(start)) return false;
    const size = 0.01 * (Math.abs(start) || this.moving.size());
    const held = this.moving.begin(
      (refusal) => (refusal === "" ? this.problem.clear() : this.problem.show(refusal, this.input)),
      () => {
        this.press = null;
        this.end();
      },
    );
    if (!held) return false;
    if (this.isTyped) this.restore();
    this.move = { held, start, step: this.range.isWhole ? Math.max(size, 1) : size, way: 0, text: this.known };
    addEventListener("keydown", this.stop, true);
    return true;
  }

  // `digits`: of the step.
  private go(steps: number, { shiftKey, ctrlKey }: { shiftKey: boolean; ctrlKey: boolean }, digits: number): void {
    const { move, range } = this;
    if (!move) return;
    const step = move.step * (shiftKey ? 0.1 : 1) * (ctrlKey ? 10 : 1);
    move.way += steps * (range.isWhole ? Math.max(step, this.arrow ? 1 : 0) : step);
    const decimals = range.isWhole ? 0 : Math.min(Math.max(digits - Math.floor(Math.log10(Math.min(step, move.step))), 0), 100);
    const value = Math.min(Math.max(move.start + move.way, range.least ?? -Infinity), range.most ?? Infinity);
    move.way = value - move.start;
    move.text = String(Number(value.toFixed(decimals)));
    this.input.value = move.text;
    this.input.setAttribute("aria-valuenow", move.text);
    move.held.hold(move.text);
  }

  private end = () => void this.finish((held) => held.end());
  private cancel = () => void this.finish((held) => held.cancel());

  // What the hand made stays in the field until the document says what is so.
  private async finish(act: (held: Held) => Promise<unknown>): Promise<void> {
    const { move } = this;
    this.arrow = "";
    removeEventListener("keydown", this.stop, true);
    if (!move) return;
    await this.moving.ended((await act(move.held)) === true);
    if (this.move !== move) return;
    this.move = null;
    if (!this.isTyped) this.write();
  }

  private readonly stop = (event: KeyboardEvent) => {
    if (event.key !== "Escape") return;
    event.preventDefault();
    event.stopPropagation();
    this.press = null;
    this.cancel();
  };
}
