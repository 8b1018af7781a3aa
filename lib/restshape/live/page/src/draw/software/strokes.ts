// Lines, heads of arrows and dots over the picture, pixel by pixel, as segments.ts and dots.ts have them on a graphics card.

import type { Depth } from "./depth";
import { blend, type Raster } from "./raster";

/** Bytes of a colour, and how much it covers. */
export interface Ink { red: number; green: number; blue: number; opacity: number; }

/** Depths of both ends of a line, or of a dot, among those of what may hide it. */
export interface Behind { depth: Depth; from: number; to: number; }

const ENDS = 0.3; // of its width, by which a line is longer at both ends

/** A straight line of a width from a to b, in pixels, with soft sides. */
export function line(raster: Raster, xa: number, ya: number, xb: number, yb: number, wide: number, { red, green, blue, opacity }: Ink, behind: Behind | null = null): void {
  const span = Math.hypot(xb - xa, yb - ya);
  const ux = span > 1e-6 ? (xb - xa) / span : 1, uy = span > 1e-6 ? (yb - ya) / span : 0;
  const half = 0.5 * wide, reach = half + 0.5, more = ENDS * wide;
  const high = Math.abs(uy) * more + Math.abs(ux) * reach;
  const from = Math.max(Math.ceil(Math.min(ya, yb) - high - 0.5), 0);
  const to = Math.min(Math.ceil(Math.max(ya, yb) + high - 0.5), raster.height);
  for (let row = from; row < to; row += 1) {
    const down = row + 0.5 - ya;
    // Along the row: -reach < across < reach, and -more < along < span + more.
    let left = -Infinity, right = Infinity;
    if (Math.abs(uy) > 1e-9) {
      const middle = (ux * down) / uy, away = Math.abs(reach / uy);
      left = middle - away;
      right = middle + away;
    } else if (Math.abs(ux * down) >= reach) continue;
    if (Math.abs(ux) > 1e-9) {
      const one = (-more - uy * down) / ux, other = (span + more - uy * down) / ux;
      left = Math.max(left, Math.min(one, other));
      right = Math.min(right, Math.max(one, other));
    } else if (uy * down < -more || uy * down > span + more) continue;
    const begin = Math.max(Math.ceil(xa + left - 0.5), 0), end = Math.min(Math.ceil(xa + right - 0.5), raster.width);
    let across = ux * down - uy * (begin + 0.5 - xa);
    for (let x = begin; x < end; x += 1, across -= uy) {
      const cover = reach - Math.abs(across);
      if (behind && hidden(behind, row * raster.width + x, span > 0 ? (ux * (x + 0.5 - xa) + uy * down) / span : 0)) continue;
      if (cover > 0) blend(raster.pixels, row * raster.width + x, red, green, blue, opacity * (cover < 1 ? cover : 1));
    }
  }
}

/** Whether something lies before a share of the way along a line. */
function hidden({ depth, from, to }: Behind, at: number, along: number): boolean {
  return from + (to - from) * Math.min(Math.max(along, 0), 1) > depth.at[at]!;
}

/** The head of an arrow from a to b, whose tip is b. long: in pixels. */
export function head(raster: Raster, xa: number, ya: number, xb: number, yb: number, long: number, ink: Ink, behind: Behind | null = null): void {
  const span = Math.hypot(xb - xa, yb - ya);
  if (span < 1) return;
  const ux = (xb - xa) / span, uy = (yb - ya) / span;
  const from = Math.max(Math.ceil(yb - long * 1.4 - 0.5), 0), to = Math.min(Math.ceil(yb + long * 1.4 - 0.5), raster.height);
  const begin = Math.max(Math.ceil(xb - long * 1.4 - 0.5), 0), end = Math.min(Math.ceil(xb + long * 1.4 - 0.5), raster.width);
  for (let row = from; row < to; row += 1) {
    for (let x = begin; x < end; x += 1) {
      const right = x + 0.5 - xb, down = row + 0.5 - yb;
      const back = -(ux * right + uy * down), across = Math.abs(ux * down - uy * right);
      if (back < 0 || back > long || across > 0.38 * back) continue;
      if (behind && hidden(behind, row * raster.width + x, 1)) continue;
      blend(raster.pixels, row * raster.width + x, ink.red, ink.green, ink.blue, ink.opacity);
    }
  }
}

/** A dot of a width with a rim, which is `edge` pixels wide. */
export function dot(raster: Raster, xm: number, ym: number, wide: number, edge: number, inside: Ink, rim: Ink, behind: Behind | null = null): void {
  const half = 0.5 * wide, reach = half + 0.5;
  const from = Math.max(Math.ceil(ym - reach - 0.5), 0), to = Math.min(Math.ceil(ym + reach - 0.5), raster.height);
  const begin = Math.max(Math.ceil(xm - reach - 0.5), 0), end = Math.min(Math.ceil(xm + reach - 0.5), raster.width);
  for (let row = from; row < to; row += 1) {
    for (let x = begin; x < end; x += 1) {
      const away = Math.hypot(x + 0.5 - xm, row + 0.5 - ym);
      const cover = Math.min(Math.max(reach - away, 0), 1);
      if (cover <= 0 || (behind && hidden(behind, row * raster.width + x, 0))) continue;
      const inner = Math.min(Math.max(reach - edge - away, 0), 1), outer = 1 - inner;
      const red = inner * inside.red + outer * rim.red, green = inner * inside.green + outer * rim.green;
      blend(raster.pixels, row * raster.width + x, red, green, inner * inside.blue + outer * rim.blue, cover);
    }
  }
}
