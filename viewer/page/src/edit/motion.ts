// How a surface moves, in words of who looks at it: how far, how long and how fast. The command finds the numbers for it.

import { make } from "../element";
import type { Editor } from "./editor";
import { Refusal } from "./requests";
import { Gesture, type Outcome, type SceneObject } from "./session";
import { readStarters, type Starters } from "./starters";

type Aim = "peak" | "settling" | "frequency";

/** The answer to `motion`; null: not known. */
interface MotionFacts extends Record<Aim, number | null> {
  reason: string;
}

/** What a request for another motion tells. */
interface MotionOutcome extends Outcome {
  reached?: Partial<Record<Aim, { value: number | null; reason?: string }>>;
}

/** `low` and `high`: what the slider has at least; of a length until the size of the surface is known. */
const aims: { aim: Aim; name: string; unit: string; title: string; low: number; high: number }[] = [
  { aim: "peak", name: "Peak", unit: "", title: "The largest displacement: by the magnitudes of the forces", low: 0.01, high: 1 },
  { aim: "settling", name: "Settling", unit: "s", title: "After this time it stays where it comes to rest: by the damping", low: 0.01, high: 100 },
  { aim: "frequency", name: "Frequency", unit: "Hz", title: "How often it swings in a second: by the density", low: 0.01, high: 100 },
];
const steps = 1000; // of a slider
const rest = 250; // until the motion is asked for after a change [ms]

let shown: MotionGroup | null = null;
let starters: Promise<Starters> | undefined;

/** The group **Motion** of a surface; the same element while it is the same surface. */
export function motionGroup(editor: Editor, object: SceneObject): HTMLElement | null {
  if (object.kind !== "surface" || object.file !== undefined) return null;
  if (!shown) editor.session.onChange(() => shown!.update());
  if (shown?.surface !== object.name) shown = new MotionGroup(editor, object.name);
  shown.update();
  return shown.element;
}

class MotionGroup {
  readonly element: HTMLElement;
  private readonly sliders: AimSlider[];
  private readonly material = make("select", {}, make("option", { value: "" }, "as it is"));
  private readonly refusal = make("p", { className: "refusal", role: "alert" });
  private readonly reason = make("p", { className: "reason quiet" });
  private asked = -1;
  private pending = 0;
  /** What the surface said right after its material was chosen. */
  private chosen: { material: string; revision: number; says: string | null } | null = null;

  constructor(
    private readonly editor: Editor,
    readonly surface: string,
  ) {
    this.sliders = aims.map((aim) => new AimSlider(editor, surface, aim, (message) => this.say(message), () => this.askAgain()));
    this.element = make(
      "div",
      { className: "motion", role: "group", ariaLabel: "Motion" },
      make("h3", { ariaHidden: "true" }, "Motion"),
      ...this.sliders.map(({ element }) => element),
      make("label", { className: "aim" }, make("span", {}, "Material"), this.material),
      this.reason,
      this.refusal,
    );
    this.material.addEventListener("change", () => void this.setMaterial());
    (starters ??= readStarters(editor.session)).then(
      ({ materials }) => this.material.append(...materials.map(({ name, summary }) => make("option", { value: name, title: summary }, `${name}: ${summary}`))),
      () => {},
    );
  }

  update(): void {
    this.showMaterial();
    const { revision } = this.editor.session;
    if (this.asked === revision) return;
    clearTimeout(this.pending);
    this.pending = window.setTimeout(() => void this.ask(), this.asked < 0 ? 0 : rest);
  }

  private askAgain(): void {
    this.asked = -1;
    this.update();
  }

  private async ask(): Promise<void> {
    if (!this.element.isConnected) return;
    const { session } = this.editor;
    const { revision } = session;
    this.asked = revision;
    let facts: MotionFacts;
    try {
      facts = await session.requests.json<MotionFacts>(`motion?revision=${revision}&surface=${encodeURIComponent(this.surface)}`);
    } catch (error) {
      if (!(error instanceof Refusal) || error.status === 409) return; // there is a newer revision
      facts = { peak: null, settling: null, frequency: null, reason: error.message };
    }
    if (revision !== session.revision) return;
    this.reason.textContent = this.sliders.some(({ aim }) => facts[aim] === null) ? facts.reason : "";
    for (const slider of this.sliders) slider.take(facts[slider.aim], facts.reason, revision);
  }

  private async setMaterial(): Promise<void> {
    const material = this.material.value;
    if (material === "") return this.showMaterial();
    try {
      const { revision } = await this.editor.session.post("material", { surface: this.surface, material });
      this.chosen = { material, revision, says: null };
      this.say("");
    } catch (error) {
      this.say((error as Error).message);
    }
    this.showMaterial();
  }

  // A file has no word for a material: it is known as long as the surface says what it said then.
  private showMaterial(): void {
    const { session } = this.editor;
    const { chosen } = this;
    if (document.activeElement === this.material && !chosen) return;
    if (chosen && session.facts.revision >= chosen.revision) {
      const says = JSON.stringify(session.object(this.surface)?.attributes.map(({ path, value }) => [path, value]));
      chosen.says ??= says;
      if (chosen.says !== says) this.chosen = null;
    }
    this.material.value = this.chosen?.material ?? "";
  }

  private say(message: string): void {
    this.refusal.textContent = message;
  }
}

/** A slider whose ways are the same where the number is multiplied by the same. */
class AimSlider {
  readonly aim: Aim;
  readonly element: HTMLElement;
  private readonly input = make("input", { type: "range", min: "0", max: String(steps), step: "1", value: "0", disabled: true });
  private readonly output = make("output", { ariaLive: "off" } as Partial<HTMLOutputElement>, "–");
  private readonly reached = make("p", { className: "reason", role: "status" });
  private readonly unit: string;
  private low: number;
  private high: number;
  private isSized = false;
  private value: number | null = null;
  private gesture: Gesture | null = null;
  /** Gestures that end. */
  private ending = 0;
  /** By the pointer or a key; empty: it is not. */
  private held = "";
  /** The revision that the last request made. */
  private made = -1;

  constructor(
    private readonly editor: Editor,
    private readonly surface: string,
    { aim, name, unit, title, low, high }: (typeof aims)[number],
    private readonly say: (message: string) => void,
    private readonly settled: () => void,
  ) {
    [this.aim, this.unit, this.low, this.high] = [aim, unit, low, high];
    this.input.setAttribute("aria-label", name);
    this.element = make("div", { className: "aim" }, make("span", { title }, name), this.input, this.output, this.reached);
    const { input } = this;
    input.addEventListener("pointerdown", () => (this.held = "pointer"));
    input.addEventListener("keydown", (event) => {
      if (event.key === "Escape" && this.gesture) {
        event.preventDefault();
        event.stopPropagation();
        return this.cancel();
      }
      if (/^(Arrow|Page|Home|End)/.test(event.key)) this.held ||= event.key;
    });
    input.addEventListener("keyup", ({ key }) => key === this.held && this.release());
    for (const end of ["pointerup", "pointercancel", "blur"]) input.addEventListener(end, () => this.release());
    input.addEventListener("input", () => this.drag());
    input.addEventListener("change", () => this.held || this.release());
  }

  /** The value that the scene has; null: not known, for that reason. */
  take(value: number | null, reason: string, revision: number): void {
    if (this.gesture || this.ending > 0) return;
    if (revision !== this.made) this.reached.textContent = "";
    this.value = value;
    const isOff = value === null || !(value > 0);
    this.input.disabled = isOff;
    this.input.title = isOff ? reason : "";
    if (!isOff) this.makeRoom(value);
    this.show(isOff ? null : value);
  }

  // The ends are powers of ten, so that they stay where they are; those of lengths are of the size of the surface.
  private makeRoom(value: number): void {
    const head = this.unit === "" && !this.isSized ? this.editor.scene.head?.surfaces.find(({ name }) => name === this.surface) : undefined;
    const size = head ? Math.hypot(...head.high.map((high, k) => high - head.low[k])) : 0;
    if (size > 0) {
      this.isSized = true;
      this.high = 10 ** Math.ceil(Math.log10(size));
      this.low = this.high / 1e4;
    }
    this.low = Math.min(this.low, 10 ** Math.floor(Math.log10(value)));
    this.high = Math.max(this.high, 10 ** Math.ceil(Math.log10(value)), 10 * this.low);
  }

  private show(value: number | null): void {
    const text = value === null ? "–" : this.textOf(value);
    this.output.textContent = text;
    this.input.setAttribute("aria-valuetext", value === null ? "not known" : text);
    if (value !== null) this.input.value = String(Math.round((steps * Math.log(value / this.low)) / Math.log(this.high / this.low)));
  }

  private textOf(value: number): string {
    return `${Number(value.toPrecision(3))}${this.unit === "" ? "" : ` ${this.unit}`}`;
  }

  private drag(): void {
    if (this.input.classList.contains("cancelled")) return this.show(this.value);
    const value = Number((this.low * (this.high / this.low) ** (this.input.valueAsNumber / steps)).toPrecision(3));
    this.show(value);
    const refuse = (refusal: string) => {
      this.say(refusal);
      if (refusal !== "") this.reached.textContent = "";
    };
    this.gesture ??= new Gesture(this.editor.session, refuse, (outcome) => this.tell(outcome));
    this.gesture.post("motion", { surface: this.surface, [this.aim]: value });
  }

  private tell({ revision, reached }: MotionOutcome): void {
    this.made = revision;
    const mine = reached?.[this.aim];
    this.reached.textContent = mine?.reason ? `${mine.value === null ? "" : `${this.textOf(mine.value)}: `}${mine.reason}` : "";
  }

  private release(): void {
    this.held = "";
    this.input.classList.remove("cancelled");
    void this.finish((gesture) => gesture.end());
  }

  private cancel(): void {
    this.input.classList.add("cancelled"); // until it is let go
    this.reached.textContent = "";
    this.show(this.value);
    void this.finish((gesture) => gesture.cancel());
  }

  // What is chosen meanwhile is a gesture of its own.
  private async finish(act: (gesture: Gesture) => Promise<unknown>): Promise<void> {
    const { gesture } = this;
    if (!gesture) return;
    this.gesture = null;
    ++this.ending;
    await act(gesture);
    if (--this.ending === 0) this.settled();
  }
}
