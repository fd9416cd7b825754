// Names that are changed where they stand.

import { make } from "../element";

/** Puts a field in the place of `shown`, a name. `holder` has the focus before and after; `done` gets the new name, or null. */
export function editName(old: string, shown: HTMLElement, holder: HTMLElement, done: (name: string | null) => void): void {
  const input = make("input", { type: "text", className: "rename", value: old, ariaLabel: `New name of ${old}`, spellcheck: false });
  let isOver = false;
  const end = (name: string | null) => {
    if (isOver) return;
    isOver = true; // the blur of the field comes here, too
    const hasFocus = document.activeElement === input;
    shown.hidden = false;
    if (hasFocus) holder.focus();
    input.remove();
    done(name === old ? null : name);
  };
  input.addEventListener("keydown", (event) => {
    event.stopPropagation();
    if (event.key !== "Enter" && event.key !== "Escape") return;
    event.preventDefault(); // else the holder is pressed
    end(event.key === "Enter" ? input.value.trim() : null);
  });
  input.addEventListener("blur", () => document.activeElement !== input && end(input.value.trim()));
  for (const name of ["click", "dblclick", "pointerdown"]) input.addEventListener(name, (event) => event.stopPropagation());
  shown.hidden = true;
  shown.after(input);
  input.focus();
  input.select();
}
