// Keys that act on the document, wherever the focus is but in fields; the viewer's are in page.ts, their list in keys.html.

import { Clipboard } from "./clipboard";
import type { CurveKeys } from "./curve_keys";
import type { Editor } from "./editor";
import type { Operation } from "./session";
import type { TimelineKeys } from "./timeline_keys";

export function mountShortcuts(editor: Editor, curves: CurveKeys, keys: TimelineKeys): void {
  const clipboard = new Clipboard(editor, curves, keys);
  const { session, selection } = editor;
  const shortcuts: Record<string, () => unknown> = {
    "Control+z": session.undo,
    "Control+Shift+z": session.redo,
    "Control+y": session.redo,
    "Control+s": () => editor.save(),
    "Control+c": () => clipboard.copy(),
    "Control+x": () => clipboard.cut(),
    "Control+v": () => clipboard.paste(),
    "Control+a": () => (curves.hasFocus ? curves.chooseAll() : selection.set(session.objects.slice(1).map(({ name }) => name))),
    r: () => (editor.recorder.isOn = !editor.recorder.isOn),
    i: () => editor.apply(keysHere(editor)),
    Delete: () => (curves.isMeant ? curves.delete() : keys.isMeant ? keys.delete() : selection.names.length > 0 && editor.apply([{ op: "delete", objects: [...selection.names] }])),
  };
  document.addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    const hasControl = event.ctrlKey || event.metaKey;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    // Fields of text need the keys with Ctrl for themselves, but for what those of numbers leave of undo; others the rest.
    const isOfDocument = key === "s" || (["z", "y"].includes(key) && target.closest("#properties, #key-tools, #record-bar") !== null);
    const isField = hasControl ? target.matches("input:is([type=text], [type=number]), textarea") && !isOfDocument : target.matches("input:not([type=checkbox]), select, textarea");
    if (event.defaultPrevented || event.altKey || isField || document.querySelector("dialog[open]")) return;
    const shortcut = shortcuts[`${hasControl ? "Control+" : ""}${hasControl && event.shiftKey ? "Shift+" : ""}${key}`];
    if (event.key === "c" && !getSelection()?.isCollapsed) return; // the text that is marked
    if (!shortcut || session.facts?.text == null) return;
    event.preventDefault();
    if (session.isAlive) void shortcut();
  });
}

/** A key at the frame shown for each channel of what is selected: those that the file gives, or if it gives none, all. */
function keysHere({ selection, playback }: Editor): Operation[] {
  const objects = selection.names.length > 0 ? selection.objects : [];
  return objects.flatMap(({ attributes }) => {
    const channels = attributes.filter(({ components, excluded }) => components > 0 && !excluded);
    const given = channels.filter((each) => each.given || each.animated);
    return (given.length > 0 ? given : channels).map(({ path }) => ({ op: "setKey", channel: path, frame: playback.frame }));
  });
}
