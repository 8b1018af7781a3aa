// Colours of a lit surface's pixels, ready for use: by value, and by how much light falls on it.

import { VALUES, type Tint } from "./palette";
import { packed } from "./raster";

export const LIGHTS = 256; // steps of light, from none to all

export class LitPalette {
  /** Colours of values: VALUES for each step of light. */
  values = new Uint32Array(0);
  /** Of what has no value, for each step of light. */
  readonly body = new Uint32Array(LIGHTS);
  private known = "";
  private map: Uint8Array | null = null;

  /** Makes the colours, where they are others than before. valued: those of values, too. */
  make({ map, body, glowing, glow }: Tint, valued = true): void {
    const asked = `${body.join()} ${glowing.join()} ${glow} ${map[0]} ${map[1]} ${valued}`;
    if (asked === this.known && map === this.map) return;
    [this.known, this.map] = [asked, map];
    if (valued && !this.values.length) this.values = new Uint32Array(LIGHTS * VALUES);
    for (let step = 0; step < LIGHTS; step += 1) {
      const light = step / (LIGHTS - 1);
      const lit = (of: number, k: number): number => (of * light + (glowing[k]! - of * light) * glow + 0.5) | 0;
      this.body[step] = packed(lit(body[0]!, 0), lit(body[1]!, 1), lit(body[2]!, 2));
      for (let i = 0, at = step * VALUES; valued && i < VALUES; i += 1, at += 1) {
        this.values[at] = packed(lit(map[4 * i]!, 0), lit(map[4 * i + 1]!, 1), lit(map[4 * i + 2]!, 2));
      }
    }
  }
}
