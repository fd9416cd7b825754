// A picture of all takes for the command: a table, each with its number and values below it, and the
// scale of the colours at the bottom.

import { drawLegend, type Legend } from "../legend";
import type { Palette } from "../theme";
import type { Studio } from "./studio";
import type { Sweep } from "./sweep";

export interface SheetJob {
  width: number;
  height: number;
  columns: number;
  /** Width and height of the picture; the scale of the colours is at its bottom. */
  whole: [number, number];
  /** The size of the letters, and the height of a line. */
  text: number;
  line: number;
  /** Pixels below each take for its number and values. */
  label: number;
}

/** A PNG of the size that the command expects for as many takes as were to be shown. */
export function drawSheet(sweep: Sweep, studio: Studio, legend: Legend, summary: string, palette: Palette, job: SheetJob): Promise<Blob> {
  const { width, height, columns, text, line, label } = job;
  const inset = Math.round(0.6 * text);
  const sheet = document.createElement("canvas");
  [sheet.width, sheet.height] = job.whole;
  const context = sheet.getContext("2d")!;
  context.fillStyle = palette.panel;
  context.fillRect(0, 0, sheet.width, sheet.height);
  studio.colour(palette);
  const lines = Math.floor((label - 1.8 * text) / line);
  context.textBaseline = "middle";
  sweep.shapes.forEach((shape, k) => {
    const [left, top] = [(k % columns) * width, Math.floor(k / columns) * (height + label)];
    studio.draw(shape, context, left, top, width - 1, height);
    context.fillStyle = palette.ink;
    const room = width - 1 - 2 * inset;
    // Returns the room that is left beside it.
    const put = (words: string, row: number, align: "left" | "right", weight: number, most: number) => {
      context.font = `${weight} ${text}px system-ui, sans-serif`;
      context.textAlign = align;
      const shown = cut(context, words, most);
      context.fillText(shown, left + inset + (align === "right" ? room : 0), top + height + 1.1 * text + row * line);
      return room - context.measureText(shown).width - 0.5 * text;
    };
    const beside = put(`${sweep.takes[shape.row]}`, 0, "left", 700, room);
    const frame = `frame ${shape.frame}`;
    context.font = `400 ${text}px system-ui, sans-serif`;
    if (context.measureText(frame).width <= beside) put(frame, 0, "right", 400, beside);
    sweep.captions(shape.row, lines).forEach(([name, value], k) => {
      put(name, k + 1, "left", 400, put(value, k + 1, "right", 600, 0.7 * room));
    });
  });
  const bottom = sheet.height - Math.round(0.6 * text);
  const scale = drawLegend(context, legend, text, bottom, text, { ...palette, background: palette.panel });
  const room = sheet.width - inset - scale[2] - text;
  context.font = `400 ${text}px system-ui, sans-serif`;
  context.textAlign = "right";
  if (room > 12 * text) context.fillText(cut(context, summary, room), sheet.width - inset, bottom - 0.5 * text);
  return new Promise((resolve, reject) => sheet.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("not enough memory for the picture"))), "image/png"));
}

/** The text, with some of its middle left out if there is no room: names often differ at the end. [px] */
function cut(context: CanvasRenderingContext2D, text: string, room: number): string {
  if (context.measureText(text).width <= room) return text;
  const letters = [...text];
  const shortened = (count: number) => `${letters.slice(0, Math.ceil(count / 2)).join("")}…${letters.slice(letters.length - Math.floor(count / 2)).join("")}`;
  let count = letters.length - 1;
  while (count > 1 && context.measureText(shortened(count)).width > room) --count;
  return shortened(count);
}
