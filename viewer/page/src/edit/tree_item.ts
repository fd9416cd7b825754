// An object in the tree Objects.

import { make, makeSvg } from "../element";
import { setAttribute } from "./arrange";
import { editName } from "./name_field";
import type { SceneObject } from "./session";

export class TreeItem {
  readonly element = make("div", { role: "treeitem", tabIndex: -1 });
  readonly group = make("div", { role: "group" });
  private readonly icon = makeSvg("use");
  private readonly row = make("div", { className: "item" });
  private readonly name = make("span", { className: "name" });
  private readonly kind = make("span", { className: "quiet" });

  constructor() {
    const twisty = make("i", { className: "twisty" });
    this.row.append(twisty, makeSvg("svg", { "aria-hidden": "true" }, this.icon), this.name, this.kind);
    this.element.append(this.row);
  }

  update(object: SceneObject, icon: string, isSelected: boolean, isOpen: boolean | null, warnings: string[]): void {
    const { name, kind, shape, file } = object;
    this.element.dataset.name = name;
    setAttribute(this.element, "aria-label", name);
    setAttribute(this.element, "aria-selected", String(isSelected));
    setAttribute(this.element, "aria-expanded", isOpen === null ? null : String(isOpen));
    setAttribute(this.element, "aria-description", [shape ?? kind, file && `in ${file}`, ...warnings].filter(Boolean).join(", "));
    setAttribute(this.icon, "href", `#icon-${icon}`);
    const remarks = [...(file ? [`It stands in ${file}, and is read-only here`] : []), ...warnings];
    setAttribute(this.row, "title", remarks.length > 0 ? remarks.join("\n") : null);
    this.row.classList.toggle("warns", warnings.length > 0);
    this.row.classList.toggle("off", object.attributes.some((each) => each.name === "enabled" && each.value === "false"));
    if (this.name.textContent !== name) this.name.textContent = name;
    const text = file ?? shape ?? kind;
    if (this.kind.textContent !== text) this.kind.textContent = text;
    this.group.hidden = isOpen === false;
    if (isOpen !== null && !this.group.isConnected) this.element.append(this.group);
    if (isOpen === null) this.group.remove();
  }

  /** Puts a field in the place of the name. `done` gets the new name, or null. */
  edit(done: (name: string | null) => void): void {
    editName(this.element.dataset.name!, this.name, this.element, done);
  }
}
