// Triangles with colours of values and edges of elements, pixel by pixel, as surface_shader.ts has them on a graphics card.

import { STEPS, VALUES, type Palette } from "./palette";
import type { Raster } from "./raster";

export const REACH = 1.3; // pixels from an edge to where nothing of it is seen
const FAR = 1e9;   // pixels to an edge that is not drawn

/** Triangles on the picture. */
export interface Filled {
  x: Float32Array; y: Float32Array;   // of nodes, in pixels
  cells: Uint32Array;
  /** Of the way along the colours, times VALUES: of nodes, or of corners; NaN where a value is unknown. */
  shares: Float32Array;
  inCells: boolean;
  /** Triangles that show an element: all first ones, then all second ones, ...; 0: no edges are drawn. */
  element: number;
}

/** Of pixels on a row, values that change evenly: at x = 0, and from pixel to pixel. */
export interface Even { at: number; x: number; y: number; }

const share: Even = { at: 0, x: 0, y: 0 };
/** Of each side of the triangle that is drawn, how far away it is. */
export const away: [Even, Even, Even] = [{ at: 0, x: 0, y: 0 }, { at: 0, x: 0, y: 0 }, { at: 0, x: 0, y: 0 }];

/** Fills triangles: the pixels whose middles lie inside. */
export function fill(raster: Raster, of: Filled, palette: Palette): void {
  const { x, y, cells, shares, inCells, element } = of;
  const count = cells.length / 3, whole = element ? count / element : count;
  for (let t = 0; t < count; t += 1) {
    const a = cells[3 * t]!, b = cells[3 * t + 1]!, c = cells[3 * t + 2]!;
    const xa = x[a]!, ya = y[a]!, xb = x[b]!, yb = y[b]!, xc = x[c]!, yc = y[c]!;
    const area = (xb - xa) * (yc - ya) - (xc - xa) * (yb - ya);
    if (!area || !(Math.max(ya, yb, yc) > 0 && Math.min(ya, yb, yc) < raster.height)) continue;
    const part = element > 1 ? (t / whole) | 0 : 0;
    distances(away[0], xb, yb, xc, yc, area, element > 0 && !inner(element, part, 0));
    distances(away[1], xc, yc, xa, ya, area, element > 0 && !inner(element, part, 1));
    distances(away[2], xa, ya, xb, yb, area, element > 0 && !inner(element, part, 2));
    const sa = shares[inCells ? 3 * t : a]!, sb = shares[inCells ? 3 * t + 1 : b]!, sc = shares[inCells ? 3 * t + 2 : c]!;
    share.x = ((sb - sa) * (yc - ya) - (sc - sa) * (yb - ya)) / area;
    share.y = ((sc - sa) * (xb - xa) - (sb - sa) * (xc - xa)) / area;
    share.at = sa - share.x * xa - share.y * ya;
    rows(raster, palette, xa, ya, xb, yb, xc, yc, share.at === share.at);
  }
}

/** Whether the side opposite a corner of a triangle lies inside its element, which is drawn in parts. */
export function inner(element: number, part: number, corner: number): boolean {
  if (element === 4) return part === 3 || part === corner;
  return element === 2 && corner === part + 1;
}

/** Pixels to the side from p to q, as fwidth measures them. drawn: the side is. */
export function distances(to: Even, xp: number, yp: number, xq: number, yq: number, area: number, drawn: boolean): void {
  const gx = -(yq - yp) / area, gy = (xq - xp) / area;
  const fold = Math.abs(gx) + Math.abs(gy);
  if (!drawn || !fold) [to.at, to.x, to.y] = [FAR, 0, 0];
  else {
    to.x = gx / fold;
    to.y = gy / fold;
    to.at = -to.x * xp - to.y * yp;
  }
}

/** The triangle's rows from its upper to its lower corner. known: it has values. */
function rows(
  raster: Raster, palette: Palette, xa: number, ya: number, xb: number, yb: number, xc: number, yc: number, known: boolean,
): void {
  // Corners in the order of y, so that a side is computed alike in both of its triangles.
  let swap = 0;
  if (yb < ya) { swap = xa; xa = xb; xb = swap; swap = ya; ya = yb; yb = swap; }
  if (yc < ya) { swap = xa; xa = xc; xc = swap; swap = ya; ya = yc; yc = swap; }
  if (yc < yb) { swap = xb; xb = xc; xc = swap; swap = yb; yb = yc; yc = swap; }
  const from = Math.max(Math.ceil(ya - 0.5), 0), to = Math.min(Math.ceil(yc - 0.5), raster.height);
  const long = (xc - xa) / (yc - ya), upper = (xb - xa) / (yb - ya), lower = (xc - xb) / (yc - yb);
  const [d0, d1, d2] = away;
  const wired = d0.at < FAR || d1.at < FAR || d2.at < FAR;
  const { pixels, width } = raster, { values, body } = palette;
  const ex = share.x, px = d0.x, qx = d1.x, rx = d2.x;
  for (let row = from; row < to; row += 1) {
    const middle = row + 0.5;
    const one = xa + (middle - ya) * long;
    const other = middle < yb ? xa + (middle - ya) * upper : xb + (middle - yb) * lower;
    const left = Math.max(Math.ceil((one < other ? one : other) - 0.5), 0);
    const right = Math.min(Math.ceil((one < other ? other : one) - 0.5), width);
    if (left >= right) continue;
    const x = left + 0.5, begin = row * width;
    const end = begin + right;
    let value = share.at + ex * x + share.y * middle, at = begin + left;
    if (!wired) {
      if (!known) pixels.fill(body[0]!, at, end);
      else for (; at < end; at += 1, value += ex) {
        const i = value | 0;
        pixels[at] = values[i < 0 ? 0 : i > 255 ? 255 : i]!;
      }
      continue;
    }
    let p = d0.at + px * x + d0.y * middle, q = d1.at + qx * x + d1.y * middle, r = d2.at + rx * x + d2.y * middle;
    for (; at < end; at += 1, value += ex, p += px, q += qx, r += rx) {
      let near = p < q ? p : q;
      if (r < near) near = r;
      const step = near >= REACH ? 0 : near <= REACH - 1 ? STEPS : (STEPS * (REACH - near)) | 0;
      const i = value | 0;
      pixels[at] = known ? values[step * VALUES + (i < 0 ? 0 : i > 255 ? 255 : i)]! : body[step]!;
    }
  }
}
