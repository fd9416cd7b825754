// Everything about the take that is pointed at, and the command that writes it.

import { make, makeSvg } from "../element";
import type { ThemeChoice } from "../theme";
import type { Pointing } from "./pointing";
import type { Studio } from "./studio";
import { commandOf, measureText, textOf, type Sweep } from "./sweep";

export class Details {
  private readonly canvas = make("canvas", { className: "picture" });

  constructor(
    private readonly place: HTMLElement,
    private readonly sweep: Sweep,
    private readonly studio: Studio,
    private readonly pointing: Pointing,
    themes: ThemeChoice,
  ) {
    pointing.onChange(() => this.show());
    themes.onChange(() => this.draw());
    new ResizeObserver(() => this.draw()).observe(place);
    this.show();
  }

  /** Draws the picture anew, after a change of the camera or the colours. */
  draw(): void {
    const { row } = this.pointing;
    const shape = row === null ? undefined : this.sweep.shape(row);
    const isSeen = shape !== undefined && this.studio.canDraw;
    this.canvas.hidden = !isSeen;
    if (!isSeen) return;
    const box = this.canvas.getBoundingClientRect();
    if (box.width === 0) return;
    const ratio = Math.min(devicePixelRatio, 2);
    const [width, height] = [Math.round(box.width * ratio), Math.round(box.height * ratio)];
    [this.canvas.width, this.canvas.height] = [width, height];
    this.studio.draw(shape, this.canvas.getContext("2d")!, 0, 0, width, height);
  }

  /** Copies the command of the take shown. Returns what came of it. */
  async copy(): Promise<string> {
    const { row } = this.pointing;
    if (row === null) return "";
    const button = this.place.querySelector<HTMLButtonElement>(".copy");
    const isCopied = await copied(commandOf(this.sweep, row), this.place.querySelector("code"));
    const words = isCopied ? "Copied" : "Press Ctrl+C";
    if (button) button.querySelector("span")!.textContent = words;
    return words;
  }

  /** The least and the greatest of each measure, which lead to their takes. */
  private ranges(): HTMLElement {
    const lines = this.sweep.measures.map((measure) => {
      const line = make("tr", {}, make("th", { title: `${measure.about} [${measure.unit}]` }, measure.name));
      for (const row of endsOf(measure.values) ?? []) {
        const button = make("button", { type: "button", title: `take ${this.sweep.takes[row]}` }, measureText(measure, row));
        button.addEventListener("click", () => this.pointing.keep(row, this));
        line.append(make("td", {}, button));
      }
      return line;
    });
    const head = make("tr", {}, make("th"), make("th", {}, "least"), make("th", {}, "greatest"));
    return make("table", { className: "ranges" }, head, ...lines);
  }

  private show(): void {
    const { sweep, pointing } = this;
    const { row } = pointing;
    if (row === null) {
      const hint = make("p", { className: "quiet" }, "Point at a take in any part of the page; click to keep it.");
      this.place.replaceChildren(make("h2", {}, "All takes"), this.ranges(), hint);
      return;
    }
    const shape = sweep.shape(row);
    const state = sweep.stateOf(row);
    const title = make("h2", {}, `Take ${sweep.takes[row]}`);
    if (state !== "done") title.append(make("span", { className: `state ${state}` }, state));
    else if (shape) title.append(make("span", { className: "quiet" }, `frame ${shape.frame}`));
    const parts: HTMLElement[] = [title, this.canvas];
    if (state === "failed") parts.push(make("p", { className: "error" }, sweep.errorOf(row)));
    if (state === "done" && !shape) {
      const failure = sweep.head.failures.find(({ take }) => take === sweep.takes[row]);
      parts.push(failure ? make("p", { className: "error" }, failure.text) : make("p", { className: "quiet" }, "This take is not among the pictures."));
    }
    if (shape && shape.shown < shape.vertices)
      parts.push(make("p", { className: "quiet" }, `Drawn with ${shape.shown.toLocaleString("en")} of its ${shape.vertices.toLocaleString("en")} vertices.`));
    parts.push(list(sweep.paths.map((path) => [path.title, textOf(path, row), ""])));
    if (state === "done") {
      parts.push(list(sweep.measures.map((measure) => [measure.name, measureText(measure, row), `${measure.about} [${measure.unit}]`])));
    }
    const icon = makeSvg("svg", { "aria-hidden": "true" }, makeSvg("use", { href: "#icon-copy" }));
    const copy = make("button", { type: "button", className: "copy", title: "Copy the command (C)" }, icon, make("span", {}, "Copy"));
    copy.addEventListener("click", () => void this.copy());
    parts.push(make("div", { className: "command" }, make("code", {}, commandOf(sweep, row)), copy));
    this.place.replaceChildren(...parts);
    this.draw();
  }
}

/** The rows with the least and the greatest number; null: there is none. */
function endsOf(values: Float64Array): [number, number] | null {
  let [least, greatest] = [-1, -1];
  values.forEach((value, row) => {
    if (Number.isNaN(value)) return;
    if (least < 0 || value < values[least]) least = row;
    if (greatest < 0 || value > values[greatest]) greatest = row;
  });
  return least < 0 ? null : [least, greatest];
}

function list(lines: [string, string, string][]): HTMLElement {
  return make("dl", {}, ...lines.flatMap(([name, value, about]) => [make("dt", { title: about || name }, name), make("dd", {}, value)]));
}

/** A page that was opened from a file may have no clipboard; then the text is selected. */
async function copied(text: string, shown: HTMLElement | null): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    if (shown) getSelection()?.selectAllChildren(shown);
    return false;
  }
}
