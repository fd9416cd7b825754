// A dialog that asks the command for something, with a line for what it refuses.

import { element } from "../element";

export class Dialog {
  readonly element: HTMLDialogElement;
  readonly form: HTMLFormElement;
  private readonly refusal: HTMLElement;
  private isBusy = false;

  constructor(id: string) {
    this.element = element(id);
    this.form = this.element.querySelector("form")!;
    this.refusal = this.element.querySelector(".refusal")!;
    // Keys act in the dialog only.
    this.element.addEventListener("keydown", (event) => event.stopPropagation());
    this.press("[data-close]", () => this.close());
  }

  get isOpen(): boolean {
    return this.element.open;
  }

  open(message = ""): void {
    this.say(message);
    if (!this.element.open) this.element.showModal();
  }

  close(): void {
    if (this.element.open) this.element.close();
  }

  /** The control of that name. */
  control<T extends HTMLElement>(name: string): T {
    return this.form.elements.namedItem(name) as unknown as T;
  }

  onPress(name: string, act: () => void): void {
    this.press(`[name="${name}"]`, act);
  }

  onSubmit(act: () => void): void {
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      act();
    });
  }

  say(message: string): void {
    this.refusal.textContent = message;
  }

  /** Shows why `act` is refused; one at a time. Returns whether it was made. */
  async try(act: () => Promise<unknown>): Promise<boolean> {
    if (this.isBusy) return false;
    this.setBusy(true);
    this.say("");
    try {
      await act();
      return true;
    } catch (error) {
      this.say((error as Error).message);
      return false;
    } finally {
      this.setBusy(false);
    }
  }

  private setBusy(isBusy: boolean): void {
    this.isBusy = isBusy;
    this.form.setAttribute("aria-busy", String(isBusy));
  }

  private press(selector: string, act: () => void): void {
    for (const each of this.element.querySelectorAll(selector)) each.addEventListener("click", act);
  }
}
