// Triangles in space with light and shade, pixel by pixel, as surface_shader.ts has them on a graphics card.

import type { Depth } from "./depth";
import { LIGHTS, type LitPalette } from "./lit_palette";
import { VALUES } from "./palette";
import { NEAREST } from "./placed";
import type { Raster } from "./raster";
import { away, distances, inner, pixelAt, REACH } from "./triangles";

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
const LAST = LIGHTS - 1;
const NEAR = 1.02; // times as far away as its nearest corner is its farthest, up to which a triangle needs no perspective

export function fillLit(raster: Raster, depth: Depth, of: Lit, palette: LitPalette, wire: number): void {
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
    const fa = -seen[3 * a + 2]!, fb = -seen[3 * b + 2]!, fc = -seen[3 * c + 2]!;
    // Seen from far, values change evenly over the picture.
    const flat = Math.max(fa, fb, fc) < NEAR * Math.min(fa, fb, fc);
    const wa = flat ? 1 : 1 / fa, wb = flat ? 1 : 1 / fb, wc = flat ? 1 : 1 / fc;
    spread(0, z[a]!, z[b]!, z[c]!, x, y, a, b, c, area);
    if (!flat) spread(1, wa, wb, wc, x, y, a, b, c, area);
    spread(2, known ? sa * wa : 0, known ? sb * wb : 0, known ? sc * wc : 0, x, y, a, b, c, area);
    spread(3, light[0]! * wa, light[1]! * wb, light[2]! * wc, x, y, a, b, c, area);
    even.alike = (!known || (sa === sb && sb === sc)) && light[0] === light[1] && light[1] === light[2];
    even.value = sa;
    // As of polygonOffset: lines along a surface lie before it.
    even.at[0] = even.at[0]! + Math.max(Math.abs(even.x[0]!), Math.abs(even.y[0]!)) + UNITS;
    rows(raster, depth, palette, wire, x, y, a, b, c, known, element > 0, flat);
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
  const side = nx * ax + ny * ay + nz * az > 0 ? -1 : 1, long = side / (Math.sqrt(nx * nx + ny * ny + nz * nz) || 1);
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

/** The triangle's rows from its upper to its lower corner. All in one function: a call for each row takes longer. flat: without perspective. */
function rows(
  raster: Raster, { at: farther }: Depth, palette: LitPalette, wire: number, x: Float32Array, y: Float32Array, a: number, b: number, c: number, known: boolean,
  wired: boolean, flat: boolean,
): void {
  let swap = 0;
  if (y[b]! < y[a]!) { swap = a; a = b; b = swap; }
  if (y[c]! < y[a]!) { swap = a; a = c; c = swap; }
  if (y[c]! < y[b]!) { swap = b; b = c; c = swap; }
  const xa = x[a]!, ya = y[a]!, xb = x[b]!, yb = y[b]!, xc = x[c]!, yc = y[c]!;
  const { pixels, width, height } = raster, { at: e, x: ex, y: ey } = even;
  const long = (xc - xa) / (yc - ya), upper = (xb - xa) / (yb - ya), lower = (xc - xb) / (yc - yb);
  const solid = even.alike && !wired, colour = solid ? colourOf(palette, known) : 0;
  const { values, body: plain } = palette, most = (256 * wire) | 0;
  const z0 = e[0]!, w0 = e[1]!, v0 = e[2]!, l0 = e[3]!, zx = ex[0]!, wx = ex[1]!, vx = ex[2]!, lx = ex[3]!;
  const zy = ey[0]!, wy = ey[1]!, vy = ey[2]!, ly = ey[3]!;
  const [{ at: p0, x: px, y: py }, { at: q0, x: qx, y: qy }, { at: r0, x: rx, y: ry }] = away;
  const turn = pixelAt(yb, height), to = pixelAt(yc, height);
  const longLeft = (xb - xa) * (yc - ya) > (xc - xa) * (yb - ya);
  for (let row = pixelAt(ya, height); row < to; row += 1) {
    const middle = row + 0.5;
    const one = xa + (middle - ya) * long;
    const other = row < turn ? xa + (middle - ya) * upper : xb + (middle - yb) * lower;
    const left = pixelAt(longLeft ? one : other, width), right = pixelAt(longLeft ? other : one, width);
    if (left >= right) continue;
    const from = left + 0.5, end = (row * width + right) | 0;
    let at = (row * width + left) | 0, z = z0 + zx * from + zy * middle;
    if (solid) {
      for (; at < end; at += 1, z += zx) {
        if (z >= farther[at]!) continue;
        farther[at] = z;
        pixels[at] = colour;
      }
      continue;
    }
    let w = w0 + wx * from + wy * middle, v = v0 + vx * from + vy * middle, l = l0 + lx * from + ly * middle;
    let p = p0 + px * from + py * middle, q = q0 + qx * from + qy * middle, r = r0 + rx * from + ry * middle;
    for (; at < end; at += 1, z += zx, w += wx, v += vx, l += lx, p += px, q += qx, r += rx) {
      if (z >= farther[at]!) continue;
      farther[at] = z;
      const far = flat ? LAST : LAST / w, step = (l * far + 0.5) | 0;
      const lit = step < 0 ? 0 : step > LAST ? LAST : step;
      let ink = 0;
      if (known) {
        const value = (flat ? v : v / w) | 0;
        ink = values[lit * VALUES + (value < 0 ? 0 : value >= VALUES ? VALUES - 1 : value)]!;
      } else ink = plain[lit]!;
      if (wired) {
        let near = p < q ? p : q;
        if (r < near) near = r;
        if (near < REACH) {
          const over = near <= REACH - 1 ? most : (most * (REACH - near)) | 0, rest = 256 - over, white = 255 * over + 128;
          ink = (255 << 24) | ((((ink >>> 16) & 255) * rest + white) >> 8) << 16 | ((((ink >>> 8) & 255) * rest + white) >> 8) << 8
            | (((ink & 255) * rest + white) >> 8);
        }
      }
      pixels[at] = ink;
    }
  }
}

/** The colour of a triangle that has one value and one light. */
function colourOf({ values, body }: LitPalette, known: boolean): number {
  const lit = Math.round(LAST * light[0]!);
  return known ? values[lit * VALUES + Math.min(Math.max(Math.floor(even.value), 0), VALUES - 1)]! : body[lit]!;
}
