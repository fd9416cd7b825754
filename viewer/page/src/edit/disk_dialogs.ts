// What is asked about the file of the document: its name, what to do if it has changed on the disk, or was not saved.

import { element } from "../element";
import { Dialog } from "./dialog";
import type { Editor } from "./editor";
import { Refusal } from "./requests";

/** Saves something to a file. */
export type SavePost = (body: { file: string; overwrite?: boolean }) => Promise<unknown>;

export class DiskDialogs {
  private readonly saveAs = new Dialog("save-as");
  private readonly fileChanged = new Dialog("file-changed");
  private readonly unsaved = new Dialog("unsaved");
  private readonly file = this.saveAs.control<HTMLInputElement>("file");
  private readonly overwrite = this.saveAs.control<HTMLButtonElement>("overwrite");
  /** Whether the document is to take the place of the file on the disk. */
  private isMineKept = false;
  private post!: SavePost;

  constructor(private readonly editor: Editor) {
    const { session } = editor;
    const keep = () => {
      this.isMineKept = true;
      this.fileChanged.close();
    };
    this.saveAs.onSubmit(() => this.saveTo(false));
    this.saveAs.onPress("overwrite", () => this.saveTo(true));
    this.file.addEventListener("input", () => this.ask(""));
    this.fileChanged.onPress("load", async () => {
      if (await this.fileChanged.try(() => session.post("load"))) this.fileChanged.close();
    });
    this.fileChanged.onPress("keep", keep);
    this.fileChanged.onPress("save-as", () => {
      this.fileChanged.close();
      this.openSaveAs();
    });
    this.saveAs.element.addEventListener("close", () => this.update());
    this.fileChanged.element.addEventListener("cancel", keep);
    for (const answer of ["restore", "discard"]) {
      this.unsaved.onPress(answer, async () => {
        if (await this.unsaved.try(() => session.post(answer))) this.unsaved.close();
      });
    }
    this.unsaved.element.addEventListener("cancel", (event) => event.preventDefault()); // it needs an answer
    session.onChange(() => this.update());
  }

  openSaveAs(message = ""): void {
    const { session } = this.editor;
    this.askForFile(session.facts.file || "scene.xml", (body) => session.post("save", body), message);
  }

  /** Asks for the file of what `post` saves. */
  askForFile(file: string, post: SavePost, message = ""): void {
    this.post = post;
    this.file.value = file;
    this.ask("");
    this.saveAs.open(message);
    this.file.setSelectionRange(0, this.file.value.replace(/\.xml$/, "").length);
  }

  async save(): Promise<void> {
    const { editor } = this;
    const { session } = editor;
    if (session.facts.file === "") return this.openSaveAs();
    try {
      await session.post("save", this.isMineKept ? { overwrite: true } : {});
      editor.say("");
    } catch (error) {
      const { message } = error as Error;
      if (!(error instanceof Refusal) || error.status !== 409) return editor.say(message);
      await session.read();
      if (session.facts.changedOnDisk) this.openFileChanged();
      else this.openSaveAs(message);
    }
  }

  /** The file changed again: what was said of it before is void. */
  forget(): void {
    this.isMineKept = false;
  }

  private update(): void {
    const { facts, isAlive } = this.editor.session;
    if (!facts.changedOnDisk) this.isMineKept = false;
    if (isAlive && facts.journal) this.openUnsaved(facts.journal.time);
    else this.unsaved.close();
    const isAsked = this.isMineKept || this.saveAs.isOpen;
    if (isAlive && !facts.journal && facts.changedOnDisk && !facts.saved && !isAsked) this.openFileChanged();
    else if (!facts.changedOnDisk || !isAlive) this.fileChanged.close();
    if (!isAlive) this.saveAs.close();
  }

  private openFileChanged(): void {
    if (this.fileChanged.isOpen) return;
    element("file-changed-text").textContent = `Something else wrote ${this.editor.session.facts.file} while it had changes here that are not saved. Load takes what is on the disk, which Undo takes back. If you keep yours, the next Save overwrites the file.`;
    this.fileChanged.open();
  }

  private openUnsaved(time: string): void {
    if (this.unsaved.isOpen) return;
    const { facts } = this.editor.session;
    const then = new Date(time);
    const when = Number.isNaN(then.getTime()) ? time : then.toLocaleString("en", { dateStyle: "medium", timeStyle: "short" });
    element("unsaved-text").textContent = `The last time that ${facts.file || "a new scene"} was edited, the command ended before all changes were saved; the last is of ${when}.`;
    this.unsaved.open();
  }

  private async saveTo(isOver: boolean): Promise<void> {
    const { session } = this.editor;
    const file = this.file.value.trim();
    if (file === "") return this.saveAs.say("A file needs a name");
    let exists = false;
    const isSaved = await this.saveAs.try(() =>
      this.post({ file, ...(isOver ? { overwrite: true } : {}) }).catch((error: unknown) => {
        exists = error instanceof Refusal && error.status === 409;
        throw error;
      }),
    );
    if (isSaved) {
      await session.read().catch(() => {}); // else it asks what is to be done with the file that it was
      return this.saveAs.close();
    }
    this.overwrite.hidden = !exists;
    (exists ? this.overwrite : this.file).focus();
  }

  private ask(message: string): void {
    this.overwrite.hidden = true;
    this.saveAs.say(message);
  }
}
