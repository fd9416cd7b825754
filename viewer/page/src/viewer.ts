// A bake on a stage: surfaces, gizmos and regions at the present frame.

import * as THREE from "three";

import { at, type Bake, type Vector } from "./bake";
import { ForceChoice } from "./force_choice";
import { Gizmos } from "./gizmos";
import type { Label } from "./labels";
import { Playback } from "./playback";
import { RegionView } from "./region_view";
import { Stage } from "./stage";
import { SurfaceView, type Colour, type Style } from "./surface_view";
import type { ThemeChoice } from "./theme";

export interface Display {
  style: Style;
  colour: Colour;
  hasGizmos: boolean;
  hasRegions: boolean;
  hasBoxes: boolean;
  hasLabels: boolean;
  hasLegend: boolean;
  /** The number of the top colour; null: the largest number of the animation. */
  peak: number | null;
}

export class Viewer {
  readonly playback = new Playback();
  readonly stage: Stage;
  readonly display: Display = { style: "shaded", colour: "displacement", hasGizmos: true, hasRegions: true, hasBoxes: true, hasLabels: true, hasLegend: true, peak: null };
  readonly forces = new ForceChoice();
  bake: Bake | null = null;
  views: SurfaceView[] = [];
  private regions: RegionView[] = [];
  private gizmos: Gizmos | null = null;

  constructor(
    canvas: HTMLCanvasElement,
    private readonly themes: ThemeChoice,
  ) {
    this.stage = new Stage(canvas);
    this.playback.onChange(() => this.show());
    themes.onChange(() => this.redress());
    this.forces.onChange(() => this.show());
  }

  /** Replaces the bake; camera and frame stay if there was one before. */
  load(bake: Bake): void {
    const isNew = this.bake === null;
    this.clear();
    this.bake = bake;
    const { head } = bake;
    this.views = bake.surfaces.map((surface) => new SurfaceView(surface, head.fps));
    this.regions = this.views.map((view) => new RegionView(view));
    const box = boxOf(bake);
    this.gizmos = new Gizmos(head.forces, box.getSize(new THREE.Vector3()).length(), box.getCenter(new THREE.Vector3()));
    this.stage.scene.add(...this.views.map((view) => view.group), this.gizmos.group);
    this.stage.bound(box);
    if (isNew) this.stage.look();
    this.playback.load(head.first, head.last, head.fps, isNew);
    this.redress();
  }

  /** The number of the top colour. */
  peak(): number {
    const { colour, peak } = this.display;
    if (peak !== null) return peak;
    const heads = this.bake?.head.surfaces ?? [];
    return Math.max(0, ...heads.map((head) => (colour === "velocity" ? head.peakSpeed : head.peakDisplacement)));
  }

  /** Names of the forces that are drawn now. */
  labels(): Label[] {
    const { display } = this;
    if (!this.bake || !display.hasLabels || !display.hasGizmos) return [];
    return this.gizmos?.labels(this.playback.frame - this.bake.head.first) ?? [];
  }

  /** Call after `display` or the theme has changed. */
  redress(): void {
    const { palette } = this.themes;
    this.stage.colour(palette);
    for (const view of this.views) view.dress(this.display.style, palette);
    for (const region of this.regions) region.colour(palette);
    this.gizmos?.colour(palette);
    this.show();
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
      view.paint(display.colour, this.peak());
      this.regions[k].show(playback.frame, display.hasRegions, display.hasBoxes, isIdle, isShown);
      for (const { force, push } of view.surface.marksAt(playback.frame)?.forces ?? []) {
        if (push) pushes.set(force, push);
      }
    });
    this.gizmos.group.visible = display.hasGizmos;
    this.gizmos.show(index, playback.share, isShown, pushes);
    this.stage.invalidate();
  }

  private clear(): void {
    for (const view of this.views) {
      this.stage.scene.remove(view.group);
      view.dispose();
    }
    for (const region of this.regions) region.dispose();
    if (this.gizmos) {
      this.stage.scene.remove(this.gizmos.group);
      this.gizmos.dispose();
    }
  }
}

/** The box around the surfaces over all frames, and the forces near them. */
function boxOf(bake: Bake): THREE.Box3 {
  const box = new THREE.Box3();
  for (const { low, high } of bake.head.surfaces) box.expandByPoint(new THREE.Vector3(...low)).expandByPoint(new THREE.Vector3(...high));
  const surfaces = box.clone();
  const reach = surfaces.getSize(new THREE.Vector3()).length();
  for (const force of bake.head.forces) {
    const radius = Math.max(0, ...(force.deformationRadius ?? []), ...(force.forceRadius ?? []));
    for (const place of [...(force.center ?? []), ...(force.from ?? []), ...(force.to ?? [])]) {
      // A force that is far away or large must not make the rest small.
      const point = new THREE.Vector3(...place);
      if (surfaces.distanceToPoint(point) > 0.5 * reach) continue;
      const room = Math.min(0.7 * radius, 0.2 * reach);
      box.union(new THREE.Box3().setFromCenterAndSize(point, new THREE.Vector3().setScalar(2 * room)));
    }
  }
  if (box.isEmpty()) box.set(new THREE.Vector3(-1, -1, -1), new THREE.Vector3(1, 1, 1));
  return box;
}
