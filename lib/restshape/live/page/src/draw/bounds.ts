// The box around places.

import type { Vector3 } from "three";

export class Bounds {
  readonly low = [Infinity, Infinity, Infinity];
  readonly high = [-Infinity, -Infinity, -Infinity];

  /** Takes places in, three numbers each: at points + scale * shifts; shifts may be empty. */
  add(points: Float32Array, shifts: Float32Array, scale: number): void {
    const s = shifts.length ? scale : 0;
    for (let i = 0; i < points.length; i += 3) {
      for (let k = 0; k < 3; k += 1) {
        const value = points[i + k]! + (s ? s * shifts[i + k]! : 0);
        if (value < this.low[k]!) this.low[k] = value;
        if (value > this.high[k]!) this.high[k] = value;
      }
    }
  }

  clear(): void {
    this.low.fill(Infinity);
    this.high.fill(-Infinity);
  }

  get empty(): boolean { return !(this.low[0]! <= this.high[0]!); }
  width(axis: number): number { return this.empty ? 0 : this.high[axis]! - this.low[axis]!; }
  /** Length of the diagonal. */
  size(): number { return Math.hypot(this.width(0), this.width(1), this.width(2)); }
  middle(to: Vector3): Vector3 {
    return this.empty ? to.set(0, 0, 0) : to.set(...([0, 1, 2].map((k) => 0.5 * (this.low[k]! + this.high[k]!)) as [number, number, number]));
  }
}
