// The words that the page's address may have after #: `frame=12&colour=velocity&turn=30`.

import type { Colour, Style } from "./surface_view";
import type { Axis } from "./stage";
import type { Theme } from "./theme";

export interface Look {
  frame?: number;
  turn?: number;
  tilt?: number;
  up?: Axis;
  style?: Style;
  colour?: Colour;
  theme?: Theme;
  gizmos?: boolean;
  regions?: boolean;
  boxes?: boolean;
  colliders?: boolean;
  labels?: boolean;
  legend?: boolean;
  caption?: boolean;
  floor?: boolean;
  /** Names of forces, groups and colliders. */
  hide?: string[];
  solo?: string[];
  /** The number at the top of the colours. */
  peak?: number;
}

export function readLook(address: string): Look {
  const words = new URLSearchParams(address.replace(/^#/, ""));
  const number = (name: string) => {
    const value = Number(words.get(name) ?? NaN);
    return Number.isFinite(value) ? value : undefined;
  };
  const one = <T extends string>(name: string, allowed: readonly T[]) => allowed.find((each) => each === words.get(name));
  const switched = (name: string) => ({ on: true, off: false })[words.get(name) ?? ""];
  // Nothing but the surfaces is on, unless it is named.
  const isClean = switched("clean") ?? words.get("clean") === "";
  const isOn = (name: string) => switched(name) ?? (isClean ? false : undefined);
  const names = (name: string) => (words.has(name) ? words.getAll(name).flatMap((text) => text.split(",")).filter((each) => each !== "") : undefined);
  return {
    frame: number("frame"),
    turn: number("turn"),
    tilt: number("tilt"),
    up: one("up", ["x", "y", "z"] as const),
    style: one("style", ["shaded", "lines", "wireframe"] as const),
    colour: one("colour", ["plain", "displacement", "signed", "velocity"] as const),
    theme: one("theme", ["light", "dark"] as const),
    gizmos: isOn("gizmos"),
    regions: isOn("regions"),
    boxes: isOn("boxes"),
    colliders: isOn("colliders"),
    labels: isOn("labels"),
    legend: isOn("legend"),
    caption: isOn("caption"),
    floor: isOn("floor"),
    hide: names("hide"),
    solo: names("solo"),
    peak: number("peak"),
  };
}

/** The words that were given. */
export function defined(look: Look): Look {
  return Object.fromEntries(Object.entries(look).filter(([, value]) => value !== undefined)) as Look;
}
