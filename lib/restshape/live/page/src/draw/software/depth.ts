// How far away what is drawn lies at each pixel: nearer things hide those behind them.

import type { Box } from "./raster";

export class Depth {
  at = new Float32Array(0);
  private width = 0;

  resize(width: number, height: number): void {
    if (this.at.length === width * height && this.width === width) return;
    this.at = new Float32Array(width * height).fill(1);
    this.width = width;
  }

  /** Nothing hides anything there. */
  clear({ left, top, right, bottom }: Box): void {
    for (let row = top; row < bottom; row += 1) this.at.fill(1, row * this.width + left, row * this.width + right);
  }
}
