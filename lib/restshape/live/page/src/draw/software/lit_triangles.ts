// Triangles in space with light and shade, pixel by pixel, as surface_shader.ts has them on a graphics card.

import type { Depth } from "./depth";
import { VALUES, type Tint } from "./palette";
import { packed, type Raster } from "./raster";
import { away, distances, inner, REACH } from "./triangles";

const SAME = 0.75;  // cosine of the angle beyond which an edge between faces stays sharp
const LIGHT = [-0.45, 0.6, 0.66] as const;
const UNITS = 1e-6; // of depth, by which surfaces lie behind their lines at least

/** Triangles on the picture; see `Filled`. */
export interface Lit {
  x: Float32Array; y: Float32Array; z: Float32Array; // of nodes: pixels, and depth from -1 to 1
  seen: Float32Array;                                // places as the camera has them, three numbers of each node
  normals: Float32Array | null;                      // of length 1, as the camera has them; null: faces are flat
  cells: Uint32Array; shares: Float32Array; inCells: boolean; element: number;
}

/** What changes evenly over a triangle: z, then divided by the distance: 1, shares and light. */
const even = { at: new Float64Array(4), x: new Float64Array(4), y: new Float64Array(4) };
const light = [0, 0, 0];

export function fillLit(raster: Raster, depth: Depth, of: Lit, tint: Tint): void {
  const { x, y, z, seen, cells, shares, inCells, element } = of;
  const count = cells.length / 3, whole = element ? count / element : count;
  for (let t = 0; t < count; t += 1) {
    const a = cells[3 * t]!, b = cells[3 * t + 1]!, c = cells[3 * t + 2]!;
    const area = (x[b]! - x[a]!) * (y[c]! - y[a]!) - (x[c]! - x[a]!) * (y[b]! - y[a]!);
    if (!area) continue;
    shade(of, a, b, c);
    const part = element > 1 ? (t / whole) | 0 : 0;
    distances(away[0], x[b]!, y[b]!, x[c]!, y[c]!, area, element > 0 && !inner(element, part, 0));
    distances(away[1], x[c]!, y[c]!, x[a]!, y[a]!, area, element > 0 && !inner(element, part, 1));
    distances(away[2], x[a]!, y[a]!, x[b]!, y[b]!, area, element > 0 && !inner(element, part, 2));
    const sa = shares[inCells ? 3 * t : a]!, sb = shares[inCells ? 3 * t + 1 : b]!, sc = shares[inCells ? 3 * t + 2 : c]!;
    const known = sa + sb + sc === sa + sb + sc;
    const wa = -1 / seen[3 * a + 2]!, wb = -1 / seen[3 * b + 2]!, wc = -1 / seen[3 * c + 2]!;
    spread(0, z[a]!, z[b]!, z[c]!, x, y, a, b, c, area);
    spread(1, wa, wb, wc, x, y, a, b, c, area);
    spread(2, known ? sa * wa : 0, known ? sb * wb : 0, known ? sc * wc : 0, x, y, a, b, c, area);
    spread(3, light[0]! * wa, light[1]! * wb, light[2]! * wc, x, y, a, b, c, area);
    // As of polygonOffset: lines along a surface lie before it.
    even.at[0] = even.at[0]! + Math.max(Math.abs(even.x[0]!), Math.abs(even.y[0]!)) + UNITS;
    rows(raster, depth, tint, x, y, a, b, c, known, element > 0);
  }
}

/** How a value changes over a triangle. */
function spread(
  k: number, va: number, vb: number, vc: number, x: Float32Array, y: Float32Array, a: number, b: number, c: number, area: number,
): void {
  const across = ((vb - va) * (y[c]! - y[a]!) - (vc - va) * (y[b]! - y[a]!)) / area;
  const down = ((vc - va) * (x[b]! - x[a]!) - (vb - va) * (x[c]! - x[a]!)) / area;
  even.x[k] = across;
  even.y[k] = down;
  even.at[k] = va - across * x[a]! - down * y[a]!;
}

/** The light at the three corners of a triangle. */
function shade({ seen, normals }: Lit, a: number, b: number, c: number): void {
  const ax = seen[3 * a]!, ay = seen[3 * a + 1]!, az = seen[3 * a + 2]!;
  const ux = seen[3 * b]! - ax, uy = seen[3 * b + 1]! - ay, uz = seen[3 * b + 2]! - az;
  const vx = seen[3 * c]! - ax, vy = seen[3 * c + 1]! - ay, vz = seen[3 * c + 2]! - az;
  let nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
  // Towards the eye.
  const side = nx * ax + ny * ay + nz * az > 0 ? -1 : 1, long = side / (Math.hypot(nx, ny, nz) || 1);
  nx *= long;
  ny *= long;
  nz *= long;
  const flat = brightness(nx, ny, nz);
  light.fill(flat);
  if (!normals) return;
  for (let k = 0; k < 3; k += 1) {
    const i = 3 * (k === 0 ? a : k === 1 ? b : c);
    const x = side * normals[i]!, y = side * normals[i + 1]!, z = side * normals[i + 2]!;
    if (x * nx + y * ny + z * nz >= SAME) light[k] = brightness(x, y, z);
  }
}

function brightness(x: number, y: number, z: number): number {
  return 0.42 + 0.38 * Math.abs(z) + 0.2 * Math.max(0, x * LIGHT[0] + y * LIGHT[1] + z * LIGHT[2]);
}

/** The triangle's rows from its upper to its lower corner. */
function rows(
  raster: Raster, depth: Depth, tint: Tint, x: Float32Array, y: Float32Array, a: number, b: number, c: number, known: boolean, wired: boolean,
): void {
  let swap = 0;
  if (y[b]! < y[a]!) { swap = a; a = b; b = swap; }
  if (y[c]! < y[a]!) { swap = a; a = c; c = swap; }
  if (y[c]! < y[b]!) { swap = b; b = c; c = swap; }
  const xa = x[a]!, ya = y[a]!, xb = x[b]!, yb = y[b]!, xc = x[c]!, yc = y[c]!;
  const from = Math.max(Math.ceil(ya - 0.5), 0), to = Math.min(Math.ceil(yc - 0.5), raster.height);
  const long = (xc - xa) / (yc - ya), upper = (xb - xa) / (yb - ya), lower = (xc - xb) / (yc - yb);
  const { at: e, x: ex, y: ey } = even, { pixels, width } = raster, [d0, d1, d2] = away, { map, body, glowing, glow, wire } = tint;
  const farther = depth.at;
  const plain = !wired && glow === 0;
  for (let row = from; row < to; row += 1) {
    const middle = row + 0.5;
    const one = xa + (middle - ya) * long;
    const other = middle < yb ? xa + (middle - ya) * upper : xb + (middle - yb) * lower;
    const left = Math.max(Math.ceil((one < other ? one : other) - 0.5), 0);
    const right = Math.min(Math.ceil((one < other ? other : one) - 0.5), width);
    const begin = row * width;
    for (let column = left; column < right; column += 1) {
      const px = column + 0.5, at = begin + column;
      const z = e[0]! + ex[0]! * px + ey[0]! * middle;
      if (!(z < farther[at]!)) continue;
      farther[at] = z;
      const w = 1 / (e[1]! + ex[1]! * px + ey[1]! * middle);
      const lit = (e[3]! + ex[3]! * px + ey[3]! * middle) * w;
      let red = body[0]!, green = body[1]!, blue = body[2]!;
      if (known) {
        const value = ((e[2]! + ex[2]! * px + ey[2]! * middle) * w) | 0;
        const i = 4 * (value < 0 ? 0 : value >= VALUES ? VALUES - 1 : value);
        red = map[i]!;
        green = map[i + 1]!;
        blue = map[i + 2]!;
      }
      red *= lit;
      green *= lit;
      blue *= lit;
      if (!plain) {
        if (wired) {
          const near = Math.min(d0.at + d0.x * px + d0.y * middle, d1.at + d1.x * px + d1.y * middle, d2.at + d2.x * px + d2.y * middle);
          const white = wire * (near >= REACH ? 0 : near <= REACH - 1 ? 1 : REACH - near);
          red += (255 - red) * white;
          green += (255 - green) * white;
          blue += (255 - blue) * white;
        }
        red += (glowing[0]! - red) * glow;
        green += (glowing[1]! - green) * glow;
        blue += (glowing[2]! - blue) * glow;
      }
      pixels[at] = packed((red + 0.5) | 0, (green + 0.5) | 0, (blue + 0.5) | 0);
    }
  }
}
