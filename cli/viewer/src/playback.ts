// The time that is shown: frames, whole ones unless asked for more.

export class Playback {
  isPlaying = false;
  isLooping = true;
  speed = 1;
  /** Whether the shape goes on between frames. */
  isBetween = false;
  first = 0;
  last = 0;
  fps = 24;
  private now = 0;
  private lastTick = 0;
  private readonly listeners: (() => void)[] = [];

  /** Takes another run of frames; the frame shown stays where it can. */
  load(first: number, last: number, fps: number, isNew: boolean): void {
    [this.first, this.last, this.fps] = [first, last, fps];
    this.now = isNew ? first : this.clamped(this.now);
    this.tell();
  }

  /** The frame shown. */
  get frame(): number {
    return Math.min(Math.floor(this.now + 1e-9), this.last);
  }

  /** How far it is to the next one, 0 to 1. */
  get share(): number {
    return this.isBetween && this.now < this.last ? Math.max(this.now - this.frame, 0) : 0;
  }

  get time(): number {
    return this.isBetween ? this.now : this.frame;
  }

  onChange(listener: () => void): void {
    this.listeners.push(listener);
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

  // Frames go by the clock: a slow machine leaves some out instead of going slow.
  private readonly tick = (now: number) => {
    if (!this.isPlaying) return;
    const shown = this.time;
    this.now += (Math.max(now - this.lastTick, 0) / 1000) * this.fps * this.speed;
    this.lastTick = now;
    const length = this.last - this.first + 1; // the last frame lasts as long as any
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

  private tell(): void {
    for (const listener of this.listeners) listener();
  }
}
