// One collider in the scene graph: a shaded solid, or a translucent square of a plane.

import * as THREE from "three";

import { at, matrixBetween, type BakedCollider } from "./bake";
import type { Label } from "./labels";
import { roundCell } from "./stage";
import { turnNormals } from "./surface_look";
import type { Palette } from "./theme";

interface Shape {
  object: THREE.Object3D;
  /** Of its name, from the object's place. */
  named: THREE.Vector3;
  mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshStandardMaterial>;
  /** Sets the shape for a frame; `matrix`: where the collider is. */
  show(index: number, share: number, matrix: THREE.Matrix4): void;
  colour(palette: Palette): void;
  dispose(): void;
}

function solid(collider: BakedCollider): Shape {
  const geometry = new THREE.BufferGeometry();
  const points = new Float32Array(collider.points.length);
  geometry.setAttribute("position", new THREE.BufferAttribute(points, 3).setUsage(THREE.DynamicDrawUsage));
  geometry.setAttribute("normal", new THREE.BufferAttribute(new Float32Array(points.length), 3).setUsage(THREE.DynamicDrawUsage));
  geometry.setIndex(new THREE.BufferAttribute(collider.triangles, 1));
  const material = new THREE.MeshStandardMaterial({ roughness: 0.6, metalness: 0, flatShading: collider.head.isFlat ?? false });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.frustumCulled = false; // points move
  let isStill = false;
  return {
    object: mesh,
    named: new THREE.Vector3(),
    mesh,
    show(index, share) {
      if (isStill) return;
      isStill = !collider.head.motion;
      collider.pointsAt(index, share, points);
      turnNormals(points, collider.triangles, geometry.getAttribute("normal").array as Float32Array);
      for (const name of ["position", "normal"]) geometry.getAttribute(name).needsUpdate = true;
      geometry.boundingSphere = geometry.boundingBox = null;
    },
    colour: (palette) => material.color.set(palette.collider),
    dispose() {
      geometry.dispose();
      material.dispose();
    },
  };
}

/** A part of a plane near the middle of the scene: its lines go with the plane, and it goes on by whole cells. */
function square(reach: number, middle: THREE.Vector3): Shape {
  const cell = roundCell(reach);
  const count = 2 * Math.ceil((0.5 * reach) / cell);
  const geometry = new THREE.PlaneGeometry(count * cell, count * cell).rotateX(-Math.PI / 2);
  const material = new THREE.MeshStandardMaterial({ roughness: 0.9, side: THREE.DoubleSide, transparent: true, opacity: 0.3, depthWrite: false });
  const mesh = new THREE.Mesh(geometry, material);
  const lines = new THREE.GridHelper(count * cell, count, 0xffffff, 0xffffff);
  lines.material.transparent = true;
  lines.material.opacity = 0.5;
  lines.material.depthWrite = false;
  const object = new THREE.Group().add(mesh, lines);
  return {
    object,
    named: new THREE.Vector3(-0.5 * count * cell, 0, -0.5 * count * cell), // away from the first view
    mesh,
    show(_index, _share, matrix) {
      const near = middle.clone().applyMatrix4(matrix.clone().invert());
      object.position.set(Math.round(near.x / cell) * cell, 0, Math.round(near.z / cell) * cell);
    },
    colour(palette) {
      material.color.set(palette.collider);
      lines.material.color.set(palette.collider);
    },
    dispose() {
      geometry.dispose();
      material.dispose();
      lines.dispose();
    },
  };
}

export class ColliderView {
  readonly group = new THREE.Group();
  private readonly shape: Shape;

  /** `reach` and `middle` are those of the scene. */
  constructor(
    readonly collider: BakedCollider,
    reach: number,
    middle: THREE.Vector3,
  ) {
    this.shape = collider.points.length > 0 ? solid(collider) : square(reach, middle);
    this.shape.mesh.name = collider.head.name;
    this.group.name = `collider ${collider.head.name}`;
    this.group.matrixAutoUpdate = false;
    this.group.add(this.shape.object);
  }

  get mesh(): THREE.Mesh {
    return this.shape.mesh;
  }

  /** Shows frame `index` plus `share` of the way to the next; a disabled one is not shown. */
  show(index: number, share: number, isShown: boolean): void {
    const { enabled, transforms } = this.collider.head;
    this.group.visible = isShown && at(enabled, index);
    if (!this.group.visible) return;
    matrixBetween(transforms, index, share, this.group.matrix);
    this.shape.show(index, share, this.group.matrix);
    this.group.matrixWorldNeedsUpdate = true;
  }

  /** Beside its middle; null: it is not shown. */
  label(): Label | null {
    if (!this.group.visible) return null;
    const place = this.shape.object.position.clone().add(this.shape.named).applyMatrix4(this.group.matrix);
    return { text: this.collider.head.name, place, rank: 1, isFaint: false, isGroup: false, isCollider: true };
  }

  colour(palette: Palette): void {
    this.shape.colour(palette);
  }

  dispose(): void {
    this.shape.dispose();
  }
}
