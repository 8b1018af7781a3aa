// Triangles with colours of values and edges of elements, pixel by pixel, as surface_shader.ts has them on a graphics card.

import { STEPS, VALUES, type Palette } from "./palette";
import type { Raster } from "./raster";

export const REACH = 1.3; // pixels from an edge to where nothing of it is seen
const FAR = 1e9;   // pixels to an edge that is not drawn
const NARROW = 6;  // pixels of a row that are not worth a look at which of them no edge reaches

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

/** The triangle's rows from its upper to its lower corner. known: it has values. All in one function: a call for each row takes longer. */
function rows(
  raster: Raster, palette: Palette, xa: number, ya: number, xb: number, yb: number, xc: number, yc: number, known: boolean,
): void {
  // Corners in the order of y, so that a side is computed alike in both of its triangles.
  let swap = 0;
  if (yb < ya) { swap = xa; xa = xb; xb = swap; swap = ya; ya = yb; yb = swap; }
  if (yc < ya) { swap = xa; xa = xc; xc = swap; swap = ya; ya = yc; yc = swap; }
  if (yc < yb) { swap = xb; xb = xc; xc = swap; swap = yb; yb = yc; yc = swap; }
  const long = (xc - xa) / (yc - ya), upper = (xb - xa) / (yb - ya), lower = (xc - xb) / (yc - yb);
  const { pixels, width, height } = raster, { values, body } = palette;
  const [{ at: p0, x: px, y: py }, { at: q0, x: qx, y: qy }, { at: r0, x: rx, y: ry }] = away, { at: v0, x: vx, y: vy } = share;
  const ip = 1 / px, iq = 1 / qx, ir = 1 / rx;
  const wired = p0 < FAR || q0 < FAR || r0 < FAR;
  const turn = pixelAt(yb, height), to = pixelAt(yc, height);
  // The longest side lies at the left where the corner in the middle lies at its right.
  const longLeft = (xb - xa) * (yc - ya) > (xc - xa) * (yb - ya);
  for (let row = pixelAt(ya, height); row < to; row += 1) {
    const middle = row + 0.5;
    const one = xa + (middle - ya) * long;
    const other = row < turn ? xa + (middle - ya) * upper : xb + (middle - yb) * lower;
    const left = pixelAt(longLeft ? one : other, width), right = pixelAt(longLeft ? other : one, width);
    if (left >= right) continue;
    const x = left + 0.5, end = row * width + right;
    let at = row * width + left, value = v0 + vx * x + vy * middle;
    let p = p0 + px * x + py * middle, q = q0 + qx * x + qy * middle, r = r0 + rx * x + ry * middle;
    // The pixels from `clear` to `close` - 1 are reached by no edge, and need no distances.
    let clear = 0, close = right - left;
    if (wired && close > NARROW) {
      const span = close;
      let k = (REACH - p) * ip;
      if (px > 0) { if (k > clear) clear = k < span ? (k | 0) + 1 : span; }
      else if (px < 0) { if (k < close) close = k < 0 ? 0 : (k | 0) + 1; }
      else if (p < REACH) close = 0;
      k = (REACH - q) * iq;
      if (qx > 0) { if (k > clear) clear = k < span ? (k | 0) + 1 : span; }
      else if (qx < 0) { if (k < close) close = k < 0 ? 0 : (k | 0) + 1; }
      else if (q < REACH) close = 0;
      k = (REACH - r) * ir;
      if (rx > 0) { if (k > clear) clear = k < span ? (k | 0) + 1 : span; }
      else if (rx < 0) { if (k < close) close = k < 0 ? 0 : (k | 0) + 1; }
      else if (r < REACH) close = 0;
      if (close < clear) close = clear;
    } else if (wired) clear = close;
    const beyond = (close - clear) | 0;
    for (let stop = (at + clear) | 0; ; stop = end) {
      for (; at < stop; at += 1, value += vx, p += px, q += qx, r += rx) {
        let near = p < q ? p : q;
        if (r < near) near = r;
        const step = near >= REACH ? 0 : near <= REACH - 1 ? STEPS : (STEPS * (REACH - near)) | 0;
        pixels[at] = known ? values[step * VALUES + within(value)]! : body[step]!;
      }
      if (at >= end) break;
      stop = at + beyond;
      if (!known) pixels.fill(body[0]!, at, stop);
      else for (let of = value; at < stop; at += 1, of += vx) pixels[at] = values[within(of)]!;
      at = stop;
      value += beyond * vx;
      p += beyond * px;
      q += beyond * qx;
      r += beyond * rx;
    }
  }
}

/** The first pixel of so many whose middle lies behind a place. */
export function pixelAt(place: number, count: number): number {
  return place < 0 ? 0 : place >= count ? count : (place + 0.5) | 0;
}

function within(value: number): number {
  const whole = value | 0;
  return whole < 0 ? 0 : whole >= VALUES ? VALUES - 1 : whole;
}
