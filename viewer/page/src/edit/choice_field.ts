// Fields of which one chooses: a word of several, yes or no, and names out of those that there are.

import { make } from "../element";
import { arrange, setAttribute } from "./arrange";
import type { Problem } from "./problem";
import { TextField } from "./text_field";

type Give = (text: string) => Promise<unknown>;

/** Chooses a word. The empty text stands for the absence of a value. */
export class ChoiceField {
  readonly input = make("select", { className: "value" });
  private known = "";

  constructor(name: string, give: Give, problem: Problem) {
    const { input } = this;
    input.setAttribute("aria-label", name);
    input.addEventListener("change", async () => {
      if (!(await problem.attempt(() => give(input.value), input))) input.focus();
    });
    input.addEventListener("blur", () => {
      if (!input.hasAttribute("aria-invalid")) return;
      input.value = this.known;
      problem.clear();
    });
  }

  /** `absent`: what the absence of a value means; undefined: it must have one. */
  show(text: string, isMixed: boolean, words: string[], absent?: string): void {
    this.known = isMixed ? "" : text;
    const options = absent === undefined ? [...words] : ["", ...words];
    if (!options.includes(this.known)) options.unshift(this.known);
    const labels = options.map((word) => word || (isMixed ? "mixed" : (absent ?? "–")));
    const { input } = this;
    if (labels.join("\n") !== [...input.options].map((each) => each.text).join("\n")) {
      input.replaceChildren(...options.map((value, k) => make("option", { value }, labels[k])));
    }
    if (!input.hasAttribute("aria-invalid") && input.value !== this.known) input.value = this.known;
  }
}

export class CheckField {
  readonly input = make("input", { type: "checkbox" });

  constructor(name: string, give: Give, problem: Problem) {
    const { input } = this;
    input.setAttribute("aria-label", name);
    let known = false;
    input.addEventListener("click", () => (known = !input.checked));
    input.addEventListener("change", async () => {
      if (!(await problem.attempt(() => give(String(input.checked)), input))) input.checked = known;
    });
  }

  show(text: string, isMixed: boolean): void {
    this.input.checked = text === "true" || text === "1";
    this.input.indeterminate = isMixed;
  }
}

/** A list of names, to be typed or checked. */
export class NamesField {
  readonly field: TextField;
  readonly element: HTMLElement;
  private readonly choices: HTMLElement;
  private names: string[] = [];

  constructor(
    private readonly name: string,
    private readonly give: Give,
    private readonly problem: Problem,
  ) {
    this.field = new TextField(name, give, problem);
    this.choices = make("div", { className: "names", role: "group", ariaLabel: `choose ${name}` });
    this.element = make("div", { className: "stack" }, this.field.input, this.choices);
  }

  show(text: string, isMixed: boolean, absent: string, all: string[], canChange: boolean): void {
    this.field.show(text, isMixed, absent);
    this.names = text.split(/\s+/).filter(Boolean);
    const boxes = new Map([...this.choices.children].map((label) => [label.textContent!, label]));
    arrange(this.choices, all.map((each) => boxes.get(each) ?? this.boxOf(each)));
    this.choices.hidden = all.length < 2;
    for (const box of this.choices.querySelectorAll("input")) {
      box.checked = !isMixed && this.names.includes(box.name);
      box.disabled = !canChange;
      setAttribute(box, "aria-label", `${this.name} ${box.name}`);
    }
  }

  private boxOf(name: string): HTMLElement {
    const box = make("input", { type: "checkbox", name });
    box.addEventListener("change", async () => {
      this.names = box.checked ? [...this.names, name] : this.names.filter((each) => each !== name);
      if (!(await this.problem.attempt(() => this.give(this.names.join(" ")), box))) box.checked = !box.checked;
    });
    return make("label", {}, box, make("span", {}, name));
  }
}
