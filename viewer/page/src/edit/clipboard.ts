// What was copied: objects, by their names and as the file had them, or keys of curves.

import type { CurveKeys } from "./curve_keys";
import type { Editor } from "./editor";
import type { KeysOf } from "./key_set";
import { freeNames } from "./names";
import type { Operation, Session } from "./session";
import type { TimelineKeys } from "./timeline_keys";

/** Keys of an attribute of an object. */
interface CopiedCurve {
  object: string;
  /** Behind the object's name in the path. */
  rest: string;
  components: number;
  /** What its <animate> says for keys that do not. */
  defaults: [string, string][];
  /** From the first frame that was copied, and the attributes of a <key>. */
  keys: { after: number; attributes: [string, string][] }[];
}

/** Makes an object again: under that name, in that group, with names for what is in it. */
type Again = (name: string, nameFor: (wanted: string) => string, group?: string) => Operation[];

interface CopiedObject {
  name: string;
  /** Null: it has more than attributes and curves. */
  again: Again | null;
}

/** `selected`: when keys of the timeline were copied; null for those of the panel. */
type Content = { objects: CopiedObject[] } | { curves: CopiedCurve[]; selected: readonly string[] | null };

export class Clipboard {
  private content: Content = { objects: [] };

  constructor(
    private readonly editor: Editor,
    private readonly curves: CurveKeys,
    private readonly keys: TimelineKeys,
  ) {}

  copy(): void {
    const { held } = this;
    const selected = held === this.keys ? this.editor.selection.names : null;
    this.content = held ? { curves: this.copiedCurves(held.chosen), selected } : { objects: this.copiedObjects() };
  }

  async cut(): Promise<void> {
    const { held } = this;
    if (held) {
      this.copy();
      return held.delete();
    }
    const objects = this.copiedObjects();
    const lasting = objects.find(({ again }) => again === null);
    if (lasting) return this.editor.say(`${lasting.name} has parts that could not be pasted; copy it, or delete it`);
    const names = objects.map(({ name }) => name);
    if (names.length > 0 && (await this.editor.apply([{ op: "delete", objects: names }], `cut ${names.join(", ")}`))) this.content = { objects };
  }

  async paste(): Promise<void> {
    const { content, editor } = this;
    if ("curves" in content) return this.pasteCurves(content);
    const { session } = editor;
    const nameFor = freeNames(session);
    const lost = content.objects.find(({ name, again }) => again === null && !session.object(name));
    if (lost) return editor.say(`${lost.name} is not there any more, and has parts that could not be pasted`);
    const names = content.objects.map(({ name }) => nameFor(name));
    const operations = content.objects.flatMap(({ name, again }, k) => (session.object(name) ? [{ op: "duplicate", object: name, name: names[k] }] : again!(names[k], nameFor)));
    if (!(await editor.apply(operations, `paste ${names.join(", ")}`))) return;
    await session.known();
    editor.selection.set(names);
  }

  private copiedObjects(): CopiedObject[] {
    const { session, selection } = this.editor;
    return selection.outermost.map(({ name, group, lines }) => {
      const text = (session.facts.text ?? "").split("\n").slice(lines[0] - 1, lines[1]).join("\n");
      return { name, again: againOf(session, new DOMParser().parseFromString(text, "text/xml").documentElement, group) };
    });
  }

  /** Where keys are chosen, and meant. */
  private get held(): CurveKeys | TimelineKeys | null {
    return [this.curves, this.keys].find(({ isMeant }) => isMeant) ?? null;
  }

  private copiedCurves(chosen: KeysOf[]): CopiedCurve[] {
    const { session, scene } = this.editor;
    const first = Math.min(...chosen.flatMap(({ frames }) => frames));
    return chosen.flatMap(({ channel: path, frames }) => {
      const object = session.objects.find(({ name }) => path.startsWith(`${name}.`));
      const channel = scene.head.channels.find((each) => each.path === path);
      if (!object || !channel) return [];
      const rest = path.slice(object.name.length);
      const written = curveWritten(session, object.lines, rest.slice(1));
      const wanted = new Set(frames);
      const keys = channel.keys.flatMap(({ at: [frame, ...numbers] }) => {
        if (!wanted.has(frame)) return [];
        const attributes = written.keys.get(frame)?.filter(([name]) => name !== "frame") ?? [];
        const hasValue = attributes.some(([name]) => name === "value");
        return [{ after: frame - first, attributes: hasValue ? attributes : [...attributes, ["value", numbers.join(" ")] as [string, string]] }];
      });
      return [{ object: object.name, rest, components: channel.components, defaults: written.defaults, keys }];
    });
  }

  // To the curves that are shown, if the focus is there; otherwise to the same attribute of what is selected, or to where
  // they are from, also while that is still selected. Keys of one channel go to any of its dimension.
  private async pasteCurves({ curves, selected }: { curves: CopiedCurve[]; selected: readonly string[] | null }): Promise<void> {
    const { editor } = this;
    const { session, selection, playback } = editor;
    const toShown = (curve: CopiedCurve, k: number) => {
      const fitting = this.curves.channels.filter(({ components }) => components === curve.components);
      if (curves.length === 1) return fitting;
      const same = fitting.filter(({ path }) => path === curve.object + curve.rest);
      const alike = fitting.filter(({ path }) => path.endsWith(curve.rest));
      return same.length > 0 ? same : alike.length > 0 ? alike : fitting.slice(k, k + 1);
    };
    const isBack = selection.names.length === 0 || selection.names.join() === selected?.join();
    const toSelected = (curve: CopiedCurve) =>
      (isBack ? [curve.object] : selection.names).flatMap((object) => {
        const fitting = (session.object(object)?.attributes ?? []).filter(({ components, excluded }) => components === curve.components && !excluded);
        const same = fitting.find(({ path }) => path === object + curve.rest);
        return same ?? (curves.length === 1 ? (fitting.find(({ animated }) => animated) ?? fitting.find(({ given }) => given)) : undefined) ?? [];
      });
    const placesOf: (curve: CopiedCurve, k: number) => { path: string }[] = this.curves.hasFocus ? toShown : toSelected;
    const operations = curves.flatMap((curve, k) => placesOf(curve, k).map(({ path }) => pasted(curve, path, playback.frame)));
    if (operations.length === 0 && curves.length > 0) return editor.say(`${this.curves.hasFocus ? "What is shown" : "What is selected"} has no channels for these keys`);
    await editor.apply(operations, "paste keys");
  }
}

/** The curve of an attribute as the text of an object has it: what its <animate> says of keys, and the attributes of these, by their frames. */
function curveWritten(session: Session, [first, last]: [number, number], attribute: string): { defaults: [string, string][]; keys: Map<number, [string, string][]> } {
  const text = (session.facts.text ?? "").split("\n").slice(first - 1, last).join("\n");
  const root = new DOMParser().parseFromString(text, "text/xml").documentElement;
  // `center.progress` stands in the path of `center`.
  const attributeOf = (each: Element | null) => each?.getAttribute("attribute")?.trim();
  const titleOf = (each: Element) => [attributeOf(each.closest("path")) ?? [], attributeOf(each)].flat().join(".");
  const curve = [...root.querySelectorAll("animate")].find((each) => titleOf(each) === attribute && each.closest("[name]") === root);
  const keys = [...(curve?.children ?? [])].filter(({ tagName }) => tagName === "key");
  const attributesOf = (each?: Element) => [...(each?.attributes ?? [])].map(({ name, value }): [string, string] => [name, value]).filter(([, value]) => !value.includes("$"));
  const defaults = attributesOf(curve).filter(([name]) => ["tangent", "interpolation", "overshoot"].includes(name));
  return { defaults, keys: new Map(keys.map((key) => [Number(key.getAttribute("frame")), attributesOf(key)])) };
}

/** Puts keys into a channel, in place of those that it has among them. */
function pasted({ defaults, keys }: CopiedCurve, path: string, frame: number): Operation {
  const text = document.implementation.createDocument(null, "animate");
  const animate = text.documentElement;
  for (const [name, value] of [...defaults, ["attribute", path.split(".").pop()!]]) animate.setAttribute(name, value);
  for (const { after, attributes } of keys) {
    const key = text.createElement("key");
    key.setAttribute("frame", String(frame + after));
    for (const [name, value] of attributes) key.setAttribute(name, value);
    animate.append(key);
  }
  return { op: "splice", channel: path, first: frame + keys[0].after, last: frame + keys[keys.length - 1].after, curve: new XMLSerializer().serializeToString(animate) };
}

// Of a force, a group of such, or a surface or collider with its shape and parts.
function againOf(session: Session, element: Element, ownGroup = ""): Again | null {
  const object = session.object(element.getAttribute("name") ?? "");
  if (object?.kind !== element.tagName || object.file !== undefined) return null;
  const isCurve = ({ tagName }: Element) => tagName === "animate";
  const inner = [...element.children].filter((each) => !isCurve(each));
  const isGroup = object.kind === "group";
  const members = isGroup ? inner.map((each) => ({ name: each.getAttribute("name") ?? "", again: againOf(session, each) })) : [];
  const parts = isGroup || object.shape === undefined ? [element] : [element, ...inner];
  const curves = parts.flatMap((part) => [...part.children].filter(isCurve));
  const given = parts.flatMap((part) => [...part.attributes].map(({ name, value }) => ({ attribute: name, value }))).filter(({ attribute }) => attribute !== "name");
  const hasMore = !isGroup && parts.some(({ children }) => [...children].some((each) => !isCurve(each) && !parts.includes(each)));
  // Else it is not clear where it stands.
  const isClear = given.every(({ attribute }) => object.attributes.filter(({ name }) => name === attribute).length < 2);
  if (hasMore || !isClear || members.some(({ again }) => again === null)) return null;
  return (name, nameFor, group = ownGroup) => [
    { op: "add", kind: object.kind, name, attributes: given, group, shape: object.shape ?? "" },
    ...curves.map((curve) => ({ op: "setCurve", channel: `${name}.${curve.getAttribute("attribute")}`, curve: new XMLSerializer().serializeToString(curve) })),
    ...members.flatMap((member) => member.again!(nameFor(member.name), nameFor, name)),
  ];
}
