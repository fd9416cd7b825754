// Everything about the take that is pointed at, and the command that writes it.

import type { ThemeChoice } from "../theme";
import type { Pointing } from "./pointing";
import type { Studio } from "./studio";
import { commandOf, measureText, textOf, type Sweep } from "./sweep";

export class Details {
  private readonly canvas = document.createElement("canvas");

  constructor(
    private readonly place: HTMLElement,
    private readonly sweep: Sweep,
    private readonly studio: Studio,
    private readonly pointing: Pointing,
    themes: ThemeChoice,
  ) {
    this.canvas.className = "picture";
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
    const table = part("table", "", "ranges");
    const head = part("tr", "");
    head.append(part("th", ""), part("th", "least"), part("th", "greatest"));
    table.append(head);
    for (const measure of this.sweep.measures) {
      const ends = endsOf(measure.values);
      const line = part("tr", "");
      const name = part("th", measure.name);
      name.title = `${measure.about} [${measure.unit}]`;
      line.append(name);
      for (const row of ends ?? []) {
        const button = part("button", measureText(measure, row));
        button.type = "button";
        button.title = `take ${this.sweep.takes[row]}`;
        button.addEventListener("click", () => this.pointing.keep(row, this));
        const cell = part("td", "");
        cell.append(button);
        line.append(cell);
      }
      table.append(line);
    }
    return table;
  }

  private show(): void {
    const { sweep, pointing } = this;
    const { row } = pointing;
    if (row === null) {
      const hint = part("p", "Point at a take in any part of the page; click to keep it.", "quiet");
      this.place.replaceChildren(part("h2", "All takes"), this.ranges(), hint);
      return;
    }
    const shape = sweep.shape(row);
    const state = sweep.stateOf(row);
    const title = part("h2", `Take ${sweep.takes[row]}`);
    if (state !== "done") title.append(part("span", state, `state ${state}`));
    else if (shape) title.append(part("span", `frame ${shape.frame}`, "quiet"));
    const parts: HTMLElement[] = [title, this.canvas];
    if (state === "failed") parts.push(part("p", sweep.errorOf(row), "error"));
    if (state === "done" && !shape) {
      const failure = sweep.head.failures.find(({ take }) => take === sweep.takes[row]);
      parts.push(failure ? part("p", failure.text, "error") : part("p", "This take is not among the pictures.", "quiet"));
    }
    if (shape && shape.shown < shape.vertices)
      parts.push(part("p", `Drawn with ${shape.shown.toLocaleString("en")} of its ${shape.vertices.toLocaleString("en")} vertices.`, "quiet"));
    parts.push(list(sweep.paths.map((path) => [path.title, textOf(path, row), ""])));
    if (state === "done") {
      parts.push(list(sweep.measures.map((measure) => [measure.name, measureText(measure, row), `${measure.about} [${measure.unit}]`])));
    }
    const command = part("div", "", "command");
    const copy = document.createElement("button");
    copy.type = "button";
    copy.className = "copy";
    copy.title = "Copy the command (C)";
    const icon = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    const use = document.createElementNS("http://www.w3.org/2000/svg", "use");
    use.setAttribute("href", "#icon-copy");
    icon.setAttribute("aria-hidden", "true");
    icon.append(use);
    copy.append(icon, part("span", "Copy"));
    copy.addEventListener("click", () => void this.copy());
    command.append(part("code", commandOf(sweep, row)), copy);
    parts.push(command);
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

function part<K extends keyof HTMLElementTagNameMap>(name: K, text: string, className = ""): HTMLElementTagNameMap[K] {
  const element = document.createElement(name);
  element.textContent = text;
  element.className = className;
  return element;
}

function list(lines: [string, string, string][]): HTMLElement {
  const all = document.createElement("dl");
  for (const [name, value, about] of lines) {
    const title = part("dt", name);
    title.title = about || name;
    all.append(title, part("dd", value));
  }
  return all;
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
