// The document in the bar: its steps, its file, and one line that tells how it stands.

import { element, make } from "../element";
import { button } from "../page";
import { DiskDialogs } from "./disk_dialogs";
import type { Editor } from "./editor";
import type { DocumentFacts } from "./session";

const ended = "The command has ended: this page is read-only";
let disk: DiskDialogs | undefined;

/** The file changed on the disk, or is what it was. */
export function noticeDisk(editor: Editor): void {
  disk?.forget();
  editor.session.read().catch(() => {}); // the page tells if the command has ended
}

export function mountDocumentBar(editor: Editor): void {
  const { session, scene } = editor;
  disk = new DiskDialogs(editor);
  editor.save = () => {
    if (session.isAlive && session.facts.text !== null) void disk?.save();
  };
  editor.askForFile = (file, post) => disk?.askForFile(file, post);
  button("undo", () => session.isAlive && void session.undo());
  button("redo", () => session.isAlive && void session.redo());
  button("save", () => editor.save());
  button("auto-key", () => (editor.hasAutoKey = !editor.hasAutoKey));
  editor.onChange(() => element("auto-key").setAttribute("aria-pressed", String(editor.hasAutoKey)));
  mountSides();
  mountMore();
  mountAlert(editor);

  let pending = 0;
  const update = () => {
    pending = 0;
    showState(editor);
  };
  // Frames come faster than anybody reads.
  const updateSoon = () => (pending ||= window.setTimeout(update, 100));
  session.onChange(() => {
    showDocument(editor);
    updateSoon();
    if (!session.isAlive) editor.say(ended);
  });
  session.onNewer(updateSoon);
  scene.onProgress(updateSoon);
  editor.recorder.onChange(updateSoon);
  scene.onChange((isNew) => {
    if (isNew) showDocument(editor); // the viewer has written its own title
    updateSoon();
  });
  addEventListener("beforeunload", (event) => {
    if (session.isAlive && session.facts && session.facts.text !== null && !session.facts.saved) event.preventDefault();
  });
}

export const nameOf = ({ file, text }: DocumentFacts) => file.split("/").pop() || (text === null ? "pliant" : "new scene");

function showDocument({ session: { facts, isAlive } }: Editor): void {
  if (!facts) return;
  const isThere = facts.text !== null;
  showStep("undo", "Undo", "Ctrl-Z", facts.undo, isAlive);
  showStep("redo", "Redo", "Ctrl-Shift-Z", facts.redo, isAlive);
  for (const id of ["new", "save", "export", "auto-key", "record", "keep-take"]) element<HTMLButtonElement>(id).disabled = !isThere || !isAlive;
  element<HTMLButtonElement>("text-toggle").disabled = !isThere;
  const name = nameOf(facts);
  element("scene-name").textContent = name;
  document.title = `${isThere && !facts.saved ? "* " : ""}${name}${isThere ? " – pliant" : ""}`;
  const root = document.documentElement;
  root.classList.toggle("ended", !isAlive);
  for (const each of document.querySelectorAll<HTMLElement>(".side > *, #handles, #record-bar, .timeline-keys, .curve-keys, .key-tools, #first")) each.inert = !isAlive;
}

function showStep(id: string, word: string, keys: string, step: string, isAlive: boolean): void {
  const control = element<HTMLElement>(id);
  // Whoever presses it again and again stays there at the end.
  control.setAttribute("aria-disabled", String(step === "" || !isAlive));
  control.setAttribute("aria-description", step);
  control.title = `${word}${step === "" ? "" : ` ${step}`} (${keys})`;
}

function showState(editor: Editor): void {
  const { text, kind } = stateOf(editor);
  const state = element<HTMLElement>("state");
  if (state.textContent !== text) state.textContent = state.title = text;
  state.dataset.kind = kind;
}

function stateOf({ session, scene, recorder }: Editor): { text: string; kind: string } {
  const { facts, failures } = session;
  if (!session.isAlive) return { text: ended, kind: "error" };
  if (!facts || facts.text === null) return { text: "", kind: "" };
  const file = [facts.saved ? "saved" : "changed", ...(facts.changedOnDisk ? ["the file changed on the disk"] : []), ...(facts.journalFault ? [`no journal: ${facts.journalFault}`] : [])];
  if (failures.length > 0) return { text: [failures[0], ...file].join(" · "), kind: "error" };
  if (!scene.head) return { text: file.join(" · "), kind: "" };
  const ready = scene.readyRevision === session.revision ? scene.ready.reduce((sum, [first, last]) => sum + last - first + 1, 0) : 0;
  const warnings = scene.head.messages.filter(({ kind }) => kind === "warning").length;
  const words = [`${ready} of ${scene.frameCount} frames`, ...file];
  if (recorder.frames && recorder.isRunning) words.unshift(`recording ${recorder.paths} · frame ${recorder.frames[1]}`);
  if (!scene.shown.isExact) words.push("preview");
  if (warnings > 0) words.push(warnings === 1 ? "1 warning" : `${warnings} warnings`);
  return { text: words.join(" · "), kind: warnings > 0 ? "warning" : "" };
}

// Refusals stand over the view, where nothing moves for them.
function mountAlert(editor: Editor): void {
  const text = make("span");
  const close = make("button", { type: "button", ariaLabel: "Dismiss" }, "×");
  const alert = make("p", { className: "alert", role: "alert" }, text);
  document.querySelector(".stage")!.append(alert);
  editor.say = (message) => {
    if (text.textContent === message) return;
    text.textContent = message;
    if (message === "") close.remove();
    else alert.append(close);
  };
  close.addEventListener("click", () => editor.say(""));
  editor.session.onNewer(() => editor.say(""));
}

// In a narrow window the panels are over the stage, one at a time.
function mountSides(): void {
  const sides = ["objects", "properties"].map((name) => ({ panel: element<HTMLElement>(name === "objects" ? name : "properties-side"), toggle: element<HTMLElement>(`${name}-toggle`) }));
  const show = (shown: (typeof sides)[number] | null) => {
    for (const side of sides) {
      side.panel.classList.toggle("open", side === shown);
      side.toggle.setAttribute("aria-expanded", String(side === shown));
    }
  };
  for (const side of sides) {
    side.toggle.addEventListener("click", () => show(side.panel.classList.contains("open") ? null : side));
    side.panel.addEventListener("keydown", (event) => {
      if (event.key !== "Escape" || event.defaultPrevented || !side.panel.classList.contains("open")) return;
      show(null);
      side.toggle.focus();
    });
  }
}

// In a narrower one the buttons that are used less are in a menu of their own.
function mountMore(): void {
  const [menu, toggle, bar] = [element<HTMLElement>("more"), element("more-toggle"), document.querySelector(".bar")!];
  const ofDocument = ["new", "export", "auto-key", "record", "keep-take", "text-toggle"].map((id) => element(id));
  const ofViewer = ["frame-all", "curves-toggle", "display-toggle", "theme", "help-toggle"].map((id) => element(id));
  const isSmall = matchMedia("(width < 720px)");
  const place = () => {
    if (menu.matches(":popover-open")) menu.hidePopover();
    if (isSmall.matches) {
      menu.append(...ofDocument, ...ofViewer);
    } else {
      element("document-buttons").append(...ofDocument);
      bar.append(...ofViewer);
    }
  };
  isSmall.addEventListener("change", place);
  place();
  menu.addEventListener("beforetoggle", () => (menu.style.top = `${toggle.getBoundingClientRect().bottom + 4}px`));
  menu.addEventListener("toggle", (event) => toggle.setAttribute("aria-expanded", String((event as ToggleEvent).newState === "open")));
  menu.addEventListener("click", () => menu.hidePopover(), { capture: true }); // before a dialog opens, to which it gives the focus back
}
