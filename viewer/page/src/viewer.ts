// A bake on a stage: surfaces, colliders, gizmos and regions at the present frame.

import * as THREE from "three";

import { at, matrixBetween, type BakedCollider, type Force, type ShownBake, type Vector } from "./bake";
import { ColliderView } from "./collider_view";
import { ForceChoice } from "./force_choice";
import { Gizmos, type Drawn } from "./gizmos";
import type { Label } from "./labels";
import { Playback } from "./playback";
import { RegionView } from "./region_view";
import { Stage } from "./stage";
import { SurfaceView, type Colour, type Ends, type Style } from "./surface_view";
import type { ThemeChoice } from "./theme";

export interface Display {
  style: Style;
  colour: Colour;
  hasGizmos: boolean;
  hasRegions: boolean;
  hasBoxes: boolean;
  hasColliders: boolean;
  hasLabels: boolean;
  hasLegend: boolean;
  /** In pictures. */
  hasCaption: boolean;
  /** The number of the top colour; null: the largest number of the animation. */
  peak: number | null;
}

export class Viewer {
  readonly playback = new Playback();
  readonly stage: Stage;
  readonly display: Display = { style: "shaded", colour: "displacement", hasGizmos: true, hasRegions: true, hasBoxes: true, hasColliders: true, hasLabels: true, hasLegend: true, hasCaption: true, peak: null };
  readonly forces = new ForceChoice();
  bake: ShownBake | null = null;
  views: SurfaceView[] = [];
  colliders: ColliderView[] = [];
  /** The size of the scene: the diagonal of the box around its surfaces. */
  reach = 1;
  private regions: RegionView[] = [];
  private readonly outdated: { dispose(): void }[] = [];
  private bounds = new THREE.Box3();
  private gizmos: Gizmos | null = null;

  constructor(
    canvas: HTMLCanvasElement,
    private readonly themes: ThemeChoice,
  ) {
    this.stage = new Stage(canvas);
    this.stage.onDraw(() => {
      for (const each of this.outdated.splice(0)) each.dispose();
    });
    this.playback.onChange(() => this.show());
    themes.onChange(() => this.redress());
    this.forces.onChange(() => {
      this.aim();
      this.show();
    });
    this.redress(); // an empty stage has the colours of the theme too
  }

  /** Replaces the bake; camera, frame and colours stay if there was one before. */
  load(bake: ShownBake): void {
    const isNew = this.bake === null;
    const kept = this.views.filter((view) => bake.surfaces.includes(view.surface));
    const keptRegions = this.regions.filter(({ view }) => kept.includes(view));
    this.clear(kept);
    this.bake = bake;
    const { head } = bake;
    this.views = bake.surfaces.map((surface) => kept.find((view) => view.surface === surface) ?? new SurfaceView(surface, head.fps));
    this.regions = this.views.map((view) => keptRegions.find((region) => region.view === view) ?? new RegionView(view));
    const box = boxOf(bake, () => true, () => true);
    const [reach, middle] = [(this.reach = box.getSize(new THREE.Vector3()).length()), box.getCenter(new THREE.Vector3())];
    this.gizmos = new Gizmos(head.forces, reach, middle);
    this.colliders = bake.colliders.map((collider) => new ColliderView(collider, reach, middle));
    this.stage.scene.add(...[...this.views, ...this.colliders].map((view) => view.group), this.gizmos.group);
    if (isNew || !isAbout(this.bounds, box)) this.stage.bound((this.bounds = box));
    if (isNew && this.goesBothWays()) this.display.colour = "signed";
    this.aim();
    if (isNew) this.stage.look();
    this.playback.load(head.first, head.last, head.fps, isNew);
    this.redress();
  }

  /** The numbers at the ends of the colours. */
  ends(): Ends {
    const { colour, peak } = this.display;
    const heads = this.bake?.head.surfaces ?? [];
    const high = peak ?? Math.max(0, ...heads.map((head) => (colour === "velocity" ? head.peakSpeed : head.peakDisplacement)));
    return { low: colour === "signed" ? -high : 0, high };
  }

  /** The largest displacement of all surfaces at the present frame. */
  displaced(): number {
    return this.bake?.head.displaced?.[this.playback.frame - this.bake.head.first] ?? 0;
  }

  /** What is drawn of the forces; `isShown` is not about `display`. */
  drawn(): Drawn[] {
    return this.gizmos?.drawn ?? [];
  }

  drawnOf(name: string): Drawn | undefined {
    return this.gizmos?.drawnOf(name);
  }

  /** Names of the forces and colliders that are drawn now. */
  labels(): Label[] {
    const { display } = this;
    if (!this.bake || !this.gizmos || !display.hasLabels) return [];
    const forces = display.hasGizmos ? this.gizmos.labels(this.playback.frame - this.bake.head.first) : [];
    return [...forces, ...this.colliders.map((view) => view.label()).filter((label) => label !== null)];
  }

  /** Call after `display` or the theme has changed. */
  redress(): void {
    const { palette } = this.themes;
    this.stage.colour(palette);
    for (const view of this.views) view.dress(this.display.style, palette);
    for (const region of this.regions) region.colour(palette);
    for (const collider of this.colliders) collider.colour(palette);
    this.gizmos?.colour(palette);
    this.aim();
    this.show();
  }

  /** Call after frames have changed. */
  redraw(): void {
    this.show();
  }

  /** Whether the surfaces are displaced along their normals and against them, each by a tenth of the peak at least. */
  private goesBothWays(): boolean {
    const { head, frameCount } = this.bake!;
    const least = 0.1 * Math.max(0, ...head.surfaces.map(({ peakDisplacement }) => peakDisplacement));
    const ends = this.views.map((view) => view.farthest(frameCount));
    return least > 0 && Math.max(...ends.map(({ high }) => high)) >= least && Math.min(...ends.map(({ low }) => low)) <= -least;
  }

  // The camera frames what is drawn.
  private aim(): void {
    const { bake, display, forces } = this;
    if (!bake) return;
    this.stage.aim = boxOf(bake, (force) => display.hasGizmos && forces.isShown(force), ({ head }) => display.hasColliders && forces.isShown(head));
  }

  private show(): void {
    if (!this.bake || !this.gizmos) return;
    const { playback, display } = this;
    const index = playback.frame - this.bake.head.first;
    const pushes = new Map<number, Vector>();
    const isIdle = this.bake.head.forces.map(({ magnitude }) => magnitude !== undefined && at(magnitude, index) === 0);
    const isShown = this.bake.head.forces.map((force) => this.forces.isShown(force));
    this.views.forEach((view, k) => {
      view.show(index, playback.share);
      view.paint(display.colour, this.ends());
      view.pins.visible = display.hasGizmos && view.surface.pins.length > 0;
      view.dots.visible = display.hasColliders && view.dots.geometry.drawRange.count > 0;
      this.regions[k].show(playback.frame, display.hasRegions, display.hasBoxes, isIdle, isShown);
      for (const { force, push } of view.surface.marksAt(playback.frame)?.forces ?? []) {
        if (push) pushes.set(force, push);
      }
    });
    for (const view of this.colliders) view.show(index, playback.share, display.hasColliders && this.forces.isShown(view.collider.head));
    this.gizmos.group.visible = display.hasGizmos;
    this.gizmos.show(index, playback.share, isShown, pushes, ({ targets }, center, radius, count) => {
      const pushed = this.views.filter(({ surface }) => targets.length === 0 || targets.includes(surface.head.name));
      return pushed.flatMap((view) => view.feet(center, radius, Math.ceil(count / pushed.length))).slice(0, count);
    });
    this.stage.invalidate();
  }

  // Removes everything but some surfaces. What was drawn is kept until its successors are: until then the programs of
  // their materials are used, and need not be compiled anew.
  private clear(kept: SurfaceView[]): void {
    const views = [...this.views.filter((each) => !kept.includes(each)), ...this.colliders];
    for (const view of views) this.stage.scene.remove(view.group);
    if (this.gizmos) this.stage.scene.remove(this.gizmos.group);
    this.outdated.push(...views, ...this.regions.filter(({ view }) => !kept.includes(view)), ...(this.gizmos ? [this.gizmos] : []));
  }
}

/** Whether the floor and the limits of the camera may stay as they are for another box. */
function isAbout(bounds: THREE.Box3, box: THREE.Box3): boolean {
  const [reach, size] = [bounds, box].map((each) => each.getSize(new THREE.Vector3()).length());
  return bounds.clone().expandByScalar(0.25 * reach).containsBox(box) && size > 0.5 * reach;
}

/**
 * The box around the surfaces over all frames, around those forces that are shown, near the surfaces, and not about the
 * whole of them, and around the parts of solids near the surfaces.
 */
function boxOf(bake: ShownBake, isShown: (force: Force) => boolean, isThere: (collider: BakedCollider) => boolean): THREE.Box3 {
  const box = new THREE.Box3();
  for (const { low, high } of bake.head.surfaces) box.expandByPoint(new THREE.Vector3(...low)).expandByPoint(new THREE.Vector3(...high));
  const reach = box.getSize(new THREE.Vector3()).length();
  // A force that is far away or large must not make the surfaces small.
  const room = box.clone().expandByScalar(0.25 * reach);
  for (const force of bake.head.forces.filter(isShown)) {
    const radii = [force.deformationRadius, force.forceRadius].flatMap((track) => (track ? [track] : []));
    const places = [force.center, force.from, force.to].flatMap((track) => (track ? [track] : []));
    const count = Math.max(...[force.enabled, ...radii, ...places].map((track) => track.length));
    for (let index = 0; index < count; ++index) {
      if (!at(force.enabled, index)) continue;
      const radius = Math.max(0, ...radii.map((track) => at(track, index)));
      if (radius > 0.5 * reach) continue;
      for (const track of places) {
        const point = new THREE.Vector3(...at(track, index));
        if (!room.containsPoint(point)) continue;
        box.union(new THREE.Box3().setFromCenterAndSize(point, new THREE.Vector3().setScalar(2 * Math.min(0.7 * radius, 0.2 * reach))).intersect(room));
      }
    }
  }
  for (const collider of bake.colliders.filter(isThere)) {
    const { enabled, transforms } = collider.head;
    for (let index = 0; index < bake.frameCount && collider.points.length > 0; ++index) {
      if (at(enabled, index)) box.union(collider.boxAt(index).applyMatrix4(matrixBetween(transforms, index, 0, new THREE.Matrix4())).intersect(room));
    }
  }
  if (box.isEmpty()) box.set(new THREE.Vector3(-1, -1, -1), new THREE.Vector3(1, 1, 1));
  return box;
}
