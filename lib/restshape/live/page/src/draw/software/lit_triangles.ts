// Triangles in space with light and shade, pixel by pixel, as surface_shader.ts has them on a graphics card.

import type { Depth } from "./depth";
import { VALUES, type Tint } from "./palette";
import { NEAREST } from "./placed";
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

/** What changes evenly over a triangle: z, then divided by the distance: 1, shares and light. alike: it has one value and one light. */
const even = { at: new Float64Array(4), x: new Float64Array(4), y: new Float64Array(4), alike: false, value: 0 };
const light = [0, 0, 0];

export function fillLit(raster: Raster, depth: Depth, of: Lit, tint: Tint): void {
  const { x, y, z, seen, cells, shares, inCells, element } = of;
  const count = cells.length / 3, whole = element ? count / element : count;
  for (let t = 0; t < count; t += 1) {
    const a = cells[3 * t]!, b = cells[3 * t + 1]!, c = cells[3 * t + 2]!;
    const area = (x[b]! - x[a]!) * (y[c]! - y[a]!) - (x[c]! - x[a]!) * (y[b]! - y[a]!);
    // A face that reaches behind the eye has no corners there to fill between.
    if (!area || z[a]! < NEAREST || z[b]! < NEAREST || z[c]! < NEAREST) continue;
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
    even.alike = (!known || (sa === sb && sb === sc)) && light[0] === light[1] && light[1] === light[2];
    even.value = sa;
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
  const solid = even.alike && !wired, colour = solid ? colourOf(tint, known) : 0;
  for (let row = from; row < to; row += 1) {
    const middle = row + 0.5;
    const one = xa + (middle - ya) * long;
    const other = middle < yb ? xa + (middle - ya) * upper : xb + (middle - yb) * lower;
    const left = Math.max(Math.ceil((one < other ? one : other) - 0.5), 0);
    const right = Math.min(Math.ceil((one < other ? other : one) - 0.5), raster.width);
    if (left >= right) continue;
    if (solid) single(raster, depth, row, left, right, colour);
    else varied(raster, depth, tint, row, left, right, known, wired);
  }
}

/** Pixels of a row in one colour. */
function single({ pixels, width }: Raster, { at: farther }: Depth, row: number, left: number, right: number, colour: number): void {
  const step = even.x[0]!, end = row * width + right;
  let z = even.at[0]! + step * (left + 0.5) + even.y[0]! * (row + 0.5);
  for (let at = row * width + left; at < end; at += 1, z += step) {
    if (z >= farther[at]!) continue;
    farther[at] = z;
    pixels[at] = colour;
  }
}

/** Pixels of a row by their values, their light, and the edges near them. */
function varied(
  { pixels, width }: Raster, { at: farther }: Depth, tint: Tint, row: number, left: number, right: number, known: boolean, wired: boolean,
): void {
  const { map, body: [red0 = 0, green0 = 0, blue0 = 0], glowing: [red1 = 0, green1 = 0, blue1 = 0], glow, wire } = tint;
  const x = left + 0.5, middle = row + 0.5, end = row * width + right, { at: e, x: ex, y: ey } = even;
  const zx = ex[0]!, wx = ex[1]!, vx = ex[2]!, lx = ex[3]!;
  const [{ at: pa, x: px, y: py }, { at: qa, x: qx, y: qy }, { at: ra, x: rx, y: ry }] = away;
  let z = e[0]! + zx * x + ey[0]! * middle, w = e[1]! + wx * x + ey[1]! * middle;
  let v = e[2]! + vx * x + ey[2]! * middle, l = e[3]! + lx * x + ey[3]! * middle;
  let p = pa + px * x + py * middle, q = qa + qx * x + qy * middle, r = ra + rx * x + ry * middle;
  for (let at = row * width + left; at < end; at += 1, z += zx, w += wx, v += vx, l += lx, p += px, q += qx, r += rx) {
    if (z >= farther[at]!) continue;
    farther[at] = z;
    const far = 1 / w, lit = l * far;
    let red = red0, green = green0, blue = blue0;
    if (known) {
      const value = (v * far) | 0, i = 4 * (value < 0 ? 0 : value >= VALUES ? VALUES - 1 : value);
      red = map[i]!;
      green = map[i + 1]!;
      blue = map[i + 2]!;
    }
    red *= lit;
    green *= lit;
    blue *= lit;
    if (wired) {
      const near = p < q ? (r < p ? r : p) : (r < q ? r : q);
      if (near < REACH) {
        const white = near <= REACH - 1 ? wire : wire * (REACH - near);
        red += (255 - red) * white;
        green += (255 - green) * white;
        blue += (255 - blue) * white;
      }
    }
    if (glow > 0) {
      red += (red1 - red) * glow;
      green += (green1 - green) * glow;
      blue += (blue1 - blue) * glow;
    }
    pixels[at] = (255 << 24) | ((blue + 0.5) << 16) | ((green + 0.5) << 8) | (red + 0.5);
  }
}

/** The colour of a triangle that has one value and one light. */
function colourOf({ map, body, glowing, glow }: Tint, known: boolean): number {
  const i = 4 * Math.min(Math.max(Math.floor(even.value), 0), VALUES - 1);
  const of = [0, 1, 2].map((k) => {
    const lit = light[0]! * (known ? map[i + k]! : body[k]!);
    return Math.round(lit + (glowing[k]! - lit) * glow);
  });
  return packed(of[0]!, of[1]!, of[2]!);
}
