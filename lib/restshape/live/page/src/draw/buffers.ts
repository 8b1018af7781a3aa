// Attributes of vertices that are filled in place, and made larger only where they have become too small.

import { BufferAttribute, DynamicDrawUsage, type BufferGeometry } from "three";

const SPARE = 1.3; // of room, so that a mesh that grows a little does not ask for new buffers

/** The attribute of a name with room for `count` vertices of `size` numbers. */
export function room(geometry: BufferGeometry, name: string, count: number, size: number): Float32Array {
  const known = geometry.getAttribute(name) as BufferAttribute | undefined;
  if (known && known.count >= count) return known.array as Float32Array;
  const array = new Float32Array(Math.ceil(SPARE * Math.max(count, 8)) * size);
  const made = new BufferAttribute(array, size);
  made.setUsage(DynamicDrawUsage);
  if (known) geometry.dispose(); // its buffers are made again at the next drawing, at their new size
  geometry.setAttribute(name, made);
  return array;
}

/** Sends the first `count` vertices of an attribute to the graphics card before the next drawing. */
export function refresh(geometry: BufferGeometry, name: string, count: number): void {
  const attribute = geometry.getAttribute(name) as BufferAttribute;
  attribute.clearUpdateRanges();
  attribute.addUpdateRange(0, count * attribute.itemSize);
  attribute.needsUpdate = true;
}
