// The words that the page's address may have after #: `frame=12&colour=velocity&turn=30`.

import type { Colour, Style } from "./surface_view";
import type { Theme } from "./theme";

export interface Look {
  frame?: number;
  turn?: number;
  tilt?: number;
  style?: Style;
  colour?: Colour;
  theme?: Theme;
  gizmos?: boolean;
  regions?: boolean;
  boxes?: boolean;
  labels?: boolean;
  legend?: boolean;
  floor?: boolean;
  /** Names of forces and groups. */
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
  const isOn = (name: string) => ({ on: true, off: false })[words.get(name) ?? ""];
  const names = (name: string) => (words.has(name) ? words.getAll(name).flatMap((text) => text.split(",")).filter((each) => each !== "") : undefined);
  return {
    frame: number("frame"),
    turn: number("turn"),
    tilt: number("tilt"),
    style: one("style", ["shaded", "lines", "wireframe"] as const),
    colour: one("colour", ["plain", "displacement", "velocity"] as const),
    theme: one("theme", ["light", "dark"] as const),
    gizmos: isOn("gizmos"),
    regions: isOn("regions"),
    boxes: isOn("boxes"),
    labels: isOn("labels"),
    legend: isOn("legend"),
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
