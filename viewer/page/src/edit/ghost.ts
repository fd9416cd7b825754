// A take behind the scene: its surfaces at one frame, translucent and of one colour.

import * as THREE from "three";

import { split, type ArrayPlace } from "../bake";
import { turnNormals } from "../surface_look";
import { positionsIn, type LiveFacts } from "./live_scene";
import type { Requests } from "./requests";

const mostBytes = 100_000_000;

const translucent = (more: THREE.MeshStandardMaterialParameters) => new THREE.MeshStandardMaterial({ side: THREE.DoubleSide, roughness: 0.8, metalness: 0, transparent: true, depthWrite: false, ...more });

/** For what is behind something else, by more than a share of its distance. */
function hiddenMaterial(): THREE.MeshStandardMaterial {
  const material = translucent({ opacity: 0.28, depthFunc: THREE.GreaterDepth });
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader.replace("#include <project_vertex>", "#include <project_vertex>\ngl_Position = projectionMatrix * vec4(0.997 * mvPosition.xyz, 1.0);");
  };
  return material;
}

export class Ghost {
  readonly group = new THREE.Group();
  /** Null: nothing is drawn. */
  shownFrame: number | null = null;
  /** Null: it has not been read. */
  private facts: LiveFacts | null = null;
  private readonly meshes: THREE.Mesh<THREE.BufferGeometry, THREE.MeshStandardMaterial>[] = [];
  // What is at the same place as the scene is not drawn.
  private readonly material = translucent({ opacity: 0.45, polygonOffset: true, polygonOffsetFactor: 3, polygonOffsetUnits: 3 });
  private readonly hidden = hiddenMaterial();
  private readonly frames = new Map<number, Float32Array[]>();
  /** The first frame that is known to fail. */
  private failsFrom = Infinity;

  constructor(
    readonly take: number,
    /** Of its colour among those of the theme. */
    readonly slot: number,
    private readonly requests: Requests,
  ) {
    this.group.name = `ghost ${take}`;
  }

  set colour(colour: string) {
    for (const material of [this.material, this.hidden]) material.color.set(colour);
  }

  get isRead(): boolean {
    return this.facts !== null;
  }

  async read(): Promise<void> {
    const facts = await this.requests.json<LiveFacts>(`scene?take=${this.take}`);
    const box = new THREE.Box3();
    for (const { low, high } of facts.surfaces) box.expandByPoint(new THREE.Vector3(...low)).expandByPoint(new THREE.Vector3(...high));
    box.getCenter(this.group.position); // places far from 0 would be rough in single precision
    for (const { name, shape } of facts.surfaces) {
      const packed = await this.requests.bytes(`shape?key=${shape}`);
      const { head, start } = split<{ version: number } & Record<"rest" | "triangles", ArrayPlace>>(packed);
      const geometry = new THREE.BufferGeometry();
      for (const attribute of ["position", "normal"]) geometry.setAttribute(attribute, new THREE.BufferAttribute(new Float32Array(head.rest.count), 3).setUsage(THREE.DynamicDrawUsage));
      geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(packed, start + head.triangles.begin, head.triangles.count), 1));
      const mesh = new THREE.Mesh(geometry, this.material);
      mesh.name = `${this.group.name} ${name}`;
      const hidden = new THREE.Mesh(geometry, this.hidden);
      mesh.add(hidden);
      mesh.frustumCulled = hidden.frustumCulled = false; // vertices move
      this.meshes.push(mesh);
    }
    this.facts = facts;
  }

  /** The frame to fetch next if the playhead is at one: that one, then those ahead of it; null: all are there. */
  missing(frame: number): number | null {
    const { facts } = this;
    if (!facts) return null;
    const span = facts.last - facts.first + 1;
    const one = facts.surfaces.reduce((sum, { vertices }) => sum + 12 * vertices, 1);
    const count = Math.min(Math.max(Math.floor(mostBytes / 2 / one), 1), span);
    const from = Math.min(Math.max(frame, facts.first), facts.last) - facts.first;
    for (let k = 0; k < count; ++k) {
      const next = facts.first + ((from + k) % span);
      if (next < this.failsFrom && !this.frames.has(next)) return next;
    }
    return null;
  }

  async fetch(frame: number, signal: AbortSignal): Promise<void> {
    const positions = positionsIn(await this.requests.bytes(`frame?take=${this.take}&frame=${frame}`, signal));
    this.frames.set(frame, positions);
    const one = positions.reduce((sum, each) => sum + each.byteLength, 1);
    if (this.frames.size * one <= mostBytes) return;
    const farthest = [...this.frames.keys()].reduce((a, b) => (Math.abs(a - frame) >= Math.abs(b - frame) ? a : b));
    this.frames.delete(farthest);
  }

  /** The run of the take fails there. */
  fail(frame: number): void {
    this.failsFrom = Math.min(this.failsFrom, frame);
  }

  /** Draws a frame. One that is not here leaves the last; what the take does not have is not drawn. */
  show(frame: number): void {
    if (!this.facts) return;
    const positions = this.frames.get(frame);
    if (positions) this.put(positions);
    if (positions) this.shownFrame = frame;
    else if (frame < this.facts.first || frame > this.facts.last || frame >= this.failsFrom) this.shownFrame = null;
    if (this.shownFrame === null) this.group.clear();
    else this.group.add(...this.meshes);
  }

  /** World positions of what is drawn, by the names of surfaces. */
  get positions(): Record<string, Float32Array> {
    const shown = this.shownFrame === null ? undefined : this.frames.get(this.shownFrame);
    return Object.fromEntries((this.facts?.surfaces ?? []).flatMap(({ name }, k) => (shown ? [[name, shown[k]]] : [])));
  }

  dispose(): void {
    for (const { geometry } of this.meshes) geometry.dispose();
    for (const material of [this.material, this.hidden]) material.dispose();
  }

  private put(positions: Float32Array[]): void {
    const middle = this.group.position.toArray();
    this.meshes.forEach(({ geometry }, k) => {
      const [places, normals] = ["position", "normal"].map((name) => geometry.getAttribute(name) as THREE.BufferAttribute);
      const array = places.array as Float32Array;
      for (let n = 0; n < array.length; ++n) array[n] = positions[k][n] - middle[n % 3];
      turnNormals(array, geometry.index!.array as Uint32Array, normals.array as Float32Array);
      places.needsUpdate = normals.needsUpdate = true;
    });
  }
}
