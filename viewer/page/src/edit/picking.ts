// Selects what is drawn by clicks in the view; drags turn the camera as before.

import * as THREE from "three";

import type { Drawn } from "../gizmos";
import type { Editor } from "./editor";
import { between, fromSegment, Sight, type Spot } from "./sight";

export function mountPicking(editor: Editor): void {
  new Picking(editor);
}

/** A pointer that has moved farther than this turns the camera. [px] */
const farthestClick = 4;
/** How long a finger rests for the menu. [ms] */
const longPress = 550;

class Picking {
  private readonly sight: Sight;
  private pressed: { spot: Spot; event: PointerEvent } | null = null;
  private pending = 0;

  constructor(private readonly editor: Editor) {
    this.sight = new Sight(editor.viewer);
    const { canvas } = editor.viewer.stage;
    canvas.addEventListener("pointerdown", (event) => this.press(event));
    canvas.addEventListener("pointermove", (event) => {
      if (this.pressed && between(this.sight.spotOf(event), this.pressed.spot) >= farthestClick) this.giveUp();
    });
    canvas.addEventListener("pointerup", (event) => this.release(event));
    canvas.addEventListener("pointercancel", () => this.giveUp());
    editor.pick = (event, handleOf) => this.pick(event, this.sight.spotOf(event), handleOf);
  }

  private press(event: PointerEvent): void {
    this.giveUp();
    if (!event.isPrimary) return; // two fingers pan and zoom
    this.pressed = { spot: this.sight.spotOf(event), event };
    if (event.pointerType !== "mouse") this.pending = window.setTimeout(() => this.openMenu(event), longPress);
  }

  private release(event: PointerEvent): void {
    const { pressed } = this;
    this.giveUp();
    if (!pressed || pressed.event.pointerId !== event.pointerId) return;
    if (event.button === 2) return this.openMenu(event);
    if (event.button === 0) this.pick(event, pressed.spot);
  }

  private pick(event: PointerEvent, spot: Spot, handleOf?: string): void {
    const name = this.nameAt(spot, event.pointerType === "mouse" ? 1 : 2, handleOf);
    const { selection } = this.editor;
    const isAdded = event.ctrlKey || event.metaKey;
    if (name !== null) selection.choose(name, isAdded);
    else if (!isAdded) selection.set([]);
  }

  private giveUp(): void {
    clearTimeout(this.pending);
    this.pressed = null;
  }

  private openMenu(event: PointerEvent): void {
    this.giveUp();
    const name = this.nameAt(this.sight.spotOf(event), event.pointerType === "mouse" ? 1 : 2);
    if (name === null) return;
    if (!this.editor.selection.has(name)) this.editor.selection.choose(name, false);
    this.editor.openMenu(name, { left: event.clientX, top: event.clientY, bottom: event.clientY });
  }

  /**
   * The object that is drawn at a spot: a force by its middle or its circles, else what is in front; vast circles come
   * last. The handle of a force is ahead of all but middles, that of a surface behind all.
   */
  private nameAt(spot: Spot, coarseness: number, handleOf?: string): string | null {
    const { viewer, session } = this.editor;
    const forces = viewer.display.hasGizmos ? viewer.drawn().filter(({ name, isShown }) => isShown && session.object(name)) : [];
    const nearest = (distance: (force: Drawn) => number, most: number) => {
      const all = forces.map((force) => ({ force, far: distance(force) })).filter(({ far }) => far <= most * coarseness);
      return all.sort((a, b) => a.far - b.far)[0]?.force.name;
    };
    const met = () => {
      const on = this.sight.met(spot)?.on;
      const name = on && ("surface" in on ? on.surface.head.name : on.collider.head.name);
      return name !== undefined && session.object(name) ? name : undefined;
    };
    return (
      nearest(({ center }) => this.fromPlace(spot, center), 12) ??
      forces.find(({ name }) => name === handleOf)?.name ??
      nearest((force) => this.fromCircles(spot, force, false), 5) ??
      met() ??
      nearest((force) => this.fromCircles(spot, force, true), 5) ??
      handleOf ??
      null
    );
  }

  private fromPlace(spot: Spot, place: THREE.Vector3): number {
    const seen = this.sight.seen(place);
    return seen ? between(seen, spot) : Infinity;
  }

  private fromCircles(spot: Spot, { circles, isVast }: Drawn, areVast: boolean): number {
    let least = Infinity;
    const place = new THREE.Vector3();
    for (const each of circles.filter((one) => isVast(one) === areVast)) {
      const { ends } = each.geometry;
      const seen = (k: number) => this.sight.seen(place.fromArray(ends, k).applyMatrix4(each.matrixWorld));
      for (let k = 0; k < ends.length; k += 6) {
        const [a, b] = [seen(k), seen(k + 3)];
        if (a && b) least = Math.min(least, fromSegment(spot, a, b));
      }
    }
    return least;
  }
}
