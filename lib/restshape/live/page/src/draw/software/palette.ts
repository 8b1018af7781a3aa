// Colours of a surface's pixels, ready for use: by value, and by how much of an edge of an element lies over the pixel.

import { packed } from "./raster";

export const STEPS = 64; // of an edge's strength at a pixel, from none to all of it
export const VALUES = 256;

/** What the colours of a surface depend on: bytes, and shares of 1. */
export interface Tint { map: Uint8Array; body: readonly number[]; glowing: readonly number[]; glow: number; wire: number; }

export class Palette {
  /** Colours of values: VALUES for each step. */
  readonly values = new Uint32Array((STEPS + 1) * VALUES);
  /** Of what has no value, for each step. */
  readonly body = new Uint32Array(STEPS + 1);
  private known = "";
  private map: Uint8Array | null = null;

  /** Makes the colours, where they are others than before. */
  make({ map, body, glowing, glow, wire }: Tint): void {
    const asked = `${body.join()} ${glowing.join()} ${glow} ${wire} ${map[0]} ${map[1]}`;
    if (asked === this.known && map === this.map) return;
    [this.known, this.map] = [asked, map];
    const mixed = (of: number, k: number, white: number): number => {
      const lined = of + (255 - of) * white;
      return (lined + (glowing[k]! - lined) * glow + 0.5) | 0;
    };
    for (let step = 0; step <= STEPS; step += 1) {
      const white = (wire * step) / STEPS;
      for (let i = 0; i < VALUES; i += 1) {
        const at = 4 * i;
        this.values[step * VALUES + i] = packed(mixed(map[at]!, 0, white), mixed(map[at + 1]!, 1, white), mixed(map[at + 2]!, 2, white));
      }
      this.body[step] = packed(mixed(body[0]!, 0, white), mixed(body[1]!, 1, white), mixed(body[2]!, 2, white));
    }
  }
}
