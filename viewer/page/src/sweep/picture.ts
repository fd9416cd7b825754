// A picture of all takes for the command: a table, each with its number and values below it, and the
// scale of the colours at the bottom.

import { drawLegend, type Legend } from "../legend";
import type { Palette } from "../theme";
import { cut } from "./plot";
import type { Studio } from "./studio";
import type { Sweep } from "./sweep";

export interface SheetJob {
  width: number;
  height: number;
  columns: number;
  /** Pixels below each take for its number and values. */
  label: number;
  /** Pixels below all for the scale of the colours. */
  strip: number;
}

const lineHeight = 17;
const inset = 8;

/** A PNG of the size that the command expects for as many takes as were to be shown. */
export function drawSheet(sweep: Sweep, studio: Studio, legend: Legend, palette: Palette, job: SheetJob): Promise<Blob> {
  const { width, height, columns, label, strip } = job;
  const rows = Math.ceil((sweep.shapes.length + sweep.head.failures.length) / columns);
  const sheet = document.createElement("canvas");
  [sheet.width, sheet.height] = [columns * width, rows * (height + label) + strip];
  const context = sheet.getContext("2d")!;
  context.fillStyle = palette.panel;
  context.fillRect(0, 0, sheet.width, sheet.height);
  studio.colour(palette);
  const lines = Math.floor((label - 24) / lineHeight);
  sweep.shapes.forEach((shape, k) => {
    const [left, top] = [(k % columns) * width, Math.floor(k / columns) * (height + label)];
    studio.draw(shape, context, left, top, width - 1, height);
    const end = left + width - inset;
    context.textBaseline = "middle";
    const put = (text: string, x: number, y: number, align: CanvasTextAlign, weight: number, colour: string, room: number) => {
      context.font = `${weight} 13px system-ui, sans-serif`;
      context.textAlign = align;
      context.fillStyle = colour;
      context.fillText(cut(context, text, room), x, y);
    };
    put(`${sweep.takes[shape.row]}`, left + inset, top + height + 14, "left", 700, palette.ink, 0.5 * width);
    put(`frame ${shape.frame}`, end, top + height + 14, "right", 400, palette.ink, 0.5 * width - inset);
    sweep.captions(shape.row, lines).forEach(([name, value], line) => {
      const y = top + height + 14 + (line + 1) * lineHeight;
      put(name, left + inset, y, "left", 400, palette.ink, 0.58 * width - inset);
      put(value, end, y, "right", 600, palette.ink, 0.4 * width - inset);
    });
  });
  drawLegend(context, legend, 14, sheet.height - 8, 13, { ...palette, background: palette.panel });
  return new Promise((resolve, reject) => sheet.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("not enough memory for the picture"))), "image/png"));
}
