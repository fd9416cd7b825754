// A row of Properties: an attribute with its controls, its key, and its menu.

import { make } from "../element";
import { arrange, setAttribute } from "./arrange";
import { CheckField, ChoiceField, NamesField } from "./choice_field";
import type { Editor } from "./editor";
import type { MenuEntry } from "./menu";
import { NumberField } from "./number_field";
import type { Problem } from "./problem";
import { Gesture, type AttributeFacts, type Operation } from "./session";
import type { SharedAttribute } from "./shared_attributes";
import { TextField } from "./text_field";

const axes = ["x", "y", "z"];
const partNames: Record<string, string[]> = { "one or two numbers": ["u", "v"], "one or four words": ["u0", "u1", "v0", "v1"] };

const wordsOf = (text: string) => text.trim().split(/\s+/).filter(Boolean);

/** What was copied last, until something else may have been. */
let copied: string | null = null;
for (const name of ["copy", "cut"]) document.addEventListener(name, () => (copied = null));
addEventListener("blur", () => (copied = null));

/** The controls of an attribute. */
interface Controls {
  elements: HTMLElement[];
  inputs: () => (HTMLInputElement | HTMLSelectElement)[];
  show: (text: string, isMixed: boolean, absent: string) => void;
  /** Gives up what is typed. */
  restore: () => unknown;
}

export class AttributeRow {
  readonly element = make("div", { className: "attribute" });
  private readonly label = make("label", { className: "name" });
  private readonly place = make("div", { className: "values" });
  private readonly written = make("code", { className: "written" });
  private readonly key = make("button", { type: "button", className: "key" });
  private controls?: Controls;
  private form = "";

  constructor(
    private readonly editor: Editor,
    private readonly problem: Problem,
    private shared: SharedAttribute,
  ) {
    this.element.append(this.key, this.label, this.place, this.written);
    this.key.addEventListener("click", () => void this.problem.attempt(() => this.toggleKey(), this.key));
    this.update(shared);
  }

  /** Shows the attribute as it is now; its controls stay if they still fit. */
  update(shared: SharedAttribute): void {
    const isOther = shared.objects.some(({ name }, k) => name !== this.shared.objects[k]?.name);
    this.shared = shared;
    const { name, format, facts } = shared;
    if (isOther) this.controls?.restore();
    const form = [name, format.type, this.partCount].join("\n");
    if (form !== this.form) {
      this.form = form;
      this.controls = this.makeControls();
      arrange(this.place, this.controls!.elements);
      // A long name may break before a capital letter.
      this.label.replaceChildren(...name.split(/(?=[A-Z])/).flatMap((part, k) => (k === 0 ? [part] : [make("wbr"), part])));
      this.label.htmlFor = this.controls!.inputs()[0].id = `attribute-${shared.key.replace(" ", "-")}`;
      this.key.setAttribute("aria-label", `Key ${name}`);
    }
    const excluded = facts.map((each) => each.excluded).find((reason) => reason !== undefined);
    const file = facts.map((each) => each.file).find((each) => each !== undefined);
    const help = [excluded, file && `it stands in ${file}, and is read-only here`, ...helpOf(shared)].filter(Boolean).join("\n");
    setAttribute(this.element, "title", help);
    this.element.classList.toggle("absent", facts.every(({ given, animated }) => !given && !animated));
    for (const input of this.controls!.inputs()) {
      setAttribute(input, "aria-description", help);
      const isText = input instanceof HTMLInputElement && input.type === "text";
      if (isText) input.readOnly = !this.canChange && excluded === undefined;
      input.disabled = isText ? excluded !== undefined : excluded !== undefined || !this.canChange;
    }
    const written = facts.map((each) => each.written).find((text) => text !== undefined) ?? "";
    this.written.textContent = written && `written ${written}`;
    this.written.hidden = written === "";
    const isChannel = facts.every(({ components }) => components > 0);
    this.key.classList.toggle("none", !isChannel);
    this.key.disabled = !isChannel || !this.canChange || excluded !== undefined;
    this.showValues();
  }

  /** Shows the values at the playhead. */
  showValues(): void {
    const { facts, format } = this.shared;
    const texts = facts.map((each) => this.editor.textOf(each));
    const isUnknown = facts.some(({ animated }, k) => animated && texts[k] === "");
    const isMixed = texts.some((text) => text !== texts[0]);
    // The curves are known a moment after the attributes; but paths and falloffs are none.
    if (!isUnknown) this.controls!.show(isMixed ? texts[texts.length - 1] : texts[0], isMixed, absentOf(format.default));
    else if (facts.every(({ path }) => this.editor.hasNoCurve(path))) this.controls!.show("", false, format.words ? "a curve" : "a path");
    this.showKey();
  }

  /** Animated attributes follow the playhead. */
  get isAnimated(): boolean {
    return this.shared.facts.some(({ animated }) => animated);
  }

  /** The entries of the menu; `target` is in the row. */
  menu(target: HTMLElement): MenuEntry[] {
    const { facts } = this.shared;
    const can = this.canChange && facts.every(({ excluded }) => excluded === undefined);
    const channels = facts.filter(({ animated, components }) => animated && components > 0);
    const act = (operations: () => Operation[]) => () => void this.problem.attempt(() => this.editor.session.apply(operations()));
    return [
      { label: "Reset", isDisabled: !can || facts.every(({ given, animated }) => !given && !animated), act: act(() => facts.map(({ path }) => ({ op: "reset", path }))) },
      { label: "Copy value", act: () => copy(this.editor.textOf(facts[facts.length - 1])) },
      { label: "Paste value", isDisabled: !can, act: () => void this.problem.attempt(async () => this.paste(await pasted(), target)) },
      { label: "Delete key", isDisabled: !can || !channels.some((each) => this.editor.hasKeyHere(each)), act: act(() => this.deletingKeys()) },
      { label: "Freeze", isDisabled: !can || channels.length === 0, act: act(() => [this.freezing(channels)]) },
      { label: "Copy path", act: () => copy(facts.map(({ path }) => path).join("\n")) },
    ];
  }

  private get canChange(): boolean {
    const { objects, facts } = this.shared;
    return objects.every((object) => this.editor.canChange(object)) && facts.every(({ file }) => file === undefined);
  }

  // How many controls it has.
  private get partCount(): number {
    const { format, facts } = this.shared;
    if (format.type === "vector") return axes.length;
    const { animated, components, value } = facts[facts.length - 1];
    const isSeveral = format.type === "number or vector" || format.type in partNames;
    return isSeveral ? Math.max(animated ? components : wordsOf(value).length, 1) : 1;
  }

  private partName(part: number, count: number): string {
    const { name, format } = this.shared;
    return count === 1 ? name : `${name} ${(partNames[format.type] ?? axes)[part] ?? part + 1}`;
  }

  private makeControls(): Controls {
    const { name, format } = this.shared;
    const give = (text: string) => this.give(text);
    if (format.type === "boolean") {
      const field = new CheckField(name, give, this.problem);
      return { elements: [field.input], inputs: () => [field.input], show: (text, isMixed) => field.show(text, isMixed), restore: () => {} };
    }
    if (format.type === "names") {
      const field = new NamesField(name, give, this.problem);
      const show = (text: string, isMixed: boolean, absent: string) => field.show(text, isMixed, absent, this.surfaces(), this.canChange);
      return { elements: [field.element], inputs: () => [field.field.input], show, restore: () => field.field.isTyped && field.field.restore() };
    }
    if (format.type === "text" && format.surfaces) return this.choices(() => this.surfaces());
    if (format.words) return this.choices(() => format.words!);
    if (["integer", "rate", "vector"].includes(format.type) || format.type.includes("number")) return this.numbers();
    const field = new TextField(name, give, this.problem);
    return { elements: [field.input], inputs: () => [field.input], show: (...shown) => field.show(...shown), restore: () => field.isTyped && field.restore() };
  }

  private choices(words: () => string[]): Controls {
    const { format } = this.shared;
    const count = this.partCount;
    const fields = Array.from({ length: count }, (_, k) => new ChoiceField(this.partName(k, count), (word) => this.givePart(k, count, word), this.problem));
    const most = partNames[format.type]?.length ?? 1;
    return {
      elements: fields.map(({ input }) => input),
      inputs: () => fields.map(({ input }) => input),
      show: (text, isMixed, absent) => {
        const own = wordsOf(text);
        const isOptional = count === 1 && (absent !== "" || text === "");
        const each = count === 1 && most > 1 ? words().map((word) => Array(most).fill(word).join(" ")) : [];
        fields.forEach((field, k) => field.show(own[k] ?? "", isMixed, [...words(), ...each], isOptional ? absent : undefined));
      },
      restore: () => {},
    };
  }

  private numbers(): Controls {
    const count = this.partCount;
    const { format } = this.shared;
    const range = { least: format.least, most: format.most, isWhole: format.type === "integer", isRatio: format.type === "rate" };
    const fields = Array.from({ length: count }, (_, k) => {
      const moving = {
        size: () => this.sizeOf(),
        begin: (tell: (refusal: string) => void, letGo: () => void) => {
          const { recorder, session } = this.editor;
          if (recorder.isOn) return recorder.begin({ attributes: this.shared.facts, part: count === 1 ? null : k, tell, letGo });
          const gesture = new Gesture(session, tell);
          return { hold: (text: string) => gesture.send(this.settingPart(k, count, text)), end: () => gesture.end(), cancel: () => gesture.cancel() };
        },
        ended: () => this.editor.session.known(),
      };
      return new NumberField(this.partName(k, count), (text) => this.givePart(k, count, text), this.problem, range, moving);
    });
    return {
      elements: fields.map(({ input }) => input),
      inputs: () => fields.map(({ input }) => input),
      show: (text, isMixed, absent) => {
        const own = wordsOf(text);
        const short = count > 1 && format.default?.startsWith("(") ? "–" : absent;
        fields.forEach((field, k) => field.show(own[k] ?? "", isMixed && this.isMixedIn(k), short));
      },
      restore: () => fields.forEach((field) => field.isTyped && field.restore()),
    };
  }

  private isMixedIn(part: number): boolean {
    const own = this.shared.facts.map((each) => wordsOf(this.editor.textOf(each))[part]);
    return own.some((text) => text !== own[0]);
  }

  // The size of a value that is 0: of the vector around it, or of the default.
  private sizeOf(): number {
    const { facts, format } = this.shared;
    const texts = [this.editor.textOf(facts[facts.length - 1]), format.default ?? ""];
    for (const text of texts) {
      const size = Math.max(...wordsOf(text).map((word) => Math.abs(Number(word))));
      if (size > 0 && Number.isFinite(size)) return size;
    }
    return 1;
  }

  private surfaces(): string[] {
    return this.editor.session.objects.filter(({ name, kind }) => kind === "surface" && !this.shared.objects.some((each) => each.name === name)).map(({ name }) => name);
  }

  private async give(text: string): Promise<void> {
    const { format, objects } = this.shared;
    if (format.type === "name") await this.editor.session.apply([{ op: "rename", object: objects[0].name, name: text }]);
    else await this.editor.session.apply(this.setting(text));
  }

  private async givePart(part: number, count: number, text: string): Promise<void> {
    await this.editor.session.apply(this.settingPart(part, count, text));
  }

  private setting(text: string): Operation[] {
    return this.shared.facts.map((facts) => (text === "" ? { op: "reset", path: facts.path } : this.editor.toSet(facts, text)));
  }

  // Several words in the field of one are the whole value.
  private settingPart(part: number, count: number, text: string): Operation[] {
    if (count === 1 || wordsOf(text).length > 1) return this.setting(text);
    return this.shared.facts.map((facts) => this.editor.toSetComponent(facts, part, text, count));
  }

  private paste(text: string, target: HTMLElement): Promise<unknown> {
    const inputs: HTMLElement[] = this.controls!.inputs();
    const part = inputs.indexOf(target);
    return part < 0 ? this.give(text) : inputs.length === 1 ? this.give(text) : this.givePart(part, inputs.length, text);
  }

  // Keys

  private showKey(): void {
    const { facts } = this.shared;
    const isKeyed = facts.every((each) => this.editor.hasKeyHere(each));
    setAttribute(this.key, "aria-pressed", isKeyed ? "true" : this.isAnimated ? "mixed" : "false");
    setAttribute(this.key, "title", isKeyed ? "Delete the key here" : "Set a key here");
  }

  private toggleKey(): Promise<unknown> {
    const { facts } = this.shared;
    const { frame } = this.editor.playback;
    if (facts.every((each) => this.editor.hasKeyHere(each))) return this.editor.session.apply(this.deletingKeys());
    const missing = facts.filter((each) => !this.editor.hasKeyHere(each));
    const constants = missing.filter(({ animated }) => !animated).map(({ path }) => path);
    const keys = missing.filter(({ animated }) => animated).map(({ path }): Operation => ({ op: "setKey", channel: path, frame }));
    return this.editor.session.apply(constants.length > 0 ? [{ op: "animate", channels: constants, frame }, ...keys] : keys);
  }

  // A channel whose only key is here becomes constant.
  private deletingKeys(): Operation[] {
    const { frame } = this.editor.playback;
    const here = this.shared.facts.filter((each) => this.editor.hasKeyHere(each));
    const isOnly = ({ path }: AttributeFacts) => new Set(this.editor.keysOf(path)).size === 1;
    const keys = here.filter((each) => !isOnly(each)).map(({ path }) => ({ channel: path, frames: [frame] }));
    const frozen = here.filter(isOnly);
    return [...(keys.length > 0 ? [{ op: "deleteKeys", keys }] : []), ...(frozen.length > 0 ? [this.freezing(frozen)] : [])];
  }

  private freezing(channels: AttributeFacts[]): Operation {
    return { op: "freeze", channels: channels.map(({ path }) => path), frame: this.editor.playback.frame };
  }
}

/** A default in parentheses is what the absence means. */
function absentOf(standard = ""): string {
  return standard.startsWith("(") ? standard.slice(1, -1) : "";
}

function helpOf({ format: { meaning, unit, range, default: standard } }: SharedAttribute): string[] {
  const facts = [unit && `unit: ${unit}`, range && `range: ${range}`, standard && `default: ${absentOf(standard) || standard}`].filter(Boolean);
  return [meaning.replaceAll("`", ""), facts.join(" · ")];
}

function copy(text: string): void {
  copied = text;
  // The page may not be allowed to; then it has the text itself.
  navigator.clipboard?.writeText(text).catch(() => {});
}

async function pasted(): Promise<string> {
  if (copied !== null) return copied;
  const text = await navigator.clipboard?.readText().catch(() => undefined);
  if (text === undefined) throw new Error("the browser does not allow this page to read the clipboard");
  return text.trim();
}
