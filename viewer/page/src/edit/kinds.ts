// The kinds of things that can be added to a scene, as the format has them.

import type { Format } from "./session";

/** A name as a title. */
export const titleOf = (name: string) => name[0].toUpperCase() + name.slice(1);

const usualForces = ["point", "radial", "line", "uniform", "vortex", "noise", "inertia", "group"];
/** Shapes of surfaces with which one can begin. */
const surfaceShapes = ["grid", "mesh"];

export function kindsToAdd({ elements }: Format): { title: string; kinds: string[] }[] {
  const shapesOf = (name: string) => elements.find((each) => each.name === name)?.children.find(({ part }) => !part)?.names ?? [];
  const forces = elements[0].children.flatMap(({ names }) => names).filter((name) => name !== "surface" && name !== "collider" && elements.some((each) => each.name === name));
  return [
    { title: "Forces", kinds: usualForces.filter((name) => forces.includes(name)) },
    { title: "Surfaces", kinds: shapesOf("surface").filter((name) => surfaceShapes.includes(name)) },
    { title: "More forces", kinds: forces.filter((name) => !usualForces.includes(name)) },
    { title: "Colliders", kinds: shapesOf("collider").filter((name) => !surfaceShapes.includes(name)) },
  ].filter(({ kinds }) => kinds.length > 0);
}
