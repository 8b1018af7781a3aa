// Arrays of a binary message, read where they lie: nothing is copied.

import type { Frame, Numbers } from "./app";
import type { ArrayPlace, FrameMessage } from "./protocol";

/** A view of an array into the bytes of its message. Throws a RangeError where it lies beside them. */
export function view(bytes: ArrayBuffer, base: number, place: ArrayPlace): Numbers {
  const size = place.shape.reduce((all, one) => all * one, 1);
  const at = base + place.at;
  if (place.type === "f4") return new Float32Array(bytes, at, size);
  if (place.type === "u4") return new Uint32Array(bytes, at, size);
  return new Uint8Array(bytes, at, size);
}

/** A frame over the bytes that it came in. */
export function frameOf(header: FrameMessage, bytes: ArrayBuffer, base: number): Frame {
  return { header, read: (place) => view(bytes, base, place) };
}
