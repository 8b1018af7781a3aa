// Parts that have moved as they lie: their arrays came before, and now a vector alone.

import type { ArrayPlace, Part } from "../protocol";
import type { Read } from "./surface";

type Vector = readonly [number, number, number];

/** What is kept of a part: the arrays as they came last, and what has been added to one of them. */
export interface Sent { points: Float32Array; displacement: Float32Array; shift: Vector | null; }

/** along: nothing has changed but where it is. */
export interface Arrived { part: Part; read: Read; along: boolean; }

export function nothingSent(): Sent {
  return { points: new Float32Array(0), displacement: new Float32Array(0), shift: null };
}

/** A part as if its displacements, or points where it has none, had come with its shift in them; of each array there is one copy. */
export function arrivedPart(part: Part, read: Read, kept: Sent): Arrived {
  const found = new Map<ArrayPlace, Float32Array>(), { points, displacement, cells } = part.arrays, shift = part.shift ?? null;
  if (points) found.set(points, (kept.points = read(points) as Float32Array));
  if (displacement) found.set(displacement, (kept.displacement = read(displacement) as Float32Array));
  const key = kept.displacement.length ? "displacement" : "points", arrays = { ...part.arrays };
  if (part.arrays[key] ? shift : !same(shift, kept.shift)) {
    const place: ArrayPlace = { at: 0, type: "f4", shape: [kept[key].length / 3, 3] };
    arrays[key] = place;
    found.set(place, shift ? added(kept[key], shift) : kept[key]);
  }
  kept.shift = shift;
  return { part: { ...part, arrays }, read: (place) => found.get(place) ?? read(place), along: !points && !displacement && !cells };
}

function same(one: Vector | null, other: Vector | null): boolean {
  return one === other || (!!one && !!other && one.every((value, axis) => value === other[axis]));
}

/** Points, three numbers each, with a vector added to each. */
function added(points: Float32Array, shift: Vector): Float32Array {
  const found = new Float32Array(points.length), [x, y, z] = shift;
  for (let i = 0; i < points.length; i += 3) {
    found[i] = points[i]! + x;
    found[i + 1] = points[i + 1]! + y;
    found[i + 2] = points[i + 2]! + z;
  }
  return found;
}
