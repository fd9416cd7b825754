// Draws the selections on the surface: the rim of each region, the box of each force (thesis 5.3,
// fig. 5 and 12).

import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";

import type { Box } from "./bake";
import type { SurfaceView } from "./surface_view";
import type { Palette } from "./theme";

type Edge = [number, number];

/** The outline of the cells of some boxes, as edges between nodes. */
export function outline(parts: Box[], columns: number, rows: number): Edge[] {
  const edges: Edge[] = [];
  const node = (i: number, j: number) => j * columns + i;
  const clipped = parts
    .map(([i0, i1, j0, j1]): Box => [Math.max(i0, 0), Math.min(i1, columns - 1), Math.max(j0, 0), Math.min(j1, rows - 1)])
    .filter(([i0, i1, j0, j1]) => i0 <= i1 && j0 <= j1);
  // Whether the cell between (i,j) and (i+1,j+1) is in the part.
  const holds = ([i0, i1, j0, j1]: Box, i: number, j: number) => i >= i0 && i < i1 && j >= j0 && j < j1;
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

/** Lines along edges of the surface's grid. */
class NodeLines {
  readonly object: LineSegments2;
  private edges: Edge[] = [];

  constructor(name: string, material: LineMaterial) {
    this.object = new LineSegments2(new LineSegmentsGeometry(), material);
    this.object.name = name;
    this.object.frustumCulled = false;
  }

  take(edges: Edge[]): void {
    this.edges = edges;
    this.object.geometry.dispose();
    this.object.geometry = new LineSegmentsGeometry();
    this.object.visible = edges.length > 0;
  }

  follow(view: SurfaceView): void {
    if (this.edges.length === 0) return;
    const { nodeVertices } = view.surface;
    const source = view.mesh.geometry.getAttribute("position").array;
    const ends = new Float32Array(6 * this.edges.length);
    let write = 0;
    for (const edge of this.edges) {
      for (const node of edge) {
        const vertex = 3 * Math.max(nodeVertices[node], 0);
        for (let k = 0; k < 3; ++k) ends[write++] = source[vertex + k];
      }
    }
    this.object.geometry.setPositions(ends);
  }
}

const lineMaterial = (linewidth: number, opacity: number) =>
  new LineMaterial({ linewidth, opacity, transparent: true, polygonOffset: true, polygonOffsetFactor: -4, polygonOffsetUnits: -4 });

/** The regions and boxes of one surface. */
export class RegionView {
  // Slightly nearer than the surface, so that it does not hide them.
  private readonly materials = {
    rim: lineMaterial(2.5, 1),
    small: lineMaterial(1.5, 0.4),
    box: lineMaterial(2, 1),
    idle: lineMaterial(1.5, 0.3),
  };
  private readonly rim: NodeLines;
  private readonly small: NodeLines;
  private readonly boxes: NodeLines;
  private readonly idle: NodeLines;
  private shown = "";

  constructor(private readonly view: SurfaceView) {
    const { name } = view.surface.head;
    this.rim = new NodeLines(`${name} rim`, this.materials.rim);
    this.small = new NodeLines(`${name} unsolved`, this.materials.small);
    this.boxes = new NodeLines(`${name} force boxes`, this.materials.box);
    this.idle = new NodeLines(`${name} idle force boxes`, this.materials.idle);
    view.group.add(...this.lines.map((lines) => lines.object));
  }

  /** `isIdle`: for each force, whether its magnitude is 0. `isShown`: whether it is shown. */
  show(frame: number, hasRegions: boolean, hasBoxes: boolean, isIdle: boolean[], isShown: boolean[]): void {
    const { columns, rows } = this.view.surface.head;
    const marks = this.view.surface.marksAt(frame);
    const wanted = `${marks?.frame} ${hasRegions} ${hasBoxes} ${hasBoxes ? [...isIdle, ...isShown].map(Number).join("") : ""}`;
    if (wanted !== this.shown) {
      this.shown = wanted;
      const rims = (isSolved: boolean) =>
        hasRegions ? (marks?.regions ?? []).filter((each) => each.solved === isSolved).flatMap((each) => outline(each.parts, columns, rows)) : [];
      this.rim.take(rims(true));
      this.small.take(rims(false));
      const boxes = (areIdle: boolean) =>
        hasBoxes ? (marks?.forces ?? []).filter((each) => isShown[each.force] && isIdle[each.force] === areIdle).flatMap((each) => outline([each.box], columns, rows)) : [];
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

  private get lines(): NodeLines[] {
    return [this.rim, this.small, this.boxes, this.idle];
  }
}
