// Draws the selections on the surface: the rim of each region, the box of each force (thesis 5.3,
// fig. 5 and 12), or what it pushes on a surface of triangles.

import * as THREE from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";

import type { Box, Lines, LinesPlace, Marks, ShownSurface } from "./bake";
import { Segments, SegmentsGeometry } from "./segments";
import type { SurfaceView } from "./surface_view";
import type { Palette } from "./theme";

type Edge = [number, number];

interface GridHead {
  columns: number;
  rows: number;
  wrap?: "u" | "v" | "uv";
}

/**
 * The outline of the cells of some boxes, as edges between nodes. Along a closed direction columns (rows) are counted
 * round: a box may end beyond the last one, and a box of all of them goes all round.
 */
export function outline(parts: Box[], { columns, rows, wrap }: GridHead): Edge[] {
  const edges: Edge[] = [];
  const [isClosedU, isClosedV] = [wrap?.includes("u") ?? false, wrap?.includes("v") ?? false];
  const node = (i: number, j: number) => (isClosedV ? j % rows : j) * columns + (isClosedU ? i % columns : i);
  // The first and the last line between which a box has cells.
  const clip = (first: number, last: number, count: number, isClosed: boolean) =>
    isClosed ? [first, last - first + 1 === count ? last + 1 : last] : [Math.max(first, 0), Math.min(last, count - 1)];
  const clipped = parts
    .map(([i0, i1, j0, j1]) => [...clip(i0, i1, columns, isClosedU), ...clip(j0, j1, rows, isClosedV)] as Box)
    .filter(([i0, i1, j0, j1]) => i0 <= i1 && j0 <= j1);
  // Whether the cell between two lines is between `first` and `last`, if need be after a lap.
  const isBetween = (line: number, first: number, last: number, count: number, isClosed: boolean) =>
    isClosed ? (((line - first) % count) + count) % count < last - first : line >= first && line < last;
  // Whether the cell between (i,j) and (i+1,j+1) is in the part.
  const holds = ([i0, i1, j0, j1]: Box, i: number, j: number) =>
    isBetween(i, i0, i1, columns, isClosedU) && isBetween(j, j0, j1, rows, isClosedV);
  const isInside = (i: number, j: number) => clipped.some((part) => holds(part, i, j));
  clipped.forEach((part, k) => {
    const [i0, i1, j0, j1] = part;
    // An edge that two parts share belongs to the first.
    const isNew = (i: number, j: number) => !clipped.slice(0, k).some((before) => holds(before, i, j));
    for (let i = i0; i < i1; ++i) {
      if (!isInside(i, j0 - 1) && isNew(i, j0)) edges.push([node(i, j0), node(i + 1, j0)]);
      if (!isInside(i, j1) && isNew(i, j1 - 1)) edges.push([node(i, j1), node(i + 1, j1)]);
      if (j0 === j1) edges.push([node(i, j0), node(i + 1, j0)]);
    }
    for (let j = j0; j < j1; ++j) {
      if (!isInside(i0 - 1, j) && isNew(i0, j)) edges.push([node(i0, j), node(i0, j + 1)]);
      if (!isInside(i1, j) && isNew(i1 - 1, j)) edges.push([node(i1, j), node(i1, j + 1)]);
      if (i0 === i1) edges.push([node(i0, j), node(i0, j + 1)]);
    }
  });
  return edges;
}

/** Edges between nodes as lines between their first vertices. */
function linesOf(edges: Edge[], nodeVertices: Int32Array): Lines {
  const sources = edges.flat().map((node) => Math.max(nodeVertices[node], 0));
  return { starts: [...sources.keys(), sources.length], sources, shares: sources.map(() => 1), segments: [...sources.keys()] };
}

/** Lines that follow the surface. */
class FollowingLines {
  readonly object: Segments;
  private lines: Lines[] = [];

  constructor(name: string, material: LineMaterial) {
    this.object = new Segments(new SegmentsGeometry(), material);
    this.object.name = name;
    this.object.frustumCulled = false;
  }

  take(lines: Lines[]): void {
    this.lines = lines.filter(({ segments }) => segments.length > 0);
    this.object.geometry.dispose();
    this.object.geometry = new SegmentsGeometry();
    this.object.visible = this.lines.length > 0;
  }

  follow(view: SurfaceView): void {
    if (this.lines.length === 0) return;
    const positions = view.mesh.geometry.getAttribute("position").array;
    const ends = new Float32Array(this.lines.reduce((sum, { segments }) => sum + 3 * segments.length, 0));
    let write = 0;
    for (const { starts, sources, shares, segments } of this.lines) {
      const points = new Float32Array(3 * (starts.length - 1));
      for (let point = 0; point < starts.length - 1; ++point) {
        for (let entry = starts[point]; entry < starts[point + 1]; ++entry) {
          const isVertex = sources[entry] >= 0;
          const from = isVertex ? positions : points;
          const source = 3 * (isVertex ? sources[entry] : -1 - sources[entry]);
          for (let k = 0; k < 3; ++k) points[3 * point + k] += shares[entry] * from[source + k];
        }
      }
      for (let end = 0; end < segments.length; ++end) {
        for (let k = 0; k < 3; ++k) ends[write++] = points[3 * segments[end] + k];
      }
    }
    this.object.geometry.setEnds(ends);
  }
}

/** The lines of boxes, or those that the bake has. */
function linesOfMark(surface: ShownSurface, boxes: Box[], place?: LinesPlace): Lines {
  return place ? surface.linesAt(place) : linesOf(outline(boxes, surface.head), surface.nodeVertices);
}

const lineMaterial = (linewidth: number, opacity: number, nearness: number) =>
  // Lines face the picture whether the surface is mirrored or not.
  new LineMaterial({ linewidth, opacity, transparent: true, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: -nearness, polygonOffsetUnits: -nearness });

/** The regions and boxes of one surface. */
export class RegionView {
  // Slightly nearer than the surface, so that it does not hide them; boxes nearer than rims, which they may run along.
  private readonly materials = {
    rim: lineMaterial(2.5, 1, 4),
    small: lineMaterial(1.5, 0.4, 4),
    box: lineMaterial(2, 1, 6),
    idle: lineMaterial(1.5, 0.3, 6),
  };
  private readonly rim: FollowingLines;
  private readonly small: FollowingLines;
  private readonly boxes: FollowingLines;
  private readonly idle: FollowingLines;
  private shown = "";
  private marks: Marks | undefined;

  constructor(readonly view: SurfaceView) {
    const { name } = view.surface.head;
    this.rim = new FollowingLines(`${name} rim`, this.materials.rim);
    this.small = new FollowingLines(`${name} unsolved`, this.materials.small);
    this.boxes = new FollowingLines(`${name} force boxes`, this.materials.box);
    this.idle = new FollowingLines(`${name} idle force boxes`, this.materials.idle);
    view.group.add(...this.lines.map((lines) => lines.object));
  }

  /** `isIdle`: for each force, whether its magnitude is 0. `isShown`: whether it is shown. */
  show(frame: number, hasRegions: boolean, hasBoxes: boolean, isIdle: boolean[], isShown: boolean[]): void {
    const { surface } = this.view;
    const marks = surface.marksAt(frame);
    const wanted = `${hasRegions} ${hasBoxes} ${hasBoxes ? [...isIdle, ...isShown].map(Number).join("") : ""}`;
    if (wanted !== this.shown || marks !== this.marks) {
      this.shown = wanted;
      this.marks = marks;
      const rims = (isSolved: boolean) =>
        hasRegions ? (marks?.regions ?? []).filter((each) => each.solved === isSolved).map((each) => linesOfMark(surface, each.parts ?? [], each.lines)) : [];
      this.rim.take(rims(true));
      this.small.take(rims(false));
      const boxes = (areIdle: boolean) =>
        hasBoxes
          ? (marks?.forces ?? [])
              .filter((each) => isShown[each.force] && isIdle[each.force] === areIdle)
              .map((each) => linesOfMark(surface, each.box ? [each.box] : [], each.lines))
          : [];
      this.boxes.take(boxes(false));
      this.idle.take(boxes(true));
    }
    for (const lines of this.lines) lines.follow(this.view);
  }

  colour(palette: Palette): void {
    this.materials.rim.color.set(palette.rim);
    this.materials.small.color.set(palette.rim);
    this.materials.box.color.set(palette.force);
    this.materials.idle.color.set(palette.force);
  }

  dispose(): void {
    for (const lines of this.lines) lines.object.geometry.dispose();
    for (const material of Object.values(this.materials)) material.dispose();
  }

  private get lines(): FollowingLines[] {
    return [this.rim, this.small, this.boxes, this.idle];
  }
}
