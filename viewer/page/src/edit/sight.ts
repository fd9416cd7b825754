// Between the screen and the world: where a place is seen, and which place the pointer means.

import * as THREE from "three";

import { met, vertexAt } from "../readout";
import type { SurfaceView } from "../surface_view";
import type { Viewer } from "../viewer";

/** From the upper left corner of the view. [CSS px] */
export interface Spot {
  x: number;
  y: number;
}

export const between = (a: Spot, b: Spot) => Math.hypot(a.x - b.x, a.y - b.y);

/** How far a spot is from a segment. */
export function fromSegment(spot: Spot, a: Spot, b: Spot): number {
  const [dx, dy] = [b.x - a.x, b.y - a.y];
  const square = dx * dx + dy * dy;
  const share = square === 0 ? 0 : Math.min(Math.max(((spot.x - a.x) * dx + (spot.y - a.y) * dy) / square, 0), 1);
  return between(spot, { x: a.x + share * dx, y: a.y + share * dy });
}

/** How far something goes along `way` so that it is `room` away from those that are `taken`. */
export function aside(spot: Spot, way: Spot, taken: Spot[], room: number): Spot {
  let far = 0;
  // Each of them is passed once at most.
  for (let pass = 0; pass <= taken.length; ++pass) {
    const there = { x: spot.x + far * way.x, y: spot.y + far * way.y };
    const near = taken.find((each) => between(each, there) < room - 1e-6);
    if (!near) break;
    const [dx, dy] = [spot.x - near.x, spot.y - near.y];
    const along = dx * way.x + dy * way.y;
    far = -along + Math.sqrt(Math.max(along * along - (dx * dx + dy * dy) + room * room, 0));
  }
  return { x: far * way.x, y: far * way.y };
}

/** Of the angle between a line and the ray below which no place on the line is meant. */
const leastSine = 0.03;

export class Sight {
  private readonly caster = new THREE.Raycaster();

  constructor(readonly viewer: Viewer) {}

  get size(): { width: number; height: number } {
    const { clientWidth: width, clientHeight: height } = this.viewer.stage.canvas;
    return { width, height };
  }

  get right(): THREE.Vector3 {
    return new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
  }

  get up(): THREE.Vector3 {
    return new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
  }

  spotOf({ clientX, clientY }: MouseEvent): Spot {
    const { left, top } = this.viewer.stage.canvas.getBoundingClientRect();
    return { x: clientX - left, y: clientY - top };
  }

  /** Where a place is seen; null: it is behind the camera. */
  seen(place: THREE.Vector3): Spot | null {
    if (this.depth(place) <= 0) return null;
    const { width, height } = this.size;
    const { x, y } = place.clone().project(this.camera);
    return { x: ((x + 1) / 2) * width, y: ((1 - y) / 2) * height };
  }

  /** The length that a pixel shows at a place. */
  pixelAt(place: THREE.Vector3): number {
    return (2 * Math.max(this.depth(place), this.camera.near) * Math.tan(THREE.MathUtils.degToRad(this.camera.fov / 2))) / this.size.height;
  }

  /** The place in the plane through another one that faces the camera. */
  inPlane(spot: Spot, through: THREE.Vector3): THREE.Vector3 | null {
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(this.camera.getWorldDirection(new THREE.Vector3()), through);
    return this.ray(spot).intersectPlane(plane, new THREE.Vector3());
  }

  /** How many times `way` from `from` is nearest to the spot; null: it points at the viewer. */
  along(spot: Spot, from: THREE.Vector3, way: THREE.Vector3): number | null {
    const { origin, direction } = this.ray(spot);
    const length = way.length();
    if (length === 0) return null;
    const unit = way.clone().divideScalar(length);
    const cosine = unit.dot(direction);
    if (1 - cosine * cosine < leastSine * leastSine) return null;
    const away = from.clone().sub(origin);
    return (cosine * away.dot(direction) - away.dot(unit)) / (1 - cosine * cosine) / length;
  }

  /** The place on a sphere, on its far side if `isFar`; beside it, the nearest one. */
  onSphere(spot: Spot, { center, radius }: THREE.Sphere, isFar: boolean): { place: THREE.Vector3; isBeside: boolean } {
    const { origin, direction } = this.ray(spot);
    const nearest = center.clone().sub(origin).dot(direction);
    const middle = origin.clone().addScaledVector(direction, nearest);
    const square = radius * radius - middle.distanceToSquared(center);
    if (square < 0) return { place: middle.sub(center).setLength(radius).add(center), isBeside: true };
    return { place: middle.addScaledVector(direction, (isFar ? 1 : -1) * Math.sqrt(square)), isBeside: false };
  }

  isFartherThan(place: THREE.Vector3, other: THREE.Vector3): boolean {
    return this.depth(place) > this.depth(other);
  }

  /** What is drawn at a spot: the front one of the surfaces and colliders, and where. */
  met(spot: Spot, apartFrom = ""): ReturnType<typeof met> {
    this.aim(spot);
    return met(this.caster, this.others(apartFrom), this.viewer.colliders);
  }

  /** Where a spot is on the surfaces shown. */
  onSurface(spot: Spot, apartFrom: string): THREE.Vector3 | null {
    this.aim(spot);
    return met(this.caster, this.others(apartFrom), [])?.hit.point ?? null;
  }

  /** The vertex that is nearest to a spot: of the face there, or the one that is seen nearest. */
  atVertex(spot: Spot, apartFrom: string): THREE.Vector3 | null {
    this.aim(spot);
    const views = this.others(apartFrom);
    const there = met(this.caster, views, []);
    if (there && "surface" in there.on) return there.on.vertex(vertexAt(there.on, there.hit));
    let best: THREE.Vector3 | null = null;
    let least = Infinity;
    const place = new THREE.Vector3();
    for (const view of views) {
      for (let k = 0; k < view.displacement.length; ++k) {
        const seen = this.seen(view.vertex(k, place));
        if (!seen || between(seen, spot) >= least) continue;
        least = between(seen, spot);
        best = place.clone();
      }
    }
    return best;
  }

  private get camera(): THREE.PerspectiveCamera {
    return this.viewer.stage.camera;
  }

  private others(apartFrom: string): SurfaceView[] {
    return this.viewer.views.filter(({ surface }) => surface.head.name !== apartFrom);
  }

  private depth(place: THREE.Vector3): number {
    return -place.clone().applyMatrix4(this.camera.matrixWorldInverse).z;
  }

  private aim({ x, y }: Spot): void {
    const { width, height } = this.size;
    this.caster.setFromCamera(new THREE.Vector2((x / width) * 2 - 1, 1 - (y / height) * 2), this.camera);
  }

  private ray(spot: Spot): THREE.Ray {
    this.aim(spot);
    return this.caster.ray;
  }
}
