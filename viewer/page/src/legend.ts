// The meaning of the colours: the same text and drawing for the page and for pictures.

import type { ShownBake } from "./bake";
import type { Area } from "./labels";
import { numberText } from "./curve_plot";
import { make } from "./element";
import { ramps } from "./surface_view";
import type { Palette } from "./theme";
import type { Viewer } from "./viewer";

/** A scene defines no unit of length: lengths are in the units of its numbers, times in seconds. */
export const titles = {
  displacement: "Displacement [scene units]",
  signed: "Signed displacement [scene units]",
  velocity: "Velocity [scene units/s]",
};

interface Ink {
  colour: string;
  means: string;
}

export interface Legend {
  /** The colours of the surfaces; null: they are plain. `frames`: which frames the largest number is of; empty: all of the scene. */
  scale: { title: string; css: string; at: (share: number) => string; low: string; high: string; frames: string } | null;
  /** The colours of the lines. */
  inks: Ink[];
}

/** The legend for the present display; null: not needed or not wanted. */
export function legendOf(viewer: Viewer, palette: Palette): Legend | null {
  const { display, bake } = viewer;
  if (!display.hasLegend || !bake) return null;
  const forces = bake.head.forces.filter((force) => viewer.forces.isShown(force));
  const inks: Ink[] = [];
  const add = (isThere: boolean, colour: string, means: string) => isThere && inks.push({ colour, means });
  add(display.hasGizmos && forces.some((force) => force.deformationRadius), palette.deformation, "deforms");
  add((display.hasGizmos || display.hasBoxes) && forces.length > 0, palette.force, "is pushed");
  add(display.hasRegions && bake.head.surfaces.some((surface) => surface.marks.length > 0), palette.rim, "is solved");
  add(display.hasGizmos && bake.surfaces.some((surface) => surface.pins.length > 0), palette.pin, "is held");
  add(display.hasColliders && bake.colliders.length > 0 && bake.surfaces.some((surface) => surface.mostTouching > 0), palette.touch, "touches");
  const { colour } = display;
  if (colour === "plain") return inks.length > 0 ? { scale: null, inks } : null;
  const ramp = ramps[colour];
  const { low, high } = viewer.ends();
  const scale = { title: titles[colour], css: ramp.css(), at: (share: number) => ramp.cssAt(share), low: numberText(low), high: numberText(high) };
  return { scale: { ...scale, frames: display.peak === null ? framesOf(bake) : "" }, inks };
}

/** The frames of a page that has only some of its scene. */
function framesOf({ head: { first, last, sceneFrames } }: ShownBake): string {
  if (!sceneFrames || (first === sceneFrames[0] && last === sceneFrames[1])) return "";
  return first === last ? `at frame ${first}` : `in frames ${first} to ${last}`;
}

/** The present frame and its displacement, in words for much room and for little. */
export function captionsOf(viewer: Viewer): string[] {
  const [frame, displaced] = [`frame ${viewer.playback.frame}`, numberText(viewer.displaced())];
  return [`${frame} · displacement ${displaced}`, `${frame} · ${displaced}`, frame];
}

/** Shows the legend in the page. */
export function showLegend(place: HTMLElement, legend: Legend | null): void {
  place.hidden = legend === null;
  if (!legend) return;
  const part = (name: string) => place.querySelector<HTMLElement>(`#legend-${name}`)!;
  part("scale").hidden = legend.scale === null;
  if (legend.scale) {
    part("title").textContent = legend.scale.title;
    part("low").textContent = legend.scale.low;
    part("high").textContent = legend.scale.high;
    part("frames").textContent = legend.scale.frames;
    part("frames").hidden = legend.scale.frames === "";
    part("ramp").style.background = legend.scale.css;
    part("ramp").setAttribute("aria-label", `Colours from ${legend.scale.low} to ${legend.scale.high}`);
  }
  part("inks").replaceChildren(
    ...legend.inks.map(({ colour, means }) => {
      const mark = make("i");
      mark.style.background = colour;
      return make("span", {}, mark, means);
    }),
  );
}

/**
 * Draws the legend into a picture, with its lower left corner at (left, bottom). Returns the
 * covered area.
 */
export function drawLegend(context: CanvasRenderingContext2D, legend: Legend, left: number, bottom: number, text: number, palette: Palette): Area {
  const width = 15 * text;
  const line = 1.35 * text;
  const rows = (legend.scale ? 2.6 : 0) + (legend.scale?.frames ? 1 : 0) + (legend.inks.length > 0 ? 1.1 : 0);
  let y = bottom - rows * line;
  context.save();
  context.font = `${text}px system-ui, sans-serif`;
  const room = legend.scale ? context.measureText(legend.scale.title).width : 0;
  const area: Area = [left - 4, y - 0.4 * text, left + Math.max(width, room) + 4, bottom];
  context.textBaseline = "middle";
  // A background, so that lines behind it do not cross its numbers.
  context.globalAlpha = 0.8;
  context.fillStyle = palette.background;
  context.fillRect(area[0], area[1], area[2] - area[0], area[3] - area[1]);
  context.globalAlpha = 1;
  const put = (words: string, x: number, align: CanvasTextAlign) => {
    context.textAlign = align;
    context.strokeStyle = palette.background;
    context.lineWidth = 0.25 * text;
    context.lineJoin = "round";
    context.strokeText(words, x, y);
    context.fillStyle = palette.ink;
    context.fillText(words, x, y);
  };
  y += 0.5 * text;
  if (legend.scale) {
    put(legend.scale.title, left, "left");
    y += 0.65 * line;
    const height = Math.round(0.7 * text);
    for (let x = 0; x < width; ++x) {
      context.fillStyle = legend.scale.at(x / (width - 1));
      context.fillRect(Math.round(left) + x, Math.round(y), 1, height);
    }
    y += 0.95 * line;
    put(legend.scale.low, left, "left");
    put(legend.scale.high, left + width, "right");
    if (legend.scale.frames) {
      y += line;
      put(legend.scale.frames, left, "left");
    }
    y += 1.1 * line;
  }
  let x = left;
  for (const { colour, means } of legend.inks) {
    context.fillStyle = colour;
    context.fillRect(x, y - 0.1 * text, 0.9 * text, 0.22 * text);
    put(means, x + 1.2 * text, "left");
    x += 1.2 * text + context.measureText(means).width + 0.9 * text;
  }
  context.restore();
  return area;
}
