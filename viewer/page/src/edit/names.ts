// Names for what is made.

import type { Session } from "./session";

/** Gives names that no object has, and none twice: each is the one wanted, or that with another number at its end. */
export function freeNames({ objects }: Session): (wanted: string) => string {
  const taken = new Set(objects.map(({ name }) => name));
  return (wanted) => {
    const [, stem, digits] = /^(.*?)(\d*)$/s.exec(wanted)!;
    for (let number = Number(digits || 1); ; ++number) {
      const name = number === 1 && digits === "" ? wanted : `${stem}${number}`;
      if (taken.has(name)) continue;
      taken.add(name);
      return name;
    }
  };
}
