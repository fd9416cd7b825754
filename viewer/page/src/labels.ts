// Names beside the forces and colliders. If names would cover each other, the one with the highest rank is drawn.

import * as THREE from "three";

import type { Palette } from "./theme";

export interface Label {
  text: string;
  /** World space. */
  place: THREE.Vector3;
  /** Higher is more important. */
  rank: number;
  isFaint: boolean;
  isGroup: boolean;
  isCollider?: boolean;
}

/** Area of a picture or a page: left, top, right, bottom. [px] */
export type Area = [number, number, number, number];

const longest = 28;
/** With more labels than this, forces that do not push now have none. */
const crowd = 24;
const shortened = (text: string) => (text.length > longest ? `${text.slice(0, longest - 1)}…` : text);
const overlap = (a: Area, b: Area) => a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];

/** Draws the labels for which there is room outside `taken`. Returns the drawn texts. */
export function drawLabels(context: CanvasRenderingContext2D, labels: Label[], camera: THREE.Camera, size: { width: number; height: number; text: number }, taken: Area[], palette: Palette): string[] {
  const { width, height, text } = size;
  context.save();
  context.font = `600 ${text}px system-ui, sans-serif`;
  context.textBaseline = "middle";
  context.textAlign = "left";
  context.lineJoin = "round";
  const placed = [...taken];
  const drawn: string[] = [];
  const wanted = labels.length > crowd ? labels.filter((label) => !label.isFaint) : [...labels];
  for (const label of wanted.sort((a, b) => b.rank - a.rank)) {
    const seen = label.place.clone().project(camera);
    if (Math.abs(seen.z) > 1) continue;
    const [x, y] = [((seen.x + 1) / 2) * width, ((1 - seen.y) / 2) * height];
    const words = shortened(label.text);
    const room = context.measureText(words).width;
    const away = 0.6 * text;
    const corners = [[x + away, y - 1.5 * text], [x + away, y + 0.4 * text], [x - away - room, y - 1.5 * text], [x - away - room, y + 0.4 * text]];
    const area = corners
      .map(([left, over]): Area => [left - 2, over, left + room + 2, over + 1.2 * text])
      .find((each) => each[0] >= 0 && each[1] >= 0 && each[2] <= width && each[3] <= height && !placed.some((other) => overlap(each, other)));
    if (!area) continue;
    placed.push(area);
    drawn.push(label.text);
    context.globalAlpha = label.isFaint ? 0.55 : 1;
    context.strokeStyle = palette.background;
    context.lineWidth = 0.28 * text;
    context.strokeText(words, area[0] + 2, (area[1] + area[3]) / 2);
    context.fillStyle = label.isCollider ? palette.ink : label.isGroup ? palette.deformation : palette.force;
    context.fillText(words, area[0] + 2, (area[1] + area[3]) / 2);
  }
  context.restore();
  return drawn;
}
