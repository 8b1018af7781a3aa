// The outline's displacements: those of the mesh's border at the same places.

const NEAR = 1e-3; // of the size: squared distance beyond which a place is not on the border

/**
 * Displacements of places of the outline, three numbers each, from the nearest piece of a border; zero where none is near.
 *
 * places: written to `found`. edges: pairs of nodes. points, shifts: of all nodes. size: of the shape.
 */
export function follow(
  found: Float32Array, places: Float32Array, edges: Uint32Array, points: Float32Array, shifts: Float32Array, size: number,
): void {
  found.fill(0);
  for (let i = 0; i < places.length; i += 3) {
    const x = places[i]!, y = places[i + 1]!, z = places[i + 2]!;
    let best = NEAR * size * size, from = -1, to = -1, share = 0;
    for (let k = 0; k < edges.length; k += 2) {
      const a = 3 * edges[k]!, b = 3 * edges[k + 1]!;
      const ax = points[a]!, ay = points[a + 1]!, az = points[a + 2]!;
      const ux = points[b]! - ax, uy = points[b + 1]! - ay, uz = points[b + 2]! - az;
      const square = ux * ux + uy * uy + uz * uz;
      const part = square > 0 ? Math.min(Math.max(((x - ax) * ux + (y - ay) * uy + (z - az) * uz) / square, 0), 1) : 0;
      const dx = ax + part * ux - x, dy = ay + part * uy - y, dz = az + part * uz - z;
      const distance = dx * dx + dy * dy + dz * dz;
      if (distance < best) [best, from, to, share] = [distance, a, b, part];
    }
    if (from < 0) continue;
    for (let k = 0; k < 3; k += 1) found[i + k] = shifts[from + k]! + share * (shifts[to + k]! - shifts[from + k]!);
  }
}
