// The map from frames to horizontal positions, shared by the timeline and the curves above it.

import type { Playback } from "./playback";

/**
 * Margin at both ends of the timeline, so that the marks of the first and last frame are not cut.
 * [px]
 */
const margin = 16;

export class FrameAxis {
  constructor(
    private readonly timeline: HTMLElement,
    private readonly playback: Playback,
  ) {}

  /** Distance between two consecutive frames. [CSS px] */
  get perFrame(): number {
    const [left, right] = this.ends();
    return (right - left) / this.length;
  }

  /** Position of a frame, from the left side of `place`, which may be any element. [CSS px] */
  x(frame: number, place: HTMLElement): number {
    const [left] = this.ends();
    return left + (frame - this.playback.first) * this.perFrame - place.getBoundingClientRect().left;
  }

  /**
   * The frame at a position in the window; it may be fractional and outside the range of frames.
   */
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
