// The outline's displacements: those of the mesh's border at the same places.

const NEAR = 1e-3; // of the size: squared distance beyond which a place is not on the border

const ON = 1e-13; // of the size: squared distance up to which a place is on a piece, and no nearer one is looked for

/**
 * Displacements of places of the outline, three numbers each, from the nearest piece of a border; zero where none is near.
 *
 * places: written to `found`. edges: pairs of nodes. points, shifts: of all nodes. size: of the shape. pieces: of each place the
 * piece that was nearest before, where it is looked first, and is now.
 */
export function follow(
  found: Float32Array, places: Float32Array, edges: Uint32Array, points: Float32Array, shifts: Float32Array, size: number, pieces: Uint32Array,
): void {
  found.fill(0);
  const on = ON * size * size, count = edges.length / 2;
  for (let i = 0; i < places.length; i += 3) {
    const x = places[i]!, y = places[i + 1]!, z = places[i + 2]!, begin = pieces[i / 3]!;
    let best = NEAR * size * size, from = -1, to = -1, share = 0;
    for (let tried = 0, piece = begin < count ? begin : 0; tried < count && best > on; tried += 1, piece = piece + 1 < count ? piece + 1 : 0) {
      const a = 3 * edges[2 * piece]!, b = 3 * edges[2 * piece + 1]!;
      const ax = points[a]!, ay = points[a + 1]!, az = points[a + 2]!;
      const ux = points[b]! - ax, uy = points[b + 1]! - ay, uz = points[b + 2]! - az;
      const square = ux * ux + uy * uy + uz * uz;
      const along = square > 0 ? ((x - ax) * ux + (y - ay) * uy + (z - az) * uz) / square : 0;
      const part = along < 0 ? 0 : along > 1 ? 1 : along;
      const dx = ax + part * ux - x, dy = ay + part * uy - y, dz = az + part * uz - z;
      const distance = dx * dx + dy * dy + dz * dz;
      if (distance >= best) continue;
      best = distance;
      from = a;
      to = b;
      share = part;
      pieces[i / 3] = piece;
    }
    if (from < 0) continue;
    for (let k = 0; k < 3; k += 1) found[i + k] = shifts[from + k]! + share * (shifts[to + k]! - shifts[from + k]!);
  }
}
