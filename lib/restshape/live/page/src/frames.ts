// Arrays of a binary message, read where they lie; those that travel shortened are copied out.

import type { Frame, Numbers } from "./app";
import type { ArrayPlace, FrameMessage } from "./protocol";

/** An array of a message: indices as numbers of 32 bits, points with three coordinates each. Throws a RangeError where it lies beside them. */
export function view(bytes: ArrayBuffer, base: number, place: ArrayPlace): Numbers {
  const size = place.shape.reduce((all, one) => all * one, 1);
  const at = base + place.at;
  if (place.type === "f4" && place.shape[1] === 2) return inSpace(new Float32Array(bytes, at, size));
  if (place.type === "f4") return new Float32Array(bytes, at, size);
  if (place.type === "u2") return new Uint32Array(new Uint16Array(bytes, at, size));
  if (place.type === "u4") return new Uint32Array(bytes, at, size);
  return new Uint8Array(bytes, at, size);
}

/** Points of the plane (x, y each) with z = 0. */
function inSpace(points: Float32Array): Float32Array {
  const found = new Float32Array(1.5 * points.length);
  for (let from = 0, to = 0; from < points.length; from += 2, to += 3) {
    found[to] = points[from]!;
    found[to + 1] = points[from + 1]!;
  }
  return found;
}

/** A frame over the bytes that it came in. */
export function frameOf(header: FrameMessage, bytes: ArrayBuffer, base: number): Frame {
  return { header, read: (place) => view(bytes, base, place) };
}
