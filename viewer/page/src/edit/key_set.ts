// Keys that are chosen: of which channels, at which frames, and which components of their values.

import type { Channel } from "../bake";
import type { Editor } from "./editor";
import type { Operation } from "./session";

/** Keys of one channel, as operations name them. */
export interface KeysOf {
  channel: string;
  frames: number[];
}

/** A key as the curve of a component has it. */
export interface KeyPlace {
  path: string;
  frame: number;
  /** Which number of the value, from 0. */
  part: number;
}

export class KeySet {
  /** Of each channel the parts of each frame, as bits. */
  private readonly masks = new Map<string, Map<number, number>>();

  has({ path, frame, part }: KeyPlace): boolean {
    return ((this.masks.get(path)?.get(frame) ?? 0) & (1 << part)) !== 0;
  }

  add({ path, frame, part }: KeyPlace): void {
    this.put(path, frame, 1 << part);
  }

  delete({ path, frame, part }: KeyPlace): void {
    const frames = this.masks.get(path);
    const mask = (frames?.get(frame) ?? 0) & ~(1 << part);
    if (mask !== 0) frames!.set(frame, mask);
    else frames?.delete(frame);
    if (frames?.size === 0) this.masks.delete(path);
  }

  get isEmpty(): boolean {
    return this.masks.size === 0;
  }

  get paths(): string[] {
    return [...this.masks.keys()];
  }

  framesOf(path: string): Map<number, number> {
    return this.masks.get(path) ?? new Map();
  }

  get keys(): KeysOf[] {
    return [...this.masks].map(([channel, frames]) => ({ channel, frames: [...frames.keys()].sort((a, b) => a - b) }));
  }

  get places(): KeyPlace[] {
    return [...this.masks].flatMap(([path, frames]) => [...frames].flatMap(([frame, mask]) => partsOf(mask).map((part) => ({ path, frame, part }))));
  }

  /** The keys by the parts that are chosen of them. */
  get byParts(): { parts: number[]; keys: KeysOf[] }[] {
    const groups = new Map<number, KeySet>();
    for (const [path, frames] of this.masks) {
      for (const [frame, mask] of frames) {
        if (!groups.has(mask)) groups.set(mask, new KeySet());
        groups.get(mask)!.put(path, frame, mask);
      }
    }
    return [...groups].map(([mask, set]) => ({ parts: partsOf(mask), keys: set.keys }));
  }

  copy(): KeySet {
    return this.at((frame) => frame);
  }

  /** The same keys at other frames. */
  at(frameOf: (frame: number, path: string) => number): KeySet {
    const moved = new KeySet();
    for (const [path, frames] of this.masks) for (const [frame, mask] of frames) moved.put(path, frameOf(frame, path), mask);
    return moved;
  }

  /** Those that these channels have. */
  of(channels: Channel[]): KeySet {
    const left = new KeySet();
    for (const { path, keys } of channels) {
      const frames = this.masks.get(path);
      if (frames) for (const { at } of keys) if (frames.has(at[0])) left.put(path, at[0], frames.get(at[0])!);
    }
    return left;
  }

  private put(path: string, frame: number, mask: number): void {
    if (!this.masks.has(path)) this.masks.set(path, new Map());
    const frames = this.masks.get(path)!;
    frames.set(frame, (frames.get(frame) ?? 0) | mask);
  }
}

const partsOf = (mask: number) => [0, 1, 2].filter((part) => (mask & (1 << part)) !== 0);

export const readOnly = "These keys stand in another file, and cannot be changed here";

/** What of these keys stands in the file that is edited. */
export function writable(editor: Editor, keys: KeysOf[]): KeysOf[] {
  return keys.filter(({ channel }) => {
    const owner = editor.session.objects.find(({ name }) => channel.startsWith(`${name}.`));
    return !owner || editor.canChange(owner);
  });
}

/** Takes keys away. A channel of which no key would be left becomes a constant. */
export async function deleteKeys(editor: Editor, keys: KeysOf[]): Promise<void> {
  const chosen = writable(editor, keys);
  const isWhole = ({ channel, frames }: KeysOf) => editor.keysOf(channel).length === frames.length;
  const some = chosen.filter((each) => !isWhole(each));
  const operations: Operation[] = some.length > 0 ? [{ op: "deleteKeys", keys: some }] : [];
  const whole = chosen.filter(isWhole);
  for (const { channel, frames } of whole) operations.push({ op: "freeze", channels: [channel], frame: frames[0] });
  await editor.apply(operations, operations.length > 1 ? "delete keys" : undefined);
}
