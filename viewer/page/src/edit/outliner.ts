// The tree Objects: what is in the scene, to select, add, rename, copy and delete.

import { element } from "../element";
import { arrange } from "./arrange";
import type { Editor } from "./editor";
import { kindsToAdd, titleOf } from "./kinds";
import { onContextMenu, openMenu, type MenuEntry, type MenuPlace } from "./menu";
import { askForMesh, type Mesh } from "./mesh_dialog";
import { freeNames } from "./names";
import { Problem } from "./problem";
import type { Operation, SceneObject } from "./session";
import { TreeItem } from "./tree_item";

class Outliner {
  private readonly tree = element<HTMLElement>("tree");
  private readonly problem: Problem;
  private readonly items = new Map<string, TreeItem>();
  private readonly closed = new Set<string>();
  /** The one that Tab reaches. */
  private here = "";
  /** Where a selection with Shift begins. */
  private anchor = "";

  constructor(private readonly editor: Editor) {
    const { session, selection } = editor;
    this.problem = new Problem(element("objects-problem"), session);
    session.onChange(() => this.update());
    // What is warned of comes with the frames.
    let messages: unknown = null;
    this.editor.scene.onProgress(() => {
      const newest = this.editor.scene.head?.messages;
      if (newest === messages || this.tree.querySelector("input")) return; // a name that is typed stays
      messages = newest;
      this.update();
    });
    selection.onChange(() => this.update());
    this.tree.addEventListener("click", (event) => this.onClick(event));
    this.tree.addEventListener("dblclick", (event) => this.nameAt(event.target) && this.rename(this.nameAt(event.target)!));
    this.tree.addEventListener("keydown", (event) => this.onKey(event));
    this.tree.addEventListener("focusin", ({ target }) => {
      this.here = this.nameAt(target) ?? this.here;
      this.keepTabStop();
    });
    onContextMenu(this.tree, (target, place) => {
      const name = this.nameAt(target);
      if (!name) return;
      this.focus(name);
      this.openMenu(name, place);
    });
    editor.openMenu = (name, place, more) => this.openMenu(name, place, more);
    this.listenForDrag();
    const add = element<HTMLButtonElement>("add");
    add.addEventListener("click", () => {
      add.setAttribute("aria-expanded", "true");
      openMenu("Add", this.addEntries(), add.getBoundingClientRect(), () => add.setAttribute("aria-expanded", "false"));
    });
  }

  private get objects(): SceneObject[] {
    return this.editor.session.objects.slice(1); // without the scene
  }

  private update(): void {
    const { session, selection } = this.editor;
    if (!session.facts || session.facts.text === null) return;
    const { objects } = this;
    const held = this.nameAt(document.activeElement);
    const place = held === null ? -1 : this.shownNames().indexOf(held);
    const elementsIn = (group?: string): Element[] =>
      objects.filter((each) => each.group === group).map((object) => {
        const item = this.itemOf(object.name);
        const isGroup = object.kind === "group";
        item.update(object, this.iconOf(object), selection.has(object.name), isGroup ? !this.closed.has(object.name) : null, this.editor.warningsAt(object));
        if (isGroup) arrange(item.group, elementsIn(object.name));
        return item.element;
      });
    arrange(this.tree, elementsIn());
    const there = new Set(objects.map(({ name }) => name));
    for (const name of [...this.items.keys()]) if (!there.has(name)) this.items.delete(name);
    const names = this.shownNames();
    if (!names.includes(this.here)) this.here = names.find((name) => name === selection.active?.name) ?? names[Math.min(Math.max(place, 0), names.length - 1)] ?? "";
    this.keepTabStop();
    // The focus goes to what stands where the deleted one stood.
    if (held !== null && !there.has(held)) this.items.get(this.here)?.element.focus();
  }

  private itemOf(name: string): TreeItem {
    const item = this.items.get(name) ?? new TreeItem();
    this.items.set(name, item);
    return item;
  }

  private iconOf({ kind }: SceneObject): string {
    return ["surface", "group", "collider"].includes(kind) ? kind : "force";
  }

  private nameAt(target: EventTarget | null): string | null {
    return target instanceof Element && this.tree.contains(target) ? (target.closest<HTMLElement>("[role=treeitem]")?.dataset.name ?? null) : null;
  }

  /** From top to bottom, without those in closed groups. */
  private shownNames(): string[] {
    return [...this.tree.querySelectorAll<HTMLElement>("[role=treeitem]")].filter((each) => !each.parentElement!.closest("[role=group][hidden]")).map((each) => each.dataset.name!);
  }

  private keepTabStop(): void {
    for (const [name, { element }] of this.items) {
      const tabIndex = name === this.here ? 0 : -1;
      if (element.tabIndex !== tabIndex) element.tabIndex = tabIndex;
    }
  }

  private focus(name: string): void {
    const item = this.items.get(name);
    item?.element.focus({ preventScroll: true });
    item?.element.firstElementChild!.scrollIntoView({ block: "nearest" });
  }

  private choose(name: string, isAdded: boolean): void {
    this.anchor = name;
    this.editor.selection.choose(name, isAdded);
  }

  private chooseTo(name: string): void {
    const names = this.shownNames();
    const ends = [Math.max(names.indexOf(this.anchor), 0), names.indexOf(name)].sort((a, b) => a - b);
    const range = names.slice(ends[0], ends[1] + 1);
    this.editor.selection.set([...range.filter((each) => each !== name), name]);
  }

  private toggle(name: string, isOpen: boolean): void {
    if (isOpen) this.closed.delete(name);
    else this.closed.add(name);
    this.update();
  }

  private onClick(event: MouseEvent): void {
    const name = this.nameAt(event.target);
    if (name === null) return this.editor.selection.set([]);
    this.focus(name);
    if ((event.target as Element).classList.contains("twisty") && this.editor.session.object(name)?.kind === "group") this.toggle(name, this.closed.has(name));
    else if (event.shiftKey) this.chooseTo(name);
    else this.choose(name, event.ctrlKey || event.metaKey);
  }

  // Forces are dragged into groups, by mouse; the menu does the same.
  private listenForDrag(): void {
    const { tree } = this;
    let dragged: string[] = [];
    let over: Element | null = null;
    const mark = (target: Element | null) => {
      if (target === over) return;
      over?.classList.remove("over");
      over = target;
      over?.classList.add("over");
    };
    tree.addEventListener("pointerdown", (event) => {
      const object = this.editor.session.object(this.nameAt(event.target) ?? "");
      const row = (event.target as Element).closest<HTMLElement>(".item");
      if (row && object) row.draggable = event.pointerType === "mouse" && this.iconOf(object) === "force" && this.editor.canChange(object);
    });
    tree.addEventListener("dragstart", (event) => {
      const name = this.nameAt(event.target);
      if (name === null) return;
      if (!this.editor.selection.has(name)) this.choose(name, false);
      dragged = this.chosen.filter((object) => this.iconOf(object) === "force").map((object) => object.name);
      event.dataTransfer!.setData("text/plain", dragged.join(" "));
      event.dataTransfer!.effectAllowed = "move";
    });
    tree.addEventListener("dragover", (event) => {
      const name = dragged.length > 0 ? this.groupAt(event.target) : null;
      mark(name === null ? null : this.items.get(name)!.element);
      if (name !== null) event.preventDefault();
    });
    tree.addEventListener("drop", (event) => {
      const name = this.groupAt(event.target);
      if (name === null) return;
      event.preventDefault();
      void this.group(dragged, [name]);
    });
    tree.addEventListener("dragend", () => {
      dragged = [];
      mark(null);
    });
  }

  /** The group there, or that of the force there. */
  private groupAt(target: EventTarget | null): string | null {
    const object = this.editor.session.object(this.nameAt(target) ?? "");
    return object?.kind === "group" ? object.name : (object?.group ?? null);
  }

  private onKey(event: KeyboardEvent): void {
    const isControl = event.ctrlKey || event.metaKey;
    if (event.altKey) return;
    const acts: Record<string, () => void> = {
      ArrowDown: () => this.step(event, 1),
      ArrowUp: () => this.step(event, -1),
      Home: () => this.step(event, -Infinity),
      End: () => this.step(event, Infinity),
      ArrowLeft: () => this.fold(event),
      ArrowRight: () => this.unfold(event),
      Delete: () => this.delete(),
      Backspace: () => this.delete(),
      F2: () => this.rename(this.here),
      Enter: () => this.choose(this.here, isControl),
    };
    const controlled: Record<string, () => void> = { d: () => void this.duplicate(), " ": () => this.choose(this.here, true) };
    const act = (isControl && controlled[event.key.toLowerCase()]) || acts[event.key];
    if (!act) return;
    event.preventDefault();
    event.stopPropagation();
    act();
  }

  private step(event: KeyboardEvent, way: number): void {
    const names = this.shownNames();
    const name = names[Math.min(Math.max(names.indexOf(this.here) + way, 0), names.length - 1)];
    if (name === undefined) return;
    this.focus(name);
    if (event.shiftKey) this.chooseTo(name);
    else if (!event.ctrlKey && !event.metaKey) this.choose(name, false);
  }

  private fold(event: KeyboardEvent): void {
    const object = this.editor.session.object(this.here);
    if (object?.kind === "group" && !this.closed.has(object.name)) this.toggle(object.name, false);
    else if (object?.group) this.step(event, this.shownNames().indexOf(object.group) - this.shownNames().indexOf(this.here));
  }

  private unfold(event: KeyboardEvent): void {
    const object = this.editor.session.object(this.here);
    if (object?.kind !== "group") return;
    if (this.closed.has(object.name)) this.toggle(object.name, true);
    else if (this.objects.some(({ group }) => group === object.name)) this.step(event, 1);
  }

  // What is done to objects

  private get chosen(): SceneObject[] {
    const { session, selection } = this.editor;
    return selection.names.map((name) => session.object(name)).filter((each) => each !== undefined);
  }

  private apply(operations: Operation[]): Promise<boolean> {
    return this.problem.attempt(() => this.editor.session.apply(operations));
  }

  private delete(): void {
    if (this.chosen.length > 0) void this.apply([{ op: "delete", objects: this.chosen.map(({ name }) => name) }]);
  }

  private rename(name: string): void {
    if (!this.editor.session.object(name)) return;
    this.items.get(name)?.edit(async (wanted) => {
      if (!wanted) return this.problem.clear();
      const hadFocus = this.nameAt(document.activeElement) === name;
      if (!(await this.apply([{ op: "rename", object: name, name: wanted }]))) return;
      await this.editor.session.read().catch(() => {});
      if (hadFocus) this.focus(wanted);
    });
  }

  private async duplicate(): Promise<void> {
    const nameFor = freeNames(this.editor.session);
    const copies = this.editor.selection.outermost.map(({ name }) => ({ op: "duplicate", object: name, name: nameFor(name) }));
    if (copies.length > 0 && (await this.apply(copies))) await this.show(copies.map(({ name }) => name));
  }

  private async group(forces: string[], groups: string[]): Promise<void> {
    const name = groups[0] ?? freeNames(this.editor.session)("group");
    if (await this.apply([{ op: "group", forces, name }])) await this.show([name]);
  }

  /** Selects what was just made. */
  private async show(names: string[]): Promise<void> {
    const { session, selection } = this.editor;
    await session.read().catch(() => {});
    const there = names.filter((name) => session.object(name));
    selection.set(there);
    const last = there.at(-1);
    if (last === undefined) return;
    this.anchor = last;
    const isFree = document.activeElement === document.body || document.activeElement === element("add") || this.tree.contains(document.activeElement);
    if (isFree) this.focus(last);
  }

  private openMenu(name: string, place: MenuPlace, more: MenuEntry[] = []): void {
    if (!this.editor.selection.has(name)) this.choose(name, false);
    openMenu(name, [...more, ...this.menu()], place);
  }

  private menu(): MenuEntry[] {
    const { chosen } = this;
    const namesOf = (objects: SceneObject[]) => objects.map(({ name }) => name);
    const isRead = chosen.some((object) => !this.editor.canChange(object));
    const groups = namesOf(chosen.filter(({ kind }) => kind === "group"));
    const forces = namesOf(chosen.filter((object) => this.iconOf(object) === "force"));
    const canGroup = forces.length > 0 && groups.length < 2 && forces.length + groups.length === chosen.length;
    return [
      { label: "Rename", keys: "F2", isDisabled: chosen.length !== 1 || isRead, act: () => this.rename(chosen[0].name) },
      { label: "Duplicate", keys: "Ctrl D", act: () => void this.duplicate() },
      { label: "Group", isDisabled: !canGroup || isRead, act: () => void this.group(forces, groups) },
      { label: "Ungroup", isDisabled: groups.length === 0 || groups.length !== chosen.length || isRead, act: () => void this.apply([{ op: "ungroup", groups }]) },
      { label: "Delete", keys: "Del", isDisabled: isRead, act: () => this.delete() },
    ];
  }

  // What is added

  private addEntries(): MenuEntry[] {
    return kindsToAdd(this.editor.session.format).flatMap(({ title, kinds }) => [
      title,
      ...kinds.map((kind) => {
        const label = titleOf(kind);
        return kind === "mesh" ? { label: `${label}…`, act: () => void this.addMesh() } : { label, act: () => void this.addKind(kind) };
      }),
    ]);
  }

  private async addMesh(): Promise<void> {
    const add = (mesh: Mesh) => this.add({ kind: "mesh", ...mesh });
    await this.problem.attempt(() => askForMesh(this.editor.session, "Add a mesh", add, (name) => void this.show([name])));
  }

  private async addKind(kind: string): Promise<void> {
    let name = "";
    if (await this.problem.attempt(async () => (name = await this.add({ kind })))) await this.show([name]);
  }

  /** Returns its name. */
  private async add(added: { kind: string } & Partial<Mesh>): Promise<string> {
    const { session, selection } = this.editor;
    const { active } = selection;
    const surface = active?.kind === "surface" ? { surface: active.name } : {};
    return (await session.post("add", { ...added, ...surface })).object!;
  }
}

export function mountOutliner(editor: Editor): void {
  new Outliner(editor);
}
