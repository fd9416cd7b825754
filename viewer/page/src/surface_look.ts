// Shading and colours of a surface's vertices.

import * as THREE from "three";

import type { Ramp } from "./ramp";

/** The factor by which a bend brightens a ridge and darkens a valley. */
const reliefShare = 0.35;

/** Multiplies colours by 1 + the share of the vertex's `relief`. */
function showRelief(material: THREE.MeshStandardMaterial): void {
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "attribute float relief;\nvarying float vRelief;\n#include <common>")
      .replace("#include <begin_vertex>", "vRelief = relief;\n#include <begin_vertex>");
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", "varying float vRelief;\n#include <common>")
      // A ridge on the front is a valley on the back.
      .replace("#include <color_fragment>", `#include <color_fragment>\ndiffuseColor.rgb *= 1.0 + ${reliefShare.toFixed(2)} * (gl_FrontFacing ? vRelief : -vRelief);`);
  };
}

/** The longest side of the box around the positions. */
export function sizeOf(positions: Float32Array): number {
  const box = new THREE.Box3().setFromArray(positions as unknown as number[]);
  const { x, y, z } = box.getSize(new THREE.Vector3());
  return Math.max(x, y, z);
}

/** The mean length of edges, each given by its two points. */
export function meanLength(positions: Float32Array, edges: Uint32Array): number {
  let sum = 0;
  for (let k = 0; k < edges.length; k += 2) {
    const [a, b] = [3 * edges[k], 3 * edges[k + 1]];
    sum += Math.hypot(positions[b] - positions[a], positions[b + 1] - positions[a + 1], positions[b + 2] - positions[a + 2]);
  }
  return sum / Math.max(edges.length / 2, 1);
}

/** For geometries with the attributes `color` and `relief`. */
export function surfaceMaterial(): THREE.MeshStandardMaterial {
  const material = new THREE.MeshStandardMaterial({
    vertexColors: true, side: THREE.DoubleSide, roughness: 0.7, metalness: 0,
    polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
  });
  showRelief(material);
  return material;
}

/** Discs of a few pixels, nearer by a hundredth of their distance, so that the surface does not hide them. `turn` changes the shader. */
function discs(turn: (shader: THREE.WebGLProgramParametersWithUniforms) => void = () => {}): THREE.PointsMaterial {
  const material = new THREE.PointsMaterial({ size: 7, sizeAttenuation: false });
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader.replace("#include <project_vertex>", "#include <project_vertex>\ngl_Position = projectionMatrix * vec4(0.99 * mvPosition.xyz, 1.0);");
    shader.fragmentShader = shader.fragmentShader.replace(
      "#include <color_fragment>",
      "if (length(gl_PointCoord - 0.5) > 0.5) discard;\n#include <color_fragment>",
    );
    turn(shader);
  };
  material.customProgramCacheKey = () => turn.toString();
  return material;
}

export const pinMaterial = (): THREE.PointsMaterial => discs();

/** Discs with a rim that do not cover each other on vertices which are `spacing` apart, object space. */
export function dotMaterial(spacing: number, rim: THREE.Color): THREE.PointsMaterial {
  return discs((shader) => {
    Object.assign(shader.uniforms, { spacing: { value: spacing }, rim: { value: rim } });
    shader.vertexShader = `uniform float spacing;\n${shader.vertexShader}`.replace(
      "gl_PointSize = size;",
      // `scale` is half the height of the picture, in pixels of which 7 are `size`.
      `float grown = max(length(modelViewMatrix[0].xyz), max(length(modelViewMatrix[1].xyz), length(modelViewMatrix[2].xyz)));
      gl_PointSize = size / 7.0 * clamp(0.85 * spacing * grown * projectionMatrix[1][1] / gl_Position.w * scale, 4.5, 8.0);`,
    );
    shader.fragmentShader = `uniform vec3 rim;\n${shader.fragmentShader}`.replace(
      "#include <color_fragment>",
      "if (length(gl_PointCoord - 0.5) > 0.36) diffuseColor.rgb = rim;\n#include <color_fragment>",
    );
  });
}

/** Colours of a ramp for the vertices' numbers; `low` has the bottom colour, `high` the top one. */
export function paintNumbers(numbers: Float32Array, low: number, high: number, ramp: Ramp, colours: Float32Array): void {
  const { colours: shades } = ramp;
  const scale = high > low ? 255 / (high - low) : 0;
  for (let vertex = 0; vertex < numbers.length; ++vertex) {
    const shade = Math.min(Math.max(Math.round(scale * (numbers[vertex] - low)), 0), 255);
    colours[3 * vertex] = shades[3 * shade];
    colours[3 * vertex + 1] = shades[3 * shade + 1];
    colours[3 * vertex + 2] = shades[3 * shade + 2];
  }
}

/** A normal is the normalised sum of the area vectors of the triangles around its vertex. */
export function turnNormals(p: Float32Array, triangles: Uint32Array, n: Float32Array): void {
  n.fill(0);
  for (let k = 0; k < triangles.length; k += 3) {
    const a = 3 * triangles[k];
    const b = 3 * triangles[k + 1];
    const c = 3 * triangles[k + 2];
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    n[a] += x; n[a + 1] += y; n[a + 2] += z;
    n[b] += x; n[b + 1] += y; n[b + 2] += z;
    n[c] += x; n[c + 1] += y; n[c + 2] += z;
  }
  for (let k = 0; k < n.length; k += 3) {
    const length = Math.hypot(n[k], n[k + 1], n[k + 2]) || 1;
    n[k] /= length; n[k + 1] /= length; n[k + 2] /= length;
  }
}
