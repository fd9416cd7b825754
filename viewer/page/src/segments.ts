// Lines of any width, as one mesh. Three.js draws each of their segments as an instance, for which
// drawing by the CPU takes as long as for a mesh.

import * as THREE from "three";
import type { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";

/** What LineSegmentsGeometry has for each segment: two triangles between its ends, and two for each round cap. */
const one = new LineSegmentsGeometry();
const capped = { corners: one.getAttribute("position").array, uvs: one.getAttribute("uv").array, triangles: one.index!.array };
/** Without the caps. */
const bare = { corners: capped.corners.slice(6, 18), uvs: capped.uvs.slice(4, 12), triangles: [0, 2, 1, 2, 3, 1] };

export class SegmentsGeometry extends THREE.BufferGeometry {
  /** Both ends of each segment: x y z, x y z. */
  ends = new Float32Array();
  private buffer: THREE.InterleavedBuffer | null = null;
  private readonly shape: typeof capped | typeof bare;

  /** Segments of a smooth curve need no caps, and are drawn three times as fast. */
  constructor(isSmooth = false) {
    super();
    this.shape = isSmooth ? bare : capped;
  }

  setEnds(ends: ArrayLike<number>): this {
    this.ends = Float32Array.from(ends);
    const count = this.ends.length / 6;
    const cornerCount = this.shape.corners.length / 3;
    if (this.buffer?.count !== cornerCount * count) this.build(count);
    const { array } = this.buffer!;
    for (let segment = 0; segment < count; ++segment) {
      const both = this.ends.subarray(6 * segment, 6 * segment + 6);
      for (let corner = 0; corner < cornerCount; ++corner) array.set(both, 6 * (cornerCount * segment + corner));
    }
    this.buffer!.needsUpdate = true;
    this.boundingSphere = new THREE.Box3().setFromArray(this.ends as unknown as number[]).getBoundingSphere(new THREE.Sphere());
    return this;
  }

  private build(count: number): void {
    const { corners, uvs, triangles } = this.shape;
    const cornerCount = corners.length / 3;
    const repeated = (numbers: ArrayLike<number>, step = 0) =>
      Float32Array.from({ length: numbers.length * count }, (_, k) => numbers[k % numbers.length] + step * Math.floor(k / numbers.length));
    this.dispose();
    this.setAttribute("position", new THREE.BufferAttribute(repeated(corners), 3));
    this.setAttribute("uv", new THREE.BufferAttribute(repeated(uvs), 2));
    this.setIndex(new THREE.BufferAttribute(Uint32Array.from(repeated(triangles, cornerCount)), 1));
    this.buffer = new THREE.InterleavedBuffer(new Float32Array(6 * cornerCount * count), 6).setUsage(THREE.DynamicDrawUsage);
    this.setAttribute("instanceStart", new THREE.InterleavedBufferAttribute(this.buffer, 3, 0));
    this.setAttribute("instanceEnd", new THREE.InterleavedBufferAttribute(this.buffer, 3, 3));
  }
}

export class Segments extends THREE.Mesh<SegmentsGeometry, LineMaterial> {
  override onBeforeRender = (renderer: THREE.WebGLRenderer): void => {
    const { z, w } = renderer.getViewport(new THREE.Vector4());
    this.material.resolution.set(z, w);
  };
}
