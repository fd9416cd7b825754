// A page from `pliant view --serve`: notified of every save, it fetches the new bake.

import type { Bake, Message } from "./bake";
import { unpack } from "./bake";

export type LiveStatus = "working" | "failed" | "baked";

export interface LiveListener {
  /** A new bake has arrived. */
  baked(bake: Bake): void;
  /** What the command does or did last; `messages`: why the last bake failed, or none. */
  told(status: LiveStatus, messages: Message[]): void;
  /** The command cannot be reached. */
  lost(): void;
}

export async function fetchPacked(): Promise<Uint8Array<ArrayBuffer>> {
  const response = await fetch("bake", { cache: "no-store" });
  if (!response.ok) throw new Error(`the server answered ${response.status}`);
  return new Uint8Array(await response.arrayBuffer());
}

async function fetchBake(): Promise<Bake> {
  return unpack(await fetchPacked());
}

/** Waits until the command has baked. */
export function firstBake(): Promise<Bake> {
  return new Promise((resolve, reject) => {
    const events = new EventSource("events");
    events.addEventListener("baked", () => {
      events.close();
      fetchBake().then(resolve, reject);
    });
  });
}

/** Each event has the whole state: the number of the last sound bake, 0 for none, and messages. */
interface LiveState {
  status: LiveStatus;
  bake: number;
  messages: Message[];
}

export function follow(listener: LiveListener): void {
  const events = new EventSource("events");
  let next: LiveState | null = null;
  let shown = 0;
  let isShowing = false;
  let isLost = false;
  const tell = (status: LiveStatus, messages: Message[]) => isLost || listener.told(status, messages);
  const show = async ({ status, bake, messages }: LiveState) => {
    try {
      if (bake !== shown) listener.baked(await fetchBake());
      shown = bake;
      tell(status, messages);
    } catch (error) {
      tell("failed", [{ kind: "error", line: 0, text: (error as Error).message }]);
    }
  };
  // One after the other: a bake that takes long to arrive is not shown over what was told since.
  const showAll = async () => {
    if (isShowing) return;
    isShowing = true;
    for (let state; (state = next); ) {
      next = null;
      await show(state);
    }
    isShowing = false;
  };
  for (const status of ["working", "failed", "baked"] as const) {
    events.addEventListener(status, (event) => {
      next = { status, ...(JSON.parse((event as MessageEvent<string>).data) as Omit<LiveState, "status">) };
      isLost = false;
      void showAll();
    });
  }
  events.addEventListener("error", () => {
    isLost = true;
    listener.lost();
  });
}
