// Normals of a surface at its nodes.

/** Sums of the triangles' normals, as long as their areas, at each node: at points + scale * shifts. */
export function addNormals(normals: Float32Array, points: Float32Array, shifts: Float32Array, scale: number, cells: Uint32Array): void {
  normals.fill(0);
  const s = shifts.length ? scale : 0;
  const place = (i: number): number => points[i]! + (s ? s * shifts[i]! : 0);
  for (let i = 0; i < cells.length; i += 3) {
    const a = 3 * cells[i]!;
    const b = 3 * cells[i + 1]!;
    const c = 3 * cells[i + 2]!;
    const ux = place(b) - place(a), uy = place(b + 1) - place(a + 1), uz = place(b + 2) - place(a + 2);
    const vx = place(c) - place(a), vy = place(c + 1) - place(a + 1), vz = place(c + 2) - place(a + 2);
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    add(normals, a, x, y, z);
    add(normals, b, x, y, z);
    add(normals, c, x, y, z);
  }
}

function add(to: Float32Array, at: number, x: number, y: number, z: number): void {
  to[at] = to[at]! + x;
  to[at + 1] = to[at + 1]! + y;
  to[at + 2] = to[at + 2]! + z;
}
