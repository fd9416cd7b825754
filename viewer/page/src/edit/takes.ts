// The list Takes: texts of the scene that somebody kept, to open again, and to draw behind the present one.

import { element, make, makeSvg } from "../element";
import { button } from "../page";
import type { ThemeChoice } from "../theme";
import { arrange, setAttribute } from "./arrange";
import type { Editor } from "./editor";
import { Ghosts } from "./ghosts";
import { onContextMenu, openMenu, type MenuPlace } from "./menu";
import { editName } from "./name_field";
import { Problem } from "./problem";

interface TakeFacts {
  id: number;
  name: string;
  hasPicture: boolean;
}

/** The answer to `takes`, and its event. */
export interface TakesFacts {
  takes: TakeFacts[];
  /** How often files that scenes name have been read again. */
  readAgain: number;
}

/** Of a picture. [px] */
const [width, height] = [240, 150];

interface Item {
  facts: TakeFacts;
  row: HTMLLIElement;
  open: HTMLButtonElement;
  ghost: HTMLButtonElement;
  name: HTMLElement;
}

export class Takes {
  readonly ghosts: Ghosts;
  private readonly list = element<HTMLElement>("takes");
  private readonly problem: Problem;
  private readonly items = new Map<number, Item>();
  private readAgain = 0;

  constructor(
    private readonly editor: Editor,
    themes: ThemeChoice,
  ) {
    this.problem = new Problem(element("takes-problem"), editor.session);
    this.ghosts = new Ghosts(editor, themes, (message) => this.problem.show(message));
    this.ghosts.onChange(() => this.showGhosts());
    themes.onChange(() => this.showGhosts());
    button("keep-take", () => void this.keep());
    onContextMenu(this.list, (target, place) => {
      const item = this.itemAt(target);
      if (item) this.openMenu(item, place);
    });
    this.list.addEventListener("keydown", (event) => this.onKey(event));
  }

  /** The command tells what there is. */
  take({ takes, readAgain }: TakesFacts): void {
    const held = [...this.items.values()].findIndex(({ row }) => row.contains(document.activeElement));
    const items = takes.map((facts) => this.itemOf(facts));
    for (const id of [...this.items.keys()]) if (!takes.some((each) => each.id === id)) this.items.delete(id);
    arrange(
      this.list,
      items.map(({ row }) => row),
    );
    element<HTMLElement>("takes-section").hidden = takes.length === 0;
    // The focus goes to what stands where the deleted one stood.
    if (held >= 0 && !this.list.contains(document.activeElement)) (items[Math.min(held, items.length - 1)]?.open ?? element<HTMLElement>("keep-take")).focus();
    this.ghosts.retain([...this.items.keys()], readAgain !== this.readAgain);
    this.readAgain = readAgain;
  }

  private itemOf(facts: TakeFacts): Item {
    const item = this.items.get(facts.id) ?? this.newItem(facts);
    this.items.set(facts.id, item);
    item.facts = facts;
    if (item.name.textContent !== facts.name) item.name.textContent = item.row.title = facts.name;
    return item;
  }

  private newItem(facts: TakeFacts): Item {
    const { id } = facts;
    const picture = make("img", { alt: "", width, height });
    const name = make("span", { className: "name" });
    const open = make("button", { type: "button", className: "take" }, make("span", { className: "picture" }, picture), name);
    const ghost = make("button", { type: "button", className: "ghost", ariaPressed: "false", title: "Draw it behind the scene" }, makeSvg("svg", { "aria-hidden": "true" }, makeSvg("use", { href: "#icon-ghost" })), make("span", {}, "Ghost"));
    open.addEventListener("click", () => void this.post({ id }));
    ghost.addEventListener("click", () => (this.ghosts.has(id) ? this.ghosts.drop(id) : this.ghosts.add(id)));
    if (facts.hasPicture) void this.read(picture, id);
    return { facts, row: make("li", {}, open, ghost), open, ghost, name };
  }

  private async read(picture: HTMLImageElement, id: number): Promise<void> {
    picture.addEventListener("load", () => {
      URL.revokeObjectURL(picture.src);
      picture.classList.add("shown");
    });
    const bytes = await this.editor.session.requests.bytes(`picture?take=${id}`).catch(() => null); // it is deleted by now
    if (bytes) picture.src = URL.createObjectURL(new Blob([bytes], { type: "image/png" }));
  }

  private showGhosts(): void {
    const { colours } = this.ghosts;
    for (const [id, { ghost }] of this.items) {
      setAttribute(ghost, "aria-pressed", String(colours.has(id)));
      ghost.style.setProperty("--ghost", colours.get(id) ?? "");
    }
  }

  private itemAt(target: EventTarget | null): Item | undefined {
    return [...this.items.values()].find(({ row }) => target instanceof Node && row.contains(target));
  }

  private onKey(event: KeyboardEvent): void {
    const item = this.itemAt(event.target);
    if (!item || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "F2") this.rename(item);
    else if (event.key === "Delete") this.delete(item);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  private openMenu(item: Item, place: MenuPlace): void {
    const entries = [
      { label: "Rename", keys: "F2", act: () => this.rename(item) },
      { label: "Save as…", act: () => this.save(item) },
      { label: "Delete", keys: "Del", act: () => this.delete(item) },
    ];
    openMenu(item.facts.name, entries, place);
  }

  private async keep(): Promise<void> {
    const { session } = this.editor;
    try {
      await session.post("keep", { picture: this.picture() });
      this.editor.say("");
    } catch (error) {
      this.editor.say((error as Error).message);
    }
  }

  // As base 64.
  private picture(): string {
    const { stage } = this.editor.viewer;
    const small = make("canvas", { width, height });
    const context = small.getContext("2d")!;
    context.imageSmoothingQuality = "high";
    this.ghosts.group.visible = false;
    stage.draw(); // what a canvas of WebGL has is gone later
    const scale = Math.max(width / stage.canvas.width, height / stage.canvas.height);
    const [w, h] = [scale * stage.canvas.width, scale * stage.canvas.height];
    context.drawImage(stage.canvas, (width - w) / 2, (height - h) / 2, w, h);
    this.ghosts.group.visible = true;
    stage.invalidate();
    return small.toDataURL("image/png").split(",")[1];
  }

  private post(body: { id: number } & Record<string, unknown>): Promise<boolean> {
    return this.problem.attempt(() => this.editor.session.post("take", body));
  }

  private rename({ facts: { id, name }, open }: Item): void {
    if (!open.hidden) editName(name, open, open, (wanted) => wanted !== null && void this.post({ id, name: wanted }));
  }

  private delete({ facts: { id } }: Item): void {
    void this.post({ id, delete: true });
  }

  private save({ facts: { id, name } }: Item): void {
    this.editor.askForFile(`${name}.xml`, (body) => this.editor.session.post("take", { id, ...body }));
  }
}
