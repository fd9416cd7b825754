// What is selected: names of objects, the active one last. Nothing selected stands for the scene itself.

import { Changing } from "../changing";
import type { SceneObject, Session } from "./session";

export class Selection extends Changing {
  private chosen: string[] = [];
  private before: string[] = [];

  constructor(private readonly session: Session) {
    super();
    session.onChange(() => {
      const now = session.objects.map(({ name }) => name);
      const left = this.chosen.map((name) => (session.object(name) ? name : this.renamed(name, now)));
      this.before = now;
      this.set(left.filter((name) => name !== undefined));
    });
  }

  get names(): readonly string[] {
    return this.chosen;
  }

  /** The objects, or the scene if there are none. */
  get objects(): SceneObject[] {
    const objects = this.chosen.map((name) => this.session.object(name)).filter((each) => each !== undefined);
    return objects.length > 0 ? objects : this.session.objects.slice(0, 1);
  }

  /** The objects without those that their groups stand for. */
  get outermost(): SceneObject[] {
    const objects = this.chosen.map((name) => this.session.object(name)).filter((each) => each !== undefined);
    return objects.filter(({ group }) => group === undefined || !this.has(group));
  }

  get active(): SceneObject | undefined {
    const name = this.chosen.at(-1);
    return name === undefined ? undefined : this.session.object(name);
  }

  has(name: string): boolean {
    return this.chosen.includes(name);
  }

  set(names: string[]): void {
    if (names.length === this.chosen.length && names.every((name, k) => name === this.chosen[k])) return;
    this.chosen = [...names];
    this.tell();
  }

  /** Selects it alone; `isAdded`: to what is selected, or takes it away from that. */
  choose(name: string, isAdded: boolean): void {
    if (!isAdded) this.set([name]);
    else this.set(this.has(name) ? this.chosen.filter((each) => each !== name) : [...this.chosen, name]);
  }

  // The new name of what stands where it stood, if nothing else was added or deleted.
  private renamed(name: string, now: string[]): string | undefined {
    const other = now[this.before.indexOf(name)];
    return now.length === this.before.length && !this.before.includes(other) ? other : undefined;
  }
}
