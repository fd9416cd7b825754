// A field of text: what is typed takes effect on Enter, or when the field is left, and Escape takes it back.

import { make } from "../element";
import { setAttribute } from "./arrange";
import type { Problem } from "./problem";

export class TextField {
  readonly input = make("input", { type: "text", className: "value", autocomplete: "off", spellcheck: false });
  /** What the document says. */
  protected known = "";
  private isMixed = false;
  private typed = false;
  private refused: string | null = null;
  /** What was sent, until it is answered. */
  private sent: string | null = null;
  private absent = "";

  /** `give` makes it the value, or throws the reason of the refusal. */
  constructor(
    name: string,
    private readonly give: (text: string) => Promise<unknown>,
    protected readonly problem: Problem,
  ) {
    const { input } = this;
    input.setAttribute("aria-label", name);
    input.addEventListener("input", () => (this.typed = true));
    input.addEventListener("keydown", (event) => this.onKey(event));
    input.addEventListener("focus", () => this.onFocus());
    input.addEventListener("blur", () => this.onBlur());
  }

  /** Whether something was typed that is no value yet. */
  get isTyped(): boolean {
    return this.typed;
  }

  /** `absent`: what it is if there is no text. */
  show(text: string, isMixed: boolean, absent: string): void {
    this.known = text;
    this.isMixed = isMixed;
    this.absent = absent;
    if (!this.typed) this.write();
  }

  /** Shows what the document says. */
  restore(): void {
    this.problem.clear(this.input);
    this.typed = false;
    this.refused = null;
    this.write();
  }

  /** What is sent for a text that was typed. */
  protected valueTyped(text: string): string {
    return text;
  }

  protected shortened(text: string): string {
    return text;
  }

  protected write(): void {
    const { input } = this;
    const text = this.isMixed ? "" : document.activeElement === input ? this.known : this.shortened(this.known);
    if (input.value !== text) input.value = text;
    setAttribute(input, "placeholder", this.isMixed ? "mixed" : this.absent || null);
  }

  protected onKey(event: KeyboardEvent): void {
    const isSave = (event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "s";
    const isUndo = (event.ctrlKey || event.metaKey) && /^[zy]$/i.test(event.key) && (!this.typed || this.input.value === this.sent);
    if (!isSave && !isUndo) event.stopPropagation();
    if (event.key === "Enter" || isSave) void this.commit();
    if (event.key !== "Escape") return;
    event.preventDefault();
    if (this.typed) this.restore();
    else this.input.blur();
  }

  private onFocus(): void {
    if (this.typed) return;
    this.write();
    this.input.select();
  }

  private onBlur(): void {
    // The window may have lost the focus, or the panel the field.
    if (document.activeElement === this.input || !this.input.isConnected) return;
    if (!this.typed) this.restore();
    else if (this.input.value === this.refused) this.restore(); // it was left a second time
    else void this.commit();
  }

  private async commit(): Promise<void> {
    const text = this.input.value;
    if (!this.typed || text === this.sent) return;
    if (text === this.known && !this.isMixed) return this.restore();
    this.sent = text;
    try {
      await this.give(this.valueTyped(text.trim()));
      this.problem.clear();
      this.refused = null;
      if (this.input.value === text) this.typed = false; // it is shown when the document says it
    } catch (error) {
      const { message } = error as Error;
      if (!this.typed) {
        this.problem.show(message); // the field is that of something else now
      } else {
        this.refused = text;
        this.problem.show(message, this.input);
        this.input.focus();
      }
    }
    this.sent = null;
  }
}
