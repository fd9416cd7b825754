// The list of forces, groups and colliders, with controls to show or hide each, or to show it alone.

import type { Force } from "./bake";
import { make } from "./element";
import type { ForceChoice, Named } from "./force_choice";

type Row = Named & { kind: string };

/** First the forces without a group, then each group followed by its forces. */
function ordered(forces: Force[]): Force[] {
  const within = (group: string | undefined) => forces.filter((force) => force.kind !== "group" && force.group === group);
  return [...within(undefined), ...forces.filter((force) => force.kind === "group").flatMap((group) => [group, ...within(group.name)])];
}

export class ForceList {
  private forces: Row[] = [];
  private current = 0;

  constructor(
    private readonly list: HTMLElement,
    private readonly showAll: HTMLButtonElement,
    private readonly choice: ForceChoice,
  ) {
    choice.onChange(() => this.update());
    showAll.addEventListener("click", () => choice.showAll());
    list.addEventListener("keydown", (event) => this.onKey(event));
    list.addEventListener("focusin", (event) => {
      const row = this.rows.findIndex((each) => each.contains(event.target as Node));
      if (row >= 0) this.makeCurrent(row);
    });
  }

  load(forces: Force[], colliders: Row[]): void {
    const rowsOf = (rows: Row[]) => JSON.stringify(rows.map(({ name, kind, group }) => [name, kind, group]));
    const before = rowsOf(this.forces);
    this.forces = [...ordered(forces), ...colliders];
    if (rowsOf(this.forces) === before && this.forces.length > 0) return this.update();
    this.list.replaceChildren(...this.forces.map((force) => this.row(force)));
    this.list.parentElement!.hidden = this.forces.length === 0;
    this.showAll.textContent = colliders.length > 0 ? "Show all forces and colliders" : "Show all forces";
    this.makeCurrent(Math.min(this.current, Math.max(this.forces.length - 1, 0)));
    this.update();
  }

  private get rows(): HTMLElement[] {
    return [...this.list.children] as HTMLElement[];
  }

  private row({ name, kind, group }: Row): HTMLElement {
    const box = make("input", { type: "checkbox" });
    box.addEventListener("change", () => this.choice.hide(name, !box.checked));
    const title = `Show ${name} alone`;
    const solo = make("button", { type: "button", title, ariaLabel: title }, "solo");
    solo.addEventListener("click", () => this.choice.solo(name, !this.choice.isAlone(name)));
    const label = make("label", {}, box, make("span", {}, name));
    return make("li", { className: group === undefined ? "" : "within" }, label, make("span", {}, kind), solo);
  }

  private update(): void {
    this.rows.forEach((row, k) => {
      const force = this.forces[k];
      row.classList.toggle("off", !this.choice.isShown(force));
      row.querySelector("input")!.checked = !this.choice.isHidden(force.name);
      row.querySelector("button")!.setAttribute("aria-pressed", String(this.choice.isAlone(force.name)));
    });
    this.showAll.disabled = this.choice.isEverythingShown;
  }

  // Only one row is in the tab order; arrow keys move between rows.
  private makeCurrent(row: number): void {
    this.current = row;
    this.rows.forEach((each, k) => {
      for (const control of each.querySelectorAll<HTMLElement>("input, button")) control.tabIndex = k === row ? 0 : -1;
    });
  }

  private onKey(event: KeyboardEvent): void {
    const last = this.forces.length - 1;
    const target = { ArrowDown: Math.min(this.current + 1, last), ArrowUp: Math.max(this.current - 1, 0), Home: 0, End: last }[event.key];
    if (target === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    const kind = (event.target as HTMLElement).matches("button") ? "button" : "input";
    const control = this.rows[target].querySelector<HTMLElement>(kind)!;
    control.focus();
    control.scrollIntoView({ block: "nearest" });
  }
}
