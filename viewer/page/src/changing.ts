/** What tells its listeners of a change. */
export class Changing<Told extends unknown[] = []> {
  private readonly listeners: ((...told: Told) => void)[] = [];

  onChange(listener: (...told: Told) => void): void {
    this.listeners.push(listener);
  }

  protected tell(...told: Told): void {
    for (const listener of this.listeners) listener(...told);
  }
}
