// The command's messages about the scene: errors, warnings, notes, each with its line.

import type { Message } from "./bake";

export function showMessages(place: HTMLElement, messages: Message[]): void {
  place.replaceChildren(
    ...messages.map(({ kind, line, text, file }) => {
      const item = document.createElement("p");
      item.className = `message ${kind}`;
      const where = [file, line > 0 ? `line ${line}` : ""].filter(Boolean).join(", ");
      const head = document.createElement("b");
      head.textContent = where === "" ? kind : `${kind}, ${where}`;
      const body = document.createElement("span");
      body.textContent = text;
      item.append(head, body);
      if (kind !== "error") item.append(closeButton(item));
      return item;
    }),
  );
}

function closeButton(item: HTMLElement): HTMLButtonElement {
  const close = document.createElement("button");
  close.type = "button";
  close.textContent = "×";
  close.setAttribute("aria-label", "Dismiss");
  close.addEventListener("click", () => item.remove());
  return close;
}
