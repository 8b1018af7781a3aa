// A picture in memory, pixel by pixel, for a browser without a graphics card.

import type { Color } from "three";

/** Pixels as the canvas takes them: red in the lowest byte. */
export function packed(red: number, green: number, blue: number): number {
  return ((255 << 24) | (blue << 16) | (green << 8) | red) >>> 0;
}

/** A rectangle of pixels: those from left to right - 1, and from top to bottom - 1. */
export interface Box { left: number; top: number; right: number; bottom: number; }

export class Raster {
  width = 0;
  height = 0;
  pixels = new Uint32Array(0);
  image: ImageData | null = null;
  private ground = -1;
  private drawn: Box = { left: 0, top: 0, right: 0, bottom: 0 };
  private before = this.drawn;

  resize(width: number, height: number): void {
    if (width === this.width && height === this.height) return;
    [this.width, this.height] = [width, height];
    const bytes = new Uint8ClampedArray(4 * width * height);
    this.pixels = new Uint32Array(bytes.buffer);
    this.ground = -1;
    this.image = typeof ImageData === "function" ? new ImageData(bytes, width, height) : null;
  }

  /** Begins a picture: takes away what the one before has drawn, and says where that was. */
  clear(colour: Color): Box {
    const ground = packed(...bytesOf(colour)), { width, height } = this;
    this.before = this.drawn;
    if (ground !== this.ground) this.before = { left: 0, top: 0, right: width, bottom: height };
    this.ground = ground;
    const { left, right } = this.before;
    for (let row = this.before.top; row < this.before.bottom; row += 1) this.pixels.fill(ground, row * width + left, row * width + right);
    this.drawn = { left: width, top: height, right: 0, bottom: 0 };
    return this.before;
  }

  /** All is to be drawn again. */
  forget(): void { this.ground = -1; }

  /** Notes that something may be drawn around a place, so many pixels far. */
  reach(x: number, y: number, far: number): void {
    const { drawn } = this;
    drawn.left = Math.max(Math.min(drawn.left, Math.floor(x - far)), 0);
    drawn.top = Math.max(Math.min(drawn.top, Math.floor(y - far)), 0);
    drawn.right = Math.min(Math.max(drawn.right, Math.ceil(x + far)), this.width);
    drawn.bottom = Math.min(Math.max(drawn.bottom, Math.ceil(y + far)), this.height);
  }

  /** What may have changed since the picture before; null: nothing. */
  changed(): Box | null {
    const { before, drawn } = this;
    const all = [before, drawn].filter(({ left, top, right, bottom }) => left < right && top < bottom);
    if (!all.length) return null;
    return {
      left: Math.min(...all.map(({ left }) => left)), top: Math.min(...all.map(({ top }) => top)),
      right: Math.max(...all.map(({ right }) => right)), bottom: Math.max(...all.map(({ bottom }) => bottom)),
    };
  }
}

/** Red, green and blue of a colour, as bytes. */
export function bytesOf({ r, g, b }: Color): [number, number, number] {
  return [Math.round(255 * r), Math.round(255 * g), Math.round(255 * b)];
}

/** Puts colour over a pixel. cover: how much of it, 0 to 1. */
export function blend(pixels: Uint32Array, at: number, red: number, green: number, blue: number, cover: number): void {
  const below = pixels[at]!;
  const a = (256 * cover + 0.5) | 0, rest = 256 - a;
  pixels[at] = ((255 << 24)
    | (((rest * ((below >>> 16) & 255) + a * blue + 128) >> 8) << 16)
    | (((rest * ((below >>> 8) & 255) + a * green + 128) >> 8) << 8)
    | ((rest * (below & 255) + a * red + 128) >> 8)) >>> 0;
}
