// What somebody sees who has no scene yet, or wants another one: starters with pictures, the scenes of the folder, and a mesh
// to begin with.

import { element, make } from "../element";
import { button } from "../page";
import { nameOf } from "./document_bar";
import type { Editor } from "./editor";
import { askForMesh, closeMeshDialog, type Mesh } from "./mesh_dialog";
import { readStarters, type Named, type Starters } from "./starters";

/** The starter whose mesh can be another one. */
const meshStarter = "mesh";

export function mountFirstScreen(editor: Editor): void {
  new FirstScreen(editor);
}

class FirstScreen {
  private readonly screen = element<HTMLElement>("first");
  private readonly material = element<HTMLSelectElement>("first-material");
  private readonly back = element<HTMLButtonElement>("first-back");
  private isRead = false;
  /** There is a scene, and somebody wants another one. */
  private isAsked = false;

  constructor(private readonly editor: Editor) {
    const { session } = editor;
    session.onChange(() => this.update());
    button("new", () => this.ask(true));
    button("first-back", () => this.ask(false));
    button("open-mesh", () => void this.openMesh());
    addEventListener("keydown", (event) => this.onKey(event), true);
  }

  private ask(isAsked: boolean): void {
    this.isAsked = isAsked;
    this.update();
    if (isAsked) this.back.focus();
  }

  // Ahead of the page, whose keys are about what is not shown now.
  private onKey(event: KeyboardEvent): void {
    if (this.screen.hidden || document.querySelector("dialog[open], :popover-open")) return;
    if (event.key === "Escape" && this.isAsked) this.ask(false);
    if (!["t", "?"].includes(event.key.toLowerCase())) event.stopPropagation();
  }

  private update(): void {
    const { facts, isAlive } = this.editor.session;
    if (!facts) return;
    const isThere = facts.text !== null;
    this.isAsked &&= isThere && isAlive;
    const isShown = !isThere || this.isAsked;
    const hadFocus = this.screen.contains(document.activeElement);
    if (!isShown && !this.screen.hidden) closeMeshDialog();
    this.screen.hidden = !isShown;
    document.documentElement.classList.toggle("begins", isShown);
    element<HTMLElement>("first-return").hidden = !this.isAsked;
    element("first-more").classList.toggle("asked", this.isAsked); // a file is opened by a command of its own
    this.back.textContent = `Back to ${nameOf(facts)}`;
    if (!isShown && hadFocus) element<HTMLElement>("view").focus();
    if (!isShown || this.isRead) return;
    this.isRead = true;
    readStarters(this.editor.session).then(
      (starters) => void this.fill(starters),
      (error: Error) => {
        this.isRead = false;
        this.editor.say(error.message);
      },
    );
  }

  private async fill({ starters, materials, scenes }: Starters): Promise<void> {
    this.material.replaceChildren(make("option", { value: "" }, "as the starter has it"), ...materials.map(({ name, summary }) => make("option", { value: name, title: summary }, `${name}: ${summary}`)));
    const cards = starters.map((starter) => this.card(starter));
    element("starters").replaceChildren(...cards.map(({ item }) => item));
    element<HTMLElement>("first-scenes").hidden = scenes.length === 0;
    element("scenes").replaceChildren(...scenes.map((file) => this.fileItem(file, () => this.begin("open", { file }))));
    // One after the other: the command draws them.
    for (const { name, picture } of cards) {
      const bytes = await this.editor.session.requests.bytes(`picture?starter=${encodeURIComponent(name)}`).catch(() => null);
      if (bytes) picture.src = URL.createObjectURL(new Blob([bytes], { type: "image/png" }));
    }
  }

  private card({ name, summary }: Named): { name: string; item: HTMLLIElement; picture: HTMLImageElement } {
    const picture = make("img", { alt: "", width: 480, height: 300 });
    picture.addEventListener("load", () => {
      URL.revokeObjectURL(picture.src);
      picture.classList.add("shown");
    });
    const card = make("button", { type: "button", className: "card" }, make("span", { className: "picture" }, picture), make("b", {}, name), make("span", { className: "quiet" }, summary));
    card.addEventListener("click", () => void this.begin("new", { starter: name, ...this.chosenMaterial() }));
    return { name, item: make("li", {}, card), picture };
  }

  private fileItem(file: string, open: () => void): HTMLLIElement {
    const item = make("button", { type: "button" }, file);
    item.addEventListener("click", open);
    return make("li", {}, item);
  }

  private chosenMaterial(): { material?: string } {
    return this.material.value === "" ? {} : { material: this.material.value };
  }

  private async begin(route: "new" | "open", body: object): Promise<void> {
    this.screen.classList.add("waits");
    try {
      await this.make(route, body);
      this.editor.say("");
    } catch (error) {
      this.editor.say((error as Error).message);
    }
    this.screen.classList.remove("waits");
  }

  private async openMesh(): Promise<void> {
    const begin = ({ file, ...object }: Mesh) => this.make("new", { starter: meshStarter, mesh: file, ...object, ...this.chosenMaterial() });
    await askForMesh(this.editor.session, "Open a mesh", begin).catch((error: Error) => this.editor.say(error.message));
  }

  /** Begins a document, and shows what is most worth changing in it. */
  private async make(route: "new" | "open", body: object): Promise<void> {
    const { session, selection } = this.editor;
    await session.post(route, body);
    this.isAsked = false;
    await session.read();
    const surface = session.objects.find(({ kind }) => kind === "surface");
    if (surface) selection.set([surface.name]);
  }
}
