// The time that is shown: a whole frame, or with `isBetween` also between frames.

import { Changing } from "./changing";

export class Playback extends Changing {
  isPlaying = false;
  isLooping = true;
  speed = 1;
  /** Whether the shape is interpolated between frames. */
  isBetween = false;
  /** While it plays, the last frame before one that may not be shown stays. */
  mayShow: (frame: number) => boolean = () => true;
  first = 0;
  last = 0;
  fps = 24;
  private now = 0;
  private lastTick = 0;

  /** Loads a range of frames. The frame shown stays if it is in the range, unless `isNew`. */
  load(first: number, last: number, fps: number, isNew: boolean): void {
    [this.first, this.last, this.fps] = [first, last, fps];
    this.now = isNew ? first : this.clamped(this.now);
    this.tell();
  }

  /** The frame shown. */
  get frame(): number {
    return Math.min(Math.floor(this.now + 1e-9), this.last);
  }

  /** The fraction of the way to the next frame, 0 to 1. */
  get share(): number {
    return this.isBetween && this.now < this.last ? Math.max(this.now - this.frame, 0) : 0;
  }

  get time(): number {
    return this.isBetween ? this.now : this.frame;
  }

  goTo(frame: number): void {
    if (!Number.isFinite(frame)) return;
    this.now = this.clamped(this.isBetween ? frame : Math.round(frame));
    this.tell();
  }

  step(frames: number): void {
    this.pause();
    this.goTo(this.frame + frames);
  }

  play(): void {
    if (this.last === this.first) return;
    if (this.now >= this.last && !this.isLooping) this.now = this.first;
    this.isPlaying = true;
    this.lastTick = performance.now();
    requestAnimationFrame(this.tick);
    this.tell();
  }

  pause(): void {
    this.isPlaying = false;
    this.tell();
  }

  toggle(): void {
    if (this.isPlaying) this.pause();
    else this.play();
  }

  private clamped(frame: number): number {
    return Math.min(Math.max(frame, this.first), this.last);
  }

  // How far on the way to a time all frames may be shown.
  private reached(time: number): number {
    const missing = (frame: number) => !this.mayShow(frame > this.last ? this.first : frame);
    for (let next = this.frame + 1; next <= Math.min(time, this.last + 1); ++next) {
      if ((next <= this.last || this.isLooping) && missing(next)) return Math.max(this.now, next - 1e-6);
    }
    return time;
  }

  // Playback follows the clock: a slow machine drops frames instead of slowing down.
  private readonly tick = (now: number) => {
    if (!this.isPlaying) return;
    const shown = this.time;
    this.now = this.reached(this.now + (Math.max(now - this.lastTick, 0) / 1000) * this.fps * this.speed);
    this.lastTick = now;
    const length = this.last - this.first + 1; // the last frame lasts as long as the others
    if (this.now >= this.last + 1) {
      if (this.isLooping) {
        this.now = this.first + ((this.now - this.first) % length);
      } else {
        this.now = this.last;
        this.isPlaying = false;
      }
    }
    if (this.time !== shown || !this.isPlaying) this.tell();
    if (this.isPlaying) requestAnimationFrame(this.tick);
  };
}
