// The tools over the curves: numbers and words of the keys that are chosen, fewer keys, and keys at even frames.

import type { Channel } from "../bake";
import type { CurvePanel } from "../curves";
import { element, make } from "../element";
import { button } from "../page";
import { arrange, setAttribute } from "./arrange";
import { evaluated } from "./arithmetic";
import { ChoiceField } from "./choice_field";
import type { CurveKeys } from "./curve_keys";
import { Dialog } from "./dialog";
import type { Editor } from "./editor";
import { readOnly, writable } from "./key_set";
import { NumberField } from "./number_field";
import { Problem } from "./problem";
import { Gesture, type Operation } from "./session";

/** How a new timing function is bent until somebody bends it otherwise: as `ease` of CSS. */
const easeControl = "0.25 0.1 0.25 1";

export function mountCurveTools(editor: Editor, panel: CurvePanel, keys: CurveKeys): void {
  new CurveTools(editor, panel, keys);
}

class CurveTools {
  private readonly problem: Problem;
  private readonly frame: NumberField;
  private readonly value: NumberField;
  private readonly words: { field: ChoiceField; wordsOf: () => string[]; allOf: () => string[] }[];

  constructor(
    private readonly editor: Editor,
    private readonly panel: CurvePanel,
    private readonly keys: CurveKeys,
  ) {
    this.problem = new Problem(element("keys-problem"), editor.session);
    this.frame = this.numberField("Frame", (held, text) => held.toFrame(Number(text)), true);
    this.value = this.numberField("Value", (held, text) => held.toValue(text), false);
    const chosen = () => writable(editor, keys.chosen);
    const ofKeys = () => keys.places.flatMap((place) => keys.keyAt(place) ?? []);
    this.words = [
      this.choiceField("Tangent", "key", "tangent", (tangent) => [{ op: "setTangent", keys: chosen(), tangent }], () => ofKeys().flatMap((key) => [key.in, key.out])),
      this.choiceField("Interpolation", "key", "interpolation", (interpolation) => [{ op: "setInterpolation", keys: chosen(), interpolation, ...(interpolation === "cubicBezier" ? { control: easeControl } : {}) }], () => ofKeys().map(({ next }) => next)),
      this.choiceField("Before", "animate", "before", (before) => this.outside(before, (said) => ({ before: said })), () => this.channels.map(({ before }) => before)),
      this.choiceField("After", "animate", "after", (after) => this.outside(after, (said) => ({ after: said })), () => this.channels.map(({ after }) => after)),
    ];
    const fields = [["Frame", this.frame.input], ["Value", this.value.input], ["Tangent", this.words[0].field.input], ["Interpolation", this.words[1].field.input], ["Before", this.words[2].field.input], ["After", this.words[3].field.input]] as const;
    arrange(element("key-fields"), fields.map(([name, input]) => make("label", {}, make("span", {}, name), input)));
    button("break-tangents", () => void keys.toggleBreak());
    button("fit-curves", () => keys.fit());
    new SimplifyDialog(editor, () => this.channels, keys);
    new BakeDialog(editor, () => this.channels);
    keys.onChange(() => this.update());
    this.update();
  }

  /** Those of which keys are chosen, or else all that are shown. */
  private get channels(): Channel[] {
    const { shown } = this.panel;
    const paths = this.keys.chosen.map(({ channel }) => channel);
    return paths.length > 0 ? shown.filter(({ path }) => paths.includes(path)) : shown;
  }

  // A slope is level until somebody says another one, a number for each component.
  private outside(word: string, told: (said: string) => object): Operation[] {
    return this.channels.map(({ path, components }) => ({ op: "setExtrapolation", channels: [path], ...told(word === "slope" ? word + " 0".repeat(components) : word) }));
  }

  private numberField(name: string, operationsOf: (held: ReturnType<CurveKeys["hold"]>, text: string) => Operation[], isFrame: boolean): NumberField {
    const { editor, keys } = this;
    const come = (text: string) => (isFrame ? keys.letGo(Number(text)) : keys.letGo());
    const give = async (text: string) => {
      if (!Number.isFinite(Number(text)) || text === "") throw new Error(`${name}: "${text}" is not a number`);
      const held = keys.hold();
      try {
        await editor.session.apply(operationsOf(held, text));
        await editor.session.known();
        come(text);
      } catch (error) {
        keys.letGo();
        throw error;
      }
    };
    let last = "";
    const moving = {
      size: () => (isFrame ? 1 : Math.max(...this.panel.scales.values.map(Math.abs)) || 1),
      begin: (tell: (refusal: string) => void) => {
        const held = keys.hold();
        const gesture = new Gesture(editor.session, tell);
        last = "";
        const hold = (text: string) => gesture.send(operationsOf(held, (last = text)));
        return { hold, end: () => gesture.end(), cancel: () => gesture.cancel() };
      },
      ended: async (isMade: boolean) => {
        await editor.session.known();
        if (isMade && last !== "") come(last);
        else keys.letGo();
      },
    };
    return new NumberField(name, give, this.problem, { isWhole: isFrame, isRatio: false }, moving);
  }

  private choiceField(name: string, of: string, attribute: string, operationsOf: (word: string) => Operation[], wordsOf: () => string[]): CurveTools["words"][number] {
    const give = (word: string) => this.editor.session.apply(operationsOf(word));
    const allOf = () => this.editor.session.format.elements.find((each) => each.name === of)?.attributes.find((each) => each.name === attribute)?.words ?? [];
    return { field: new ChoiceField(name, give, this.problem), wordsOf, allOf };
  }

  private update(): void {
    const { keys } = this;
    if (!this.editor.session.format) return;
    const { places } = keys;
    const numbers = places.map((place) => keys.keyAt(place)?.at[1 + place.part]).filter((each) => each !== undefined);
    const show = (field: NumberField, all: number[]) => {
      field.show(all.length > 0 ? String(all[0]) : "", all.some((each) => each !== all[0]), "");
      field.input.disabled = places.length === 0;
    };
    // From the first of them all are moved.
    show(this.frame, places.map(({ frame }) => frame).sort((a, b) => a - b));
    show(this.value, numbers);
    for (const { field, wordsOf, allOf } of this.words) {
      const words = wordsOf();
      field.show(words[0] ?? "", words.some((word) => word !== words[0]), allOf());
      field.input.disabled = words.length === 0;
    }
    const parting = element<HTMLButtonElement>("break-tangents");
    parting.disabled = places.length === 0;
    setAttribute(parting, "aria-pressed", String(keys.isBroken));
    for (const id of ["simplify", "bake-keys", "fit-curves"]) element<HTMLButtonElement>(id).disabled = this.channels.length === 0;
  }
}

const named = (channels: Channel[]) => channels.map(({ path }) => path).join(", ");

/** Fewer keys, shown while the tolerance is typed. */
class SimplifyDialog {
  private readonly dialog = new Dialog("simplify-dialog");
  private readonly tolerance = this.dialog.control<HTMLInputElement>("tolerance");
  private readonly result = element<HTMLOutputElement>("simplify-result");
  private gesture: Gesture | null = null;
  /** Whose refusals are shown. */
  private told: Gesture | null = null;
  private channels: Channel[] = [];
  private frames: number[] = [];

  constructor(
    private readonly editor: Editor,
    channelsOf: () => Channel[],
    keys: CurveKeys,
  ) {
    button("simplify", () => this.open(channelsOf(), keys));
    this.tolerance.addEventListener("input", () => this.send());
    this.dialog.onSubmit(() => void this.end());
    this.dialog.element.addEventListener("close", () => this.cancel());
    editor.scene.onChange((isNew) => isNew && this.tell());
  }

  private open(channels: Channel[], keys: CurveKeys): void {
    this.channels = channels.filter((channel) => writable(this.editor, [{ channel: channel.path, frames: [] }]).length > 0);
    const frames = keys.places.map(({ frame }) => frame);
    this.frames = new Set(frames).size > 1 ? [Math.min(...frames), Math.max(...frames)] : [];
    element("simplify-of").textContent = named(this.channels) + (this.frames.length > 0 ? `, frames ${this.frames[0]} to ${this.frames[1]}` : "");
    const values = this.channels.flatMap(({ points }) => points.flatMap(([, ...each]) => each));
    const range = values.reduce((most, each) => Math.max(most, each), -Infinity) - values.reduce((least, each) => Math.min(least, each), Infinity);
    this.tolerance.value = String(Number((0.01 * (range > 0 && Number.isFinite(range) ? range : 1)).toPrecision(1)));
    this.dialog.open(this.channels.length === 0 ? readOnly : "");
    this.tolerance.select();
    this.tell();
    this.send();
  }

  private send(): void {
    const tolerance = evaluated(this.tolerance.value);
    if (!Number.isFinite(tolerance)) {
      this.cancel();
      return this.dialog.say(`"${this.tolerance.value}" is not a number`);
    }
    if (this.channels.length === 0) return;
    this.gesture ??= this.begin();
    const [first, last] = this.frames;
    this.gesture.send([{ op: "simplifyKeys", channels: this.channels.map(({ path }) => path), tolerance, ...(this.frames.length > 0 ? { first, last } : {}) }]);
  }

  // Answers to one that is given up come later than what is said then.
  private begin(): Gesture {
    const gesture: Gesture = new Gesture(this.editor.session, (refusal) => this.told === gesture && this.dialog.say(refusal));
    return (this.told = gesture);
  }

  private tell(): void {
    if (!this.dialog.isOpen) return;
    const before = this.channels.reduce((sum, { keys }) => sum + keys.length, 0);
    const now = this.channels.reduce((sum, { path }) => sum + this.editor.keysOf(path).length, 0);
    this.result.textContent = `${now} of ${before} keys`;
  }

  // What is typed after a refusal is another gesture.
  private async end(): Promise<void> {
    if (!this.gesture) this.send();
    const { gesture } = this;
    this.gesture = null;
    if (await gesture?.end()) this.dialog.close();
  }

  private cancel(): void {
    void this.gesture?.cancel();
    this.gesture = this.told = null;
  }
}

class BakeDialog {
  private readonly dialog = new Dialog("bake-dialog");

  constructor(
    private readonly editor: Editor,
    channelsOf: () => Channel[],
  ) {
    let channels: Channel[] = [];
    const field = (name: string) => this.dialog.control<HTMLInputElement>(name);
    button("bake-keys", () => {
      channels = channelsOf().filter((channel) => writable(editor, [{ channel: channel.path, frames: [] }]).length > 0);
      const frames = channels.flatMap(({ keys }) => [keys[0].at[0], keys[keys.length - 1].at[0]]);
      element("bake-of").textContent = named(channels);
      field("first").value = frames.length > 0 ? String(frames.reduce((a, b) => Math.min(a, b))) : "";
      field("last").value = frames.length > 0 ? String(frames.reduce((a, b) => Math.max(a, b))) : "";
      field("step").value ||= "1";
      this.dialog.open(channels.length === 0 ? readOnly : "");
    });
    this.dialog.onSubmit(async () => {
      if (channels.length === 0) return;
      const numbers = ["first", "last", "step"].map((name) => evaluated(field(name).value));
      const wrong = ["first", "last", "step"].find((_, k) => !Number.isFinite(numbers[k]));
      if (wrong) return this.dialog.say(`"${field(wrong).value}" is not a number`);
      const [first, last, step] = numbers;
      const isLinear = this.dialog.control<HTMLSelectElement>("between").value === "linear";
      const operation = { op: "bakeKeys", channels: channels.map(({ path }) => path), first, last, step, isLinear };
      if (await this.dialog.try(() => this.editor.session.apply([operation]))) this.dialog.close();
    });
  }
}
