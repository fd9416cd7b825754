// Numbers of the vertex or collider under the cursor.

import * as THREE from "three";

import { at, type Track, type Vector } from "./bake";
import type { ColliderView } from "./collider_view";
import { make } from "./element";
import type { Playback } from "./playback";
import type { Stage } from "./stage";
import type { SurfaceView } from "./surface_view";
import type { ThemeChoice } from "./theme";

/** Meshes with more triangles are picked only when the cursor rests. */
const manyTriangles = 150_000;

/** What a ray meets first on the stage; planes can be seen through. */
export function met(caster: THREE.Raycaster, views: SurfaceView[], colliders: ColliderView[]): { on: SurfaceView | ColliderView; hit: THREE.Intersection } | null {
  const things = [...views, ...colliders.filter(({ group }) => group.visible)];
  const hits = caster.intersectObjects(things.map(({ mesh }) => mesh), false).map((hit) => ({ on: things.find(({ mesh }) => mesh === hit.object)!, hit }));
  return hits.find(({ on }) => "surface" in on || on.collider.points.length > 0) ?? hits[0] ?? null;
}

/** The vertex of the face that was hit which is nearest to where. */
export function vertexAt(view: SurfaceView, { face, point }: THREE.Intersection): number {
  const near = (vertex: number) => view.vertex(vertex).distanceToSquared(point);
  return [face!.a, face!.b, face!.c].reduce((best, each) => (near(each) < near(best) ? each : best));
}

export class Readout {
  views: SurfaceView[] = [];
  colliders: ColliderView[] = [];
  private picked: { view: SurfaceView; vertex: number } | ColliderView | null = null;
  private readonly caster = new THREE.Raycaster();
  private readonly marker = new THREE.Mesh(new THREE.SphereGeometry(1, 16, 10), new THREE.MeshBasicMaterial({ depthTest: false, transparent: true }));
  private pending = 0;

  constructor(
    private readonly stage: Stage,
    private readonly output: HTMLOutputElement,
    private readonly playback: Playback,
    themes: ThemeChoice,
  ) {
    this.marker.name = "picked vertex";
    this.marker.visible = false;
    this.marker.renderOrder = 3;
    stage.scene.add(this.marker);
    const colour = () => this.marker.material.color.set(themes.palette.accent);
    themes.onChange(colour);
    colour();
    stage.canvas.addEventListener("pointermove", (event) => {
      if (event.buttons === 0) this.request(event);
    });
    stage.canvas.addEventListener("pointerup", (event) => this.request(event));
    stage.canvas.addEventListener("pointerleave", (event) => {
      if (event.pointerType === "mouse") this.clear();
    });
  }

  clear(): void {
    clearTimeout(this.pending);
    this.picked = null;
    this.update();
  }

  /** Shows what is picked at the present frame. */
  update(): void {
    const { picked } = this;
    this.marker.visible = picked !== null && "vertex" in picked;
    this.stage.invalidate();
    if (!picked) return this.tell([]);
    this.tell("vertex" in picked ? this.linesOfVertex(picked) : this.linesOfCollider(picked));
  }

  private tell(lines: [string, string][]): void {
    this.output.replaceChildren(
      ...lines.map(([label, text]) => make("span", {}, make("span", {}, label), make("b", {}, text))),
    );
  }

  private linesOfCollider({ collider: { head }, group }: ColliderView): [string, string][] {
    const index = this.playback.frame - this.playback.first;
    const place = new THREE.Vector3().setFromMatrixPosition(group.matrix);
    const text = (track: Track<number | boolean | Vector>) => {
      const value = at(track, index);
      return typeof value === "boolean" ? (value ? "on" : "off") : [value].flat().map(fixed).join(", ");
    };
    return [
      [head.kind, head.name],
      ["position", place.toArray().map(fixed).join(", ")],
      ...Object.entries(head.values).map(([name, track]): [string, string] => [name, text(track)]),
    ];
  }

  private linesOfVertex({ view, vertex }: { view: SurfaceView; vertex: number }): [string, string][] {
    const { name, columns, rows } = view.surface.head;
    const node = view.surface.nodes[vertex];
    const where = rows > 1 ? `(${node % columns}, ${Math.floor(node / columns)})` : `node ${node}`;
    const place = view.vertex(vertex, this.marker.position);
    this.marker.scale.setScalar(0.0045 * place.distanceTo(this.stage.camera.position));
    return [
      ["vertex", `${name} ${vertex}${node >= 0 ? ` ${where}` : ""}`],
      ["u, v", `${fixed(view.surface.uvs[2 * vertex])}, ${fixed(view.surface.uvs[2 * vertex + 1])}`],
      ["position", place.toArray().map(fixed).join(", ")],
      ["displacement", fixed(view.displacement[vertex])],
      ["along normal", fixed(view.signed[vertex])],
      ["velocity", `${fixed(view.speed[vertex])} /s`],
    ];
  }

  private request(event: PointerEvent): void {
    const triangles = this.views.reduce((sum, view) => sum + view.surface.triangles.length / 3, 0);
    clearTimeout(this.pending);
    this.pending = window.setTimeout(() => this.pick(event), triangles > manyTriangles ? 120 : 8);
  }

  private pick(event: PointerEvent): void {
    const box = this.stage.canvas.getBoundingClientRect();
    const at = new THREE.Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    this.caster.setFromCamera(at, this.stage.camera);
    const there = met(this.caster, this.views, this.colliders);
    if (!there) return this.clear();
    this.picked = "surface" in there.on ? { view: there.on, vertex: vertexAt(there.on, there.hit) } : there.on;
    this.update();
  }
}

/** Five digits, with room for a sign. */
function fixed(value: number): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e5 || size < 1e-4 ? value.toExponential(3) : value.toPrecision(5);
}
