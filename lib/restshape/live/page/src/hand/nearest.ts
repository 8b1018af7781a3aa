// What lies nearest to a pointer: pure geometry, of pixels and of rays.

export interface OnPath { distance: number; piece: number; part: number; }

/**
 * The nearest point of a path to (x, y). xy: two numbers a point. The path goes through the points begin to end - 1; `piece` is
 * the first point of the piece that is nearest, `part` how far along it (0 to 1).
 */
export function nearestOnPath(xy: Float32Array, begin: number, end: number, x: number, y: number): OnPath {
  const best = { distance: Infinity, piece: begin, part: 0 };
  for (let i = begin; i + 1 < end; i += 1) {
    const ax = xy[2 * i]!, ay = xy[2 * i + 1]!;
    const ux = xy[2 * i + 2]! - ax, uy = xy[2 * i + 3]! - ay;
    const square = ux * ux + uy * uy;
    const part = square > 0 ? Math.min(Math.max(((x - ax) * ux + (y - ay) * uy) / square, 0), 1) : 0;
    const distance = Math.hypot(ax + part * ux - x, ay + part * uy - y);
    if (distance < best.distance) Object.assign(best, { distance, piece: i, part });
  }
  return best;
}

/** Whether (x, y) is inside a polygon that is made of paths, in whatever order they come. */
export function inside(xy: Float32Array, paths: readonly (readonly [number, number])[], x: number, y: number): boolean {
  let odd = false;
  for (const [begin, end] of paths) {
    for (let i = begin; i + 1 < end; i += 1) {
      const ay = xy[2 * i + 1]!, by = xy[2 * i + 3]!;
      if (ay > y === by > y) continue;
      const ax = xy[2 * i]!, bx = xy[2 * i + 2]!;
      if (x < ax + ((y - ay) / (by - ay)) * (bx - ax)) odd = !odd;
    }
  }
  return odd;
}

/** The box around paths. */
export function boxOf(xy: Float32Array, paths: readonly (readonly [number, number])[]): { left: number; right: number; low: number; high: number } {
  const box = { left: Infinity, right: -Infinity, low: Infinity, high: -Infinity };
  for (const [begin, end] of paths) {
    for (let i = begin; i < end; i += 1) {
      box.left = Math.min(box.left, xy[2 * i]!);
      box.right = Math.max(box.right, xy[2 * i]!);
      box.low = Math.min(box.low, xy[2 * i + 1]!);
      box.high = Math.max(box.high, xy[2 * i + 1]!);
    }
  }
  return box;
}

/** Area of the box around paths: the smaller of two that hold the pointer is meant. */
export function boxArea(xy: Float32Array, paths: readonly (readonly [number, number])[]): number {
  const { left, right, low, high } = boxOf(xy, paths);
  return (right - left) * (high - low);
}

export type Triple = readonly [number, number, number];

/** Where a ray hits: how far along it, in which triangle, and the shares of that triangle's second and third node. */
export interface RayHit { t: number; triangle: number; u: number; v: number; }

/**
 * Where a ray hits the first of some triangles; at Infinity where it hits none.
 *
 * points, shifts: of nodes, drawn at points + scale * shifts; shifts may be empty. cells: three nodes a triangle, of which
 * those from `first` to `end` count.
 */
export function rayHit(
  points: Float32Array, shifts: Float32Array, scale: number, cells: Uint32Array, first: number, end: number, origin: Triple, way: Triple,
): RayHit {
  const s = shifts.length ? scale : 0;
  const place = (i: number): number => points[i]! + (s ? s * shifts[i]! : 0);
  const nearest = { t: Infinity, triangle: -1, u: 0, v: 0 };
  for (let i = 3 * first; i < 3 * end; i += 3) {
    const a = 3 * cells[i]!, b = 3 * cells[i + 1]!, c = 3 * cells[i + 2]!;
    const ax = place(a), ay = place(a + 1), az = place(a + 2);
    const ux = place(b) - ax, uy = place(b + 1) - ay, uz = place(b + 2) - az;
    const vx = place(c) - ax, vy = place(c + 1) - ay, vz = place(c + 2) - az;
    const px = way[1] * vz - way[2] * vy, py = way[2] * vx - way[0] * vz, pz = way[0] * vy - way[1] * vx;
    const det = ux * px + uy * py + uz * pz;
    if (det === 0) continue;
    const tx = origin[0] - ax, ty = origin[1] - ay, tz = origin[2] - az;
    const u = (tx * px + ty * py + tz * pz) / det;
    if (u < 0 || u > 1) continue;
    const qx = ty * uz - tz * uy, qy = tz * ux - tx * uz, qz = tx * uy - ty * ux;
    const v = (way[0] * qx + way[1] * qy + way[2] * qz) / det;
    if (v < 0 || u + v > 1) continue;
    const t = (vx * qx + vy * qy + vz * qz) / det;
    if (t > 0 && t < nearest.t) Object.assign(nearest, { t, triangle: i / 3, u, v });
  }
  return nearest;
}
