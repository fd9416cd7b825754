// Which forces are shown: all but those that are hidden, or some alone.

import type { Force } from "./bake";

export class ForceChoice {
  /** Names, also of forces that are not there now: a save may bring them back. */
  private readonly hidden = new Set<string>();
  private readonly alone = new Set<string>();
  private readonly listeners: (() => void)[] = [];

  /** What is shown alone wins over what is hidden. A group stands for the forces in it. */
  isShown({ name, group }: Force): boolean {
    const isIn = (names: Set<string>) => names.has(name) || (group !== undefined && names.has(group));
    return this.alone.size > 0 ? isIn(this.alone) : !isIn(this.hidden);
  }

  isHidden = (name: string) => this.hidden.has(name);
  isAlone = (name: string) => this.alone.has(name);

  get isEverythingShown(): boolean {
    return this.hidden.size === 0 && this.alone.size === 0;
  }

  hide(name: string, isHidden: boolean): void {
    if (isHidden) this.hidden.add(name);
    else this.hidden.delete(name);
    this.tell();
  }

  solo(name: string, isAlone: boolean): void {
    if (isAlone) this.alone.add(name);
    else this.alone.delete(name);
    this.tell();
  }

  /** As an address says it; undefined: it says nothing. */
  set(hidden: string[] | undefined, alone: string[] | undefined): void {
    const replace = (names: Set<string>, by: string[] | undefined) => {
      if (by === undefined) return;
      names.clear();
      for (const name of by) names.add(name);
    };
    replace(this.hidden, hidden);
    replace(this.alone, alone);
    this.tell();
  }

  showAll(): void {
    this.set([], []);
  }

  /** An address with this choice in it, other words as they were. */
  writtenTo(address: string): string {
    const words = new URLSearchParams(address.replace(/^#/, ""));
    for (const [word, names] of [["hide", this.hidden], ["solo", this.alone]] as const) {
      words.delete(word);
      if (names.size > 0) words.set(word, [...names].join(","));
    }
    // Names have no commas, and an address may: it is easier to read.
    return words.toString().replaceAll("%2C", ",");
  }

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  private tell(): void {
    for (const listener of this.listeners) listener();
  }
}
