// Where places are on the picture, and how far away.

import type { Camera, Matrix4 } from "three";

export const NEAREST = -1; // depth of what is seen nearest to the eye

export class Placed {
  x = new Float32Array(0);
  y = new Float32Array(0);
  z = new Float32Array(0);                           // depth, from -1 to 1
  seen = new Float32Array(0);                        // as the camera has them, three numbers each
  left = 0;
  right = 0;
  top = 0;
  bottom = 0;
  least = 0;                                         // depth of the nearest one; -Infinity: one lies behind the eye

  /**
   * Takes places in, three numbers each: at points + scale * shifts.
   *
   * width, height: of the picture in pixels.
   */
  take(points: Float32Array, shifts: Float32Array, count: number, scale: number, camera: Camera, width: number, height: number): void {
    this.grow(count);
    const { x, y, z, seen } = this, v = camera.matrixWorldInverse.elements, s = shifts.length ? scale : 0;
    [this.left, this.right, this.top, this.bottom, this.least] = [Infinity, -Infinity, Infinity, -Infinity, Infinity];
    const p = camera.projectionMatrix.elements;
    for (let i = 0, k = 0; i < count; i += 1, k += 3) {
      const px = points[k]! + (s ? s * shifts[k]! : 0), py = points[k + 1]! + (s ? s * shifts[k + 1]! : 0);
      const pz = points[k + 2]! + (s ? s * shifts[k + 2]! : 0);
      const sx = v[0]! * px + v[4]! * py + v[8]! * pz + v[12]!, sy = v[1]! * px + v[5]! * py + v[9]! * pz + v[13]!;
      const sz = v[2]! * px + v[6]! * py + v[10]! * pz + v[14]!;
      const w = p[11]! * sz + p[15]!;
      const across = (1 + (p[0]! * sx + p[8]! * sz + p[12]!) / w) * 0.5 * width;
      const down = (1 - (p[5]! * sy + p[9]! * sz + p[13]!) / w) * 0.5 * height;
      const deep = w > 0 ? (p[10]! * sz + p[14]!) / w : -Infinity;
      x[i] = across;
      y[i] = down;
      z[i] = deep;
      seen[k] = sx;
      seen[k + 1] = sy;
      seen[k + 2] = sz;
      if (across < this.left) this.left = across;
      if (across > this.right) this.right = across;
      if (down < this.top) this.top = down;
      if (down > this.bottom) this.bottom = down;
      if (deep < this.least) this.least = deep;
    }
  }

  private grow(count: number): void {
    if (this.x.length >= count) return;
    const room = Math.ceil(1.3 * count);
    [this.x, this.y, this.z, this.seen] = [new Float32Array(room), new Float32Array(room), new Float32Array(room), new Float32Array(3 * room)];
  }
}

/** Normals of length 1 as the camera has them, of sums of normals. */
export function turned(sums: Float32Array, view: Matrix4, to: Float32Array): Float32Array {
  const found = to.length >= sums.length ? to : new Float32Array(sums.length), v = view.elements;
  for (let k = 0; k < sums.length; k += 3) {
    const nx = sums[k]!, ny = sums[k + 1]!, nz = sums[k + 2]!, long = 1 / (Math.hypot(nx, ny, nz) || 1);
    found[k] = long * (v[0]! * nx + v[4]! * ny + v[8]! * nz);
    found[k + 1] = long * (v[1]! * nx + v[5]! * ny + v[9]! * nz);
    found[k + 2] = long * (v[2]! * nx + v[6]! * ny + v[10]! * nz);
  }
  return found;
}
