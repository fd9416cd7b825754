// Floating menus: of a button, of a right click, of Shift-F10, and of a long press.

import { make } from "../element";

export interface MenuItem {
  label: string;
  act: () => void;
  isDisabled?: boolean;
  /** The key that does the same. */
  keys?: string;
}

/** A text stands above the items that follow it. */
export type MenuEntry = MenuItem | string;

/** Below this box, or where there is room. */
export type MenuPlace = Pick<DOMRect, "left" | "top" | "bottom">;

const margin = 4;
const longPress = 500; // ms
/** A finger that has moved farther does something else. [px] */
const farthestPress = 3;
let close: (() => void) | null = null;

/** Opens a menu, and closes the one that is open. Escape gives the focus back to what had it. */
export function openMenu(name: string, entries: MenuEntry[], place: MenuPlace, closed = () => {}): void {
  close?.();
  const before = document.activeElement;
  const menu = make("div", { className: "menu", role: "menu", ariaLabel: name, tabIndex: -1 });
  const end = (givesBack: boolean) => {
    if (close !== drop) return;
    close = null;
    document.removeEventListener("pointerdown", onPress, true);
    removeEventListener("resize", drop);
    if (givesBack && before instanceof HTMLElement && before.isConnected) before.focus();
    menu.remove();
    closed();
  };
  const drop = () => end(false);
  const onPress = (event: Event) => {
    if (!menu.contains(event.target as Node)) drop();
  };
  const choose = ({ act, isDisabled }: MenuItem) => {
    if (isDisabled) return;
    end(true);
    act();
  };
  menu.append(...entries.map((entry) => (typeof entry === "string" ? make("p", { role: "presentation" }, entry) : itemOf(entry, choose))));
  menu.addEventListener("keydown", (event) => onKey(event, menu, end));
  menu.addEventListener("contextmenu", (event) => event.preventDefault());
  menu.addEventListener("focusout", ({ relatedTarget }) => {
    if (relatedTarget && !menu.contains(relatedTarget as Node)) drop();
  });
  document.addEventListener("pointerdown", onPress, true);
  addEventListener("resize", drop);
  close = drop;
  document.body.append(menu);
  put(menu, place);
  (itemsOf(menu)[0] ?? menu).focus({ preventScroll: true });
}

function itemOf(item: MenuItem, choose: (item: MenuItem) => void): HTMLElement {
  const button = make("button", { type: "button", role: "menuitem", tabIndex: -1, ariaLabel: item.label }, make("span", {}, item.label));
  if (item.keys) button.append(make("kbd", {}, item.keys));
  if (item.isDisabled) button.setAttribute("aria-disabled", "true");
  button.addEventListener("click", () => choose(item));
  button.addEventListener("pointermove", () => button.focus({ preventScroll: true }));
  return button;
}

const itemsOf = (menu: HTMLElement) => [...menu.querySelectorAll<HTMLElement>("[role=menuitem]")];

function put(menu: HTMLElement, { left, top, bottom }: MenuPlace): void {
  const { offsetWidth: width, offsetHeight: height } = menu;
  const fitsBelow = bottom + height + margin <= innerHeight;
  const y = fitsBelow ? bottom : top - height >= margin ? top - height : innerHeight - height - margin;
  menu.style.left = `${Math.max(Math.min(left, innerWidth - width - margin), margin)}px`;
  menu.style.top = `${Math.max(y, margin)}px`;
}

function onKey(event: KeyboardEvent, menu: HTMLElement, end: (givesBack: boolean) => void): void {
  event.stopPropagation();
  const items = itemsOf(menu);
  const here = items.indexOf(document.activeElement as HTMLElement);
  const letter = event.key.length === 1 && event.key !== " " ? event.key.toLowerCase() : "";
  const to = (k: number) => items[(k + items.length) % items.length]?.focus();
  if (event.key === "Escape" || event.key === "Tab") end(true);
  else if (event.key === "ArrowDown") to(here + 1);
  else if (event.key === "ArrowUp") to(here < 0 ? -1 : here - 1);
  else if (event.key === "Home") to(0);
  else if (event.key === "End") to(-1);
  else if (letter) [...items.slice(here + 1), ...items.slice(0, here + 1)].find((each) => each.textContent!.toLowerCase().startsWith(letter))?.focus();
  else return; // Enter and Space press the item
  event.preventDefault();
}

/** Calls `open` if somebody asks for the menu of `target`, which is in `element`. */
export function onContextMenu(element: HTMLElement, open: (target: HTMLElement, place: MenuPlace) => void): void {
  let timer = 0;
  let start: PointerEvent | null = null;
  let isOpenByPress = false;
  const at = ({ clientX, clientY }: MouseEvent) => ({ left: clientX, top: clientY, bottom: clientY });
  const giveUp = () => clearTimeout(timer);
  element.addEventListener("contextmenu", (event) => {
    event.preventDefault();
    giveUp();
    if (!isOpenByPress) open(event.target as HTMLElement, at(event));
  });
  element.addEventListener("keydown", (event) => {
    if (event.key !== "ContextMenu" && !(event.key === "F10" && event.shiftKey)) return;
    event.preventDefault();
    event.stopPropagation();
    const target = event.target as HTMLElement;
    open(target, target.getBoundingClientRect());
  });
  element.addEventListener("pointerdown", (event) => {
    giveUp();
    isOpenByPress = false;
    if (event.pointerType !== "touch" || !event.isPrimary) return;
    start = event;
    timer = window.setTimeout(() => {
      isOpenByPress = true;
      open(event.target as HTMLElement, at(event));
    }, longPress);
  });
  element.addEventListener("pointermove", ({ clientX, clientY }) => {
    if (start && Math.hypot(clientX - start.clientX, clientY - start.clientY) >= farthestPress) giveUp();
  });
  for (const name of ["pointerup", "pointercancel"]) element.addEventListener(name, giveUp);
  // Otherwise the finger that leaves presses what was below it, too.
  element.addEventListener("touchend", (event) => isOpenByPress && event.cancelable && event.preventDefault(), { passive: false });
}
