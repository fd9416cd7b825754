// Pictures of the stage: one frame, or a sheet of several, with labels and legend as in the page.

import { drawLabels, type Area } from "./labels";
import { captionsOf, drawLegend, legendOf } from "./legend";
import type { Palette, ThemeChoice } from "./theme";
import type { Viewer } from "./viewer";

export interface PictureJob {
  width: number;
  height: number;
  frames: number[];
  columns: number;
  /** Pixels under each frame of a sheet for its number; 0: none. */
  label: number;
  /** Pixels below a sheet for one legend of all its frames; 0: none. */
  strip: number;
  /** The bytes of all pixels instead of a PNG. */
  hasPixels: boolean;
}

/** Smaller pictures show only the surfaces, without text. [px] */
const leastForWords = { width: 240, height: 180 };

/**
 * Draws the longest caption for which there is room: below the frame of a sheet, else into its upper left corner. Returns
 * the covered area.
 */
function drawCaption(context: CanvasRenderingContext2D, captions: string[], { width, height, label }: PictureJob, text: number, palette: Palette): Area {
  context.font = `${text}px system-ui, sans-serif`;
  const widthOf = (words: string) => context.measureText(words).width;
  const caption = captions.find((words) => widthOf(words) <= width - 2 * text) ?? captions.at(-1)!;
  const [x, y] = label > 0 ? [(width - widthOf(caption)) / 2, height + 19] : [text, 1.8 * text];
  context.textAlign = "left";
  context.textBaseline = "alphabetic";
  context.lineJoin = "round";
  context.lineWidth = 0.25 * text;
  context.strokeStyle = palette.background;
  context.strokeText(caption, x, y);
  context.fillStyle = palette.ink;
  context.fillText(caption, x, y);
  return [x, y - text, x + widthOf(caption), y + 0.3 * text];
}

/**
 * A picture of width x height pixels for one frame; several frames form a table of pictures of that
 * size.
 */
export async function takePicture(viewer: Viewer, themes: ThemeChoice, job: PictureJob): Promise<Blob | Uint8Array<ArrayBuffer>> {
  const { width, height, frames, columns, label, strip } = job;
  const isSheet = frames.length > 1;
  const { palette } = themes;
  const legend = legendOf(viewer, palette);
  const text = Math.min(Math.max(width / 85, 11), 26);
  const hasWords = width >= leastForWords.width && height >= leastForWords.height;
  const rows = Math.ceil(frames.length / columns);
  const across = Math.min(columns, frames.length);
  const sheet = document.createElement("canvas");
  [sheet.width, sheet.height] = [width * across, (height + label) * rows + strip];
  const context = sheet.getContext("2d", { willReadFrequently: true })!; // drawn by the CPU, which needs its pixels
  context.fillStyle = palette.background;
  context.fillRect(0, 0, sheet.width, sheet.height);
  viewer.stage.pin(width, height);
  const drawn = frames.map((frame) => {
    viewer.playback.goTo(frame);
    return { picture: viewer.stage.drawPixels(), labels: viewer.labels(), captions: captionsOf(viewer) };
  });
  for (const [k, { picture, labels, captions }] of drawn.entries()) {
    const pixels = await picture;
    context.save();
    context.translate((k % columns) * width, Math.floor(k / columns) * (height + label));
    context.beginPath();
    context.rect(0, 0, width, height + label);
    context.clip();
    context.putImageData(pixels, (k % columns) * width, Math.floor(k / columns) * (height + label)); // as it is
    const taken: Area[] = [];
    if (viewer.display.hasCaption && (isSheet || hasWords)) taken.push(drawCaption(context, captions, job, isSheet ? 15 : text, palette));
    if (legend && hasWords && !isSheet) taken.push(drawLegend(context, legend, text, height - 0.8 * text, text, palette));
    if (hasWords) drawLabels(context, labels, viewer.stage.camera, { width, height, text }, taken, palette);
    context.restore();
  }
  if (legend && isSheet) drawLegend(context, legend, 14, sheet.height - 8, 13, palette);
  if (job.hasPixels) return new Uint8Array(context.getImageData(0, 0, sheet.width, sheet.height).data.buffer);
  return new Promise((resolve, reject) => sheet.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("not enough memory for the picture"))), "image/png"));
}
