// The command's messages about the scene: errors, warnings, notes, each with its line.

import type { Message } from "./bake";
import { make } from "./element";

const shown = new WeakMap<HTMLElement, string>();

/** What is shown already stays, also what was dismissed. */
export function showMessages(place: HTMLElement, messages: Message[]): void {
  const text = JSON.stringify(messages);
  if (shown.get(place) === text) return;
  shown.set(place, text);
  place.replaceChildren(
    ...messages.map(({ kind, line, text, file }) => {
      const where = [kind, file, line > 0 ? `line ${line}` : ""].filter(Boolean).join(", ");
      const item = make("p", { className: `message ${kind}` }, make("b", {}, where), make("span", {}, text));
      if (kind !== "error") item.append(closeButton(item));
      return item;
    }),
  );
}

function closeButton(item: HTMLElement): HTMLButtonElement {
  const close = make("button", { type: "button", ariaLabel: "Dismiss" }, "×");
  close.addEventListener("click", () => item.remove());
  return close;
}
