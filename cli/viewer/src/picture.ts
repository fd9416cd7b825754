// Pictures of the stage: one frame, or a sheet of several.

import type { Viewer } from "./viewer";
import type { ThemeChoice } from "./theme";

export interface PictureJob {
  width: number;
  height: number;
  frames: number[];
  columns: number;
  /** Pixels under each frame of a sheet for its number; 0: none. */
  label: number;
}

/** A PNG of width x height pixels for one frame; several stand in a table, each that large. */
export async function takePicture(viewer: Viewer, themes: ThemeChoice, job: PictureJob): Promise<Blob> {
  const { width, height, frames, columns, label } = job;
  const rows = Math.ceil(frames.length / columns);
  const sheet = document.createElement("canvas");
  [sheet.width, sheet.height] = [width * Math.min(columns, frames.length), (height + label) * rows];
  const context = sheet.getContext("2d")!;
  const { palette } = themes;
  context.fillStyle = palette.background;
  context.fillRect(0, 0, sheet.width, sheet.height);
  context.font = "15px system-ui, sans-serif";
  context.textAlign = "center";
  viewer.stage.pin(width, height);
  frames.forEach((frame, k) => {
    viewer.playback.goTo(frame);
    viewer.stage.draw();
    const x = (k % columns) * width;
    const y = Math.floor(k / columns) * (height + label);
    context.drawImage(viewer.stage.canvas, x, y);
    context.fillStyle = palette.ink;
    if (label > 0) context.fillText(`frame ${frame}`, x + width / 2, y + height + 19);
  });
  return new Promise((resolve, reject) => sheet.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("no memory for the picture"))), "image/png"));
}
