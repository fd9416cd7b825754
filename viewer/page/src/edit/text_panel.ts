// The text of the file, to read, with the lines of what is selected marked.

import { element, make } from "../element";
import { button } from "../page";
import type { Editor } from "./editor";

export function mountTextPanel(editor: Editor): void {
  new TextPanel(editor);
}

class TextPanel {
  private readonly panel = element<HTMLElement>("text-panel");
  private readonly list = element<HTMLOListElement>("text-lines");
  private readonly toggle = element("text-toggle");

  constructor(private readonly editor: Editor) {
    button("text-toggle", () => this.show(this.panel.hidden));
    button("text-close", () => this.hide());
    this.panel.addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.hide();
      // The arrows and Home and End scroll.
      if (/^(Arrow|Home|End|Page| $)/.test(event.key)) event.stopPropagation();
    });
    editor.session.onChange(() => this.update());
    editor.selection.onChange(() => {
      this.mark();
      this.reveal();
    });
  }

  private show(isShown: boolean): void {
    this.panel.hidden = !isShown;
    this.toggle.setAttribute("aria-expanded", String(isShown));
    if (!isShown) return;
    this.update();
    this.reveal();
  }

  private hide(): void {
    this.show(false);
    const toggle = this.toggle as HTMLElement;
    (toggle.checkVisibility() ? toggle : element<HTMLElement>("more-toggle")).focus();
  }

  // Only the lines that are not the same are written.
  private update(): void {
    const { facts } = this.editor.session;
    if (facts.text === null) return this.show(false);
    if (this.panel.hidden) return;
    element("text-file").textContent = facts.file || "not saved yet";
    const lines = facts.text.replace(/\n$/, "").split("\n");
    const { list } = this;
    while (list.children.length > lines.length) list.lastElementChild!.remove();
    if (list.children.length < lines.length) list.append(...Array.from({ length: lines.length - list.children.length }, () => make("li")));
    lines.forEach((line, k) => {
      const item = list.children[k];
      if (item.textContent !== line) item.textContent = line;
    });
    list.parentElement!.style.setProperty("--digits", String(String(lines.length).length));
    this.mark();
  }

  private mark(): void {
    if (this.panel.hidden) return;
    const { session, selection } = this.editor;
    const marked = selection.names.map((name) => session.object(name)).filter((object) => object !== undefined && object.file === undefined);
    [...this.list.children].forEach((item, k) => {
      const isMarked = marked.some((object) => object!.lines[0] <= k + 1 && k + 1 <= object!.lines[1]);
      item.classList.toggle("marked", isMarked);
      if (isMarked) item.setAttribute("aria-current", "true");
      else item.removeAttribute("aria-current");
    });
  }

  private reveal(): void {
    if (!this.panel.hidden) this.list.querySelector(".marked")?.scrollIntoView({ block: "nearest" });
  }
}
