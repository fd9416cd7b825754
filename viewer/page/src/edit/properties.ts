// The region Properties: all that the format says of what is selected.

import { element, make } from "../element";
import { arrange, setAttribute } from "./arrange";
import { AttributeRow } from "./attribute_row";
import type { Editor } from "./editor";
import { onContextMenu, openMenu } from "./menu";
import { Problem } from "./problem";
import type { SceneObject } from "./session";
import { sharedAttributes, type AttributeGroup } from "./shared_attributes";

/** What else stands below the attributes of one object; made anew for another one. */
export const extraGroups: ((editor: Editor, object: SceneObject) => HTMLElement | null)[] = [];

class Properties {
  private readonly problem: Problem;
  private readonly place = element<HTMLElement>("attributes");
  private readonly groups = new Map<string, HTMLDetailsElement>();
  private readonly rows = new Map<string, AttributeRow>();
  private extras: HTMLElement[] = [];
  private shown = "";

  constructor(private readonly editor: Editor) {
    const { session, selection, playback, scene } = editor;
    this.problem = new Problem(element("properties-problem"), session);
    session.onChange(() => this.update());
    selection.onChange(() => {
      this.problem.clear();
      this.update();
    });
    playback.onChange(() => this.showValues());
    scene.onChange(() => this.showValues());
    onContextMenu(this.place, (target, place) => {
      const row = [...this.rows.values()].find((each) => each.element.contains(target));
      if (row) openMenu("Attribute", row.menu(target), place);
    });
  }

  private update(): void {
    const { session, selection } = this.editor;
    if (!session.facts || session.facts.text === null) return;
    const { objects } = selection;
    this.showHead(objects);
    const groups = sharedAttributes(session, objects);
    const keys = new Set(groups.flatMap(({ attributes }) => attributes.map(({ key }) => key)));
    for (const key of [...this.rows.keys()]) if (!keys.has(key)) this.rows.delete(key);
    this.makeExtras(objects);
    arrange(this.place, [...this.extras, ...groups.map((group) => this.groupOf(group))]);
  }

  private showHead(objects: SceneObject[]): void {
    const { session } = this.editor;
    const [first] = objects;
    const isOne = objects.length === 1;
    const kind = session.format.elements.find(({ name }) => name === first?.kind);
    const set = (id: string, text: string) => {
      const place = element<HTMLElement>(id);
      if (place.textContent !== text) place.textContent = text;
      place.hidden = text === "";
    };
    set("properties-title", first === session.objects[0] ? "Scene" : isOne ? first.name : `${objects.length} objects`);
    set("properties-kind", isOne && first !== session.objects[0] ? [first.kind, first.shape].filter(Boolean).join(", ") : "");
    setAttribute(element("properties-kind"), "title", kind?.meaning.replaceAll("`", "") ?? null);
    const files = [...new Set(objects.map(({ file }) => file).filter((file) => file !== undefined))];
    set("properties-note", files.length > 0 ? `Read-only here: it stands in ${files.join(", ")}.` : "");
  }

  private groupOf({ element: name, title, attributes }: AttributeGroup): HTMLElement {
    let group = this.groups.get(name);
    if (!group) {
      group = make("details", { open: true, className: "group" }, make("summary"), make("div"));
      this.groups.set(name, group);
    }
    const [summary, place] = group.children;
    if (summary.textContent !== title) summary.textContent = title;
    const rows = attributes.map((shared) => {
      const row = this.rows.get(shared.key);
      if (row) {
        row.update(shared);
        return row.element;
      }
      const made = new AttributeRow(this.editor, this.problem, shared);
      this.rows.set(shared.key, made);
      return made.element;
    });
    arrange(place, rows);
    return group;
  }

  private makeExtras(objects: SceneObject[]): void {
    const shown = objects.map(({ name, kind }) => `${kind} ${name}`).join("\n");
    if (shown === this.shown) return;
    this.shown = shown;
    this.extras = objects.length === 1 ? extraGroups.map((make) => make(this.editor, objects[0])).filter((each) => each !== null) : [];
  }

  private showValues(): void {
    for (const row of this.rows.values()) if (row.isAnimated) row.showValues();
  }
}

export function mountProperties(editor: Editor): void {
  new Properties(editor);
}
