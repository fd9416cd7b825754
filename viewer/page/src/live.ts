// A page from `pliant view --serve`: notified of every save, it fetches the new bake.

import type { Bake, Message } from "./bake";
import { unpack } from "./bake";

export interface LiveListener {
  baked(bake: Bake): void;
  failed(messages: Message[]): void;
  working(): void;
  /** Whether the command is reachable. */
  connected(isConnected: boolean): void;
}

export async function fetchPacked(): Promise<Uint8Array<ArrayBuffer>> {
  const response = await fetch("bake", { cache: "no-store" });
  if (!response.ok) throw new Error(`the server answered ${response.status}`);
  return new Uint8Array(await response.arrayBuffer());
}

export async function fetchBake(): Promise<Bake> {
  return unpack(await fetchPacked());
}

export function follow(listener: LiveListener): void {
  const events = new EventSource("events");
  let shown = 0;
  events.addEventListener("open", () => listener.connected(true));
  events.addEventListener("error", () => listener.connected(false));
  events.addEventListener("working", () => listener.working());
  events.addEventListener("failed", (event) => listener.failed(JSON.parse((event as MessageEvent<string>).data) as Message[]));
  events.addEventListener("baked", (event) => {
    const number = Number((event as MessageEvent<string>).data);
    if (number === shown) return; // repeated after a broken connection
    shown = number;
    fetchBake().then(
      (bake) => listener.baked(bake),
      (error: Error) => listener.failed([{ kind: "error", line: 0, text: error.message }]),
    );
  });
}
