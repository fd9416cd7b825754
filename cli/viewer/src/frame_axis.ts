// Where frames stand between left and right: one map for the timeline and for the curves above it.

import type { Playback } from "./playback";

/** Of the timeline: room at both ends, so that the marks of the outermost frames are whole. [px] */
const margin = 16;

export class FrameAxis {
  constructor(
    private readonly timeline: HTMLElement,
    private readonly playback: Playback,
  ) {}

  /** How far a frame is from another, one later. [CSS px] */
  get perFrame(): number {
    const [left, right] = this.ends();
    return (right - left) / this.length;
  }

  /** Where a frame stands, from the left side of `place`, which may be any element. [CSS px] */
  x(frame: number, place: HTMLElement): number {
    const [left] = this.ends();
    return left + (frame - this.playback.first) * this.perFrame - place.getBoundingClientRect().left;
  }

  /** The frame at a place of the window, between whole ones too, and beyond the ends. */
  frameAt(clientX: number): number {
    const [left] = this.ends();
    return this.playback.first + (clientX - left) / this.perFrame;
  }

  private get length(): number {
    return Math.max(this.playback.last - this.playback.first, 1);
  }

  private ends(): [number, number] {
    const box = this.timeline.getBoundingClientRect();
    return [box.left + margin, Math.max(box.right - margin, box.left + margin + 1)];
  }
}
