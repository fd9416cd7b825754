/** The element of the page with that id. */
export function element<T extends Element>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no ${id}`);
  return found as unknown as T;
}

/** A new element with these properties and this content. */
export function make<K extends keyof HTMLElementTagNameMap>(name: K, properties: Partial<HTMLElementTagNameMap[K]> = {}, ...content: (Node | string)[]): HTMLElementTagNameMap[K] {
  const made = Object.assign(document.createElement(name), properties);
  // These are properties in newer browsers only.
  for (const [key, value] of Object.entries(properties)) {
    if (key === "role" || key.startsWith("aria")) made.setAttribute(key.replace("aria", "aria-").toLowerCase(), String(value));
  }
  made.append(...content);
  return made;
}

export function makeSvg<K extends keyof SVGElementTagNameMap>(name: K, attributes: Record<string, string | number> = {}, ...content: Node[]): SVGElementTagNameMap[K] {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  made.append(...content);
  return made;
}
