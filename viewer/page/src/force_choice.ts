// The forces and colliders that are shown: all except hidden ones, or only some chosen ones.

import { Changing } from "./changing";

/** What can be chosen by its name. */
export interface Named {
  name: string;
  /** Of a force. */
  group?: string;
}

export class ForceChoice extends Changing {
  /** Names, also of forces that do not exist at present: a save may bring them back. */
  private readonly hidden = new Set<string>();
  private readonly alone = new Set<string>();

  /**
   * A force shown alone is shown even if it is hidden. The choice for a group is also valid for its
   * forces.
   */
  isShown({ name, group }: Named): boolean {
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

  /** Sets the lists given in an address; undefined: the list does not change. */
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

  /** The address with this choice; its other words do not change. */
  writtenTo(address: string): string {
    const words = new URLSearchParams(address.replace(/^#/, ""));
    for (const [word, names] of [["hide", this.hidden], ["solo", this.alone]] as const) {
      words.delete(word);
      if (names.size > 0) words.set(word, [...names].join(","));
    }
    // Names contain no commas, and an address may contain them: easier to read.
    return words.toString().replaceAll("%2C", ",");
  }
}
