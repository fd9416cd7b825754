// Asks for a mesh of the scene's folder, and if it has several objects, for one of them.

import { element, make } from "../element";
import { Dialog } from "./dialog";
import type { Session } from "./session";
import { readStarters } from "./starters";

export interface Mesh {
  file: string;
  object?: string;
}

let dialog: Dialog | undefined;

/** Asks until `take` takes one; `done` gets what it made of it when the dialog is closed. */
export async function askForMesh<T>(session: Session, title: string, take: (mesh: Mesh) => Promise<T>, done: (made: T) => void = () => {}): Promise<void> {
  const { meshes } = await readStarters(session);
  const asked = (dialog ??= newDialog(session));
  const items = meshes.map((file) => {
    const choice = make("button", { type: "button" }, file);
    choice.addEventListener("click", async () => {
      const object = asked.control<HTMLInputElement>("object").value.trim();
      let made!: T;
      if (!(await asked.try(async () => (made = await take({ file, ...(object === "" ? {} : { object }) }))))) return;
      asked.close();
      done(made);
    });
    return make("li", {}, choice);
  });
  element("meshes").replaceChildren(...(items.length > 0 ? items : [make("li", { className: "quiet" }, "There is no mesh in this folder or below it: .obj, .ply, .gltf, .glb, .fbx or .dae")]));
  element("mesh-title").textContent = title;
  asked.open();
}

export function closeMeshDialog(): void {
  dialog?.close();
}

function newDialog(session: Session): Dialog {
  const made = new Dialog("mesh-dialog");
  made.onSubmit(() => {});
  session.onChange(() => session.isAlive || made.close());
  return made;
}
