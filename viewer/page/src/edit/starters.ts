// What a scene can begin with: the answer to `starters`.

import type { Session } from "./session";

export interface Named {
  name: string;
  summary: string;
}

export interface Starters {
  starters: Named[];
  materials: Named[];
  /** Files below the folder, newest first. */
  scenes: string[];
  meshes: string[];
}

export function readStarters({ requests }: Session): Promise<Starters> {
  return requests.json<Starters>("starters");
}
