// The bend of a surface at each vertex, for a shading that shows relief where light alone does not.

/**
 * Bends of a surface whose size is `size`, -1 to 1: below 0 in a valley, above 0 on a ridge.
 * `edges` are pairs of vertices, `p` positions, `n` unit normals.
 *
 * Along an edge d = p_b - p_a the normal curvature is (n_b - n_a) · d / |d|². The mean over a
 * vertex's edges, times the size, is a number without a unit. A radius of a sixth of the size gives
 * half of the full effect: enough for a bulge of a tenth of a sheet, without turning the ripples of
 * rain black.
 */
export function bends(p: Float32Array, n: Float32Array, edges: Uint32Array, size: number, out: Float32Array, counts: Uint8Array): void {
  out.fill(0);
  counts.fill(0);
  for (let k = 0; k < edges.length; k += 2) {
    const [i, j] = [edges[k], edges[k + 1]];
    const [a, b] = [3 * i, 3 * j];
    const dx = p[b] - p[a], dy = p[b + 1] - p[a + 1], dz = p[b + 2] - p[a + 2];
    const length = dx * dx + dy * dy + dz * dz;
    if (length === 0) continue;
    const bend = ((n[b] - n[a]) * dx + (n[b + 1] - n[a + 1]) * dy + (n[b + 2] - n[a + 2]) * dz) / length;
    out[i] += bend;
    out[j] += bend;
    ++counts[i];
    ++counts[j];
  }
  for (let k = 0; k < out.length; ++k) {
    const bend = counts[k] > 0 ? (out[k] / counts[k]) * size : 0;
    out[k] = bend / (6 + Math.abs(bend));
  }
}
