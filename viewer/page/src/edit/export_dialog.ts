// Writes the animation as `bake`, `view --movie` and `replay record` do, while one goes on.

import { element, make } from "../element";
import { button } from "../page";
import { Dialog } from "./dialog";
import type { Editor } from "./editor";

/** What an `export` event tells. */
export interface ExportState {
  file: string;
  done: number;
  total: number;
  state: "running" | "done" | "failed" | "stopped";
  errors?: { message: string; file?: string; line?: number }[];
}

/** What can be written, by the ending of the file; a movie is of all surfaces, in world space, and a log of all frames too. */
const kinds: { ending: string; name: string; of?: "frames" | "scene" }[] = [
  { ending: ".glb", name: "glTF, one file" },
  { ending: ".gltf", name: "glTF" },
  { ending: ".usda", name: "USD" },
  { ending: ".pc2", name: "Point cache PC2" },
  { ending: ".mdd", name: "Point cache MDD" },
  { ending: ".obj", name: "OBJ, a file a frame" },
  { ending: ".ply", name: "PLY, a file a frame" },
  { ending: ".npy", name: "NumPy" },
  { ending: ".mp4", name: "Movie, MP4", of: "frames" },
  { ending: ".webm", name: "Movie, WebM", of: "frames" },
  { ending: ".gif", name: "Movie, GIF", of: "frames" },
  { ending: ".replay", name: "Replay log", of: "scene" },
];

export class ExportDialog {
  private readonly dialog = new Dialog("export-dialog");
  private readonly kind = this.dialog.control<HTMLSelectElement>("kind");
  private readonly file = this.dialog.control<HTMLInputElement>("file");
  private readonly frames = this.dialog.control<HTMLInputElement>("frames");
  private readonly surface = this.dialog.control<HTMLSelectElement>("surface");
  private readonly space = this.dialog.control<HTMLSelectElement>("space");
  private readonly stop = this.dialog.control<HTMLButtonElement>("stop");
  private readonly submit = this.dialog.form.querySelector<HTMLButtonElement>("[type=submit]")!;
  private readonly progress = element<HTMLProgressElement>("export-progress");
  private readonly result = element<HTMLOutputElement>("export-result");
  private suggested = "";
  private range = "";

  constructor(private readonly editor: Editor) {
    this.kind.append(...kinds.map(({ ending, name }) => make("option", { value: ending }, `${name} (${ending})`)));
    button("export", () => this.open());
    this.kind.addEventListener("change", () => {
      this.file.value = this.file.value.replace(/(\.[^./]*)?$/, this.kind.value);
      this.update();
    });
    this.file.addEventListener("input", () => this.update());
    this.dialog.onSubmit(() => void this.begin());
    this.dialog.onPress("stop", () => void this.dialog.try(() => this.post({ stop: true })));
    editor.session.onChange(() => {
      if (!editor.session.isAlive) this.setRunning(false);
    });
  }

  /** Takes what the command tells of an export, of this page or of another. */
  take({ file, done, total, state, errors = [] }: ExportState): void {
    this.setRunning(state === "running");
    this.progress.max = Math.max(total, 1);
    this.progress.value = state === "stopped" || state === "failed" ? 0 : done;
    this.result.textContent = { running: `${done} of ${total}`, done: `${file} is written, in the folder of the scene`, failed: "", stopped: "Stopped: nothing is written" }[state];
    if (state === "failed") this.dialog.say(errors.map(({ message }) => message).join("\n"));
  }

  private open(): void {
    const { facts, objects } = this.editor.session;
    // What somebody wrote stays.
    const suggested = `${(facts.file || "scene.xml").replace(/\.xml$/, "")}.glb`;
    if (this.file.value === "" || this.file.value === this.suggested) this.file.value = suggested;
    this.suggested = suggested;
    const range = `${facts.start}:${facts.end}`;
    if (this.frames.value === "" || this.frames.value === this.range) this.frames.value = range;
    this.range = range;
    const chosen = this.surface.value;
    const names = objects.filter(({ kind }) => kind === "surface").map(({ name }) => name);
    this.surface.replaceChildren(make("option", { value: "" }, "all"), ...names.map((name) => make("option", { value: name }, name)));
    this.surface.value = names.includes(chosen) ? chosen : "";
    this.update();
    this.dialog.open();
    this.file.setSelectionRange(0, this.file.value.replace(/\.[^./]*$/, "").length);
  }

  private update(): void {
    const kind = kinds.find(({ ending }) => this.file.value.trim().endsWith(ending));
    this.kind.value = kind?.ending ?? "";
    this.surface.disabled = this.space.disabled = kind?.of !== undefined;
    this.frames.disabled = kind?.of === "scene";
  }

  private async begin(): Promise<void> {
    const file = this.file.value.trim();
    if (file === "") return this.dialog.say("A file needs a name");
    const [, first, last] = /^\s*(-?\d+)(?:(?:\s*(?::|\.\.)\s*|\s+|\s*-\s*)(-?\d+))?\s*$/.exec(this.frames.value) ?? [];
    if (first === undefined && !this.frames.disabled) {
      this.dialog.say(`Frames "${this.frames.value}": must be one frame, or the first and the last, as 1:96, 1-96, 1..96 or 1 96`);
      return this.frames.focus();
    }
    this.result.textContent = "";
    this.progress.value = 0;
    this.setRunning(true);
    const frames = this.frames.disabled ? {} : { frames: [Number(first), Number(last ?? first)] };
    const part = this.surface.disabled ? {} : { surface: this.surface.value, space: this.space.value };
    const body = { file, ...frames, ...part };
    if (!(await this.dialog.try(() => this.post(body)))) this.setRunning(false);
  }

  private post(body: object): Promise<unknown> {
    return this.editor.session.requests.post("export", body);
  }

  private setRunning(isRunning: boolean): void {
    const hadFocus = document.activeElement === this.stop || document.activeElement === this.submit;
    this.stop.disabled = !isRunning;
    this.submit.disabled = isRunning;
    if (hadFocus) (isRunning ? this.stop : this.submit).focus();
  }
}
