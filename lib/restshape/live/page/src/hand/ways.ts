// Ways that a hand on a flat screen may go in space.

import type { Triple } from "./nearest";

/** "screen": in the plane of the screen through what is held; "xy": in a plane; "x": along an axis. */
export const WAYS = ["screen", "xy", "xz", "yz", "x", "y", "z"] as const;
export type Way = (typeof WAYS)[number];

const AXES = { x: 0, y: 1, z: 2 };

const dot = (a: Triple, b: Triple): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const less = (a: Triple, b: Triple): Triple => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const along = (a: Triple, b: Triple, t: number): [number, number, number] => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
const unit = (axis: number): Triple => [axis === 0 ? 1 : 0, axis === 1 ? 1 : 0, axis === 2 ? 1 : 0];

/**
 * The place that the ray of a pointer means, for a hand that began at `from`; null where it means none.
 *
 * origin, way: of the ray; seen: the direction in which the camera looks.
 */
export function placeOnWay(kind: Way, from: Triple, origin: Triple, way: Triple, seen: Triple): [number, number, number] | null {
  if (kind === "x" || kind === "y" || kind === "z") return onAxis(unit(AXES[kind]), from, origin, way);
  const normal = kind === "screen" ? seen : unit([0, 1, 2].find((axis) => !kind.includes("xyz"[axis]!))!);
  const slope = dot(normal, way);
  if (Math.abs(slope) < 0.02) return null; // the plane is seen from its side
  const t = dot(normal, less(from, origin)) / slope;
  return t > 0 ? along(origin, way, t) : null;
}

/** The point of a line through `from` that is nearest to a ray. */
function onAxis(axis: Triple, from: Triple, origin: Triple, way: Triple): [number, number, number] | null {
  const cosine = dot(axis, way);
  const sine = 1 - cosine * cosine;
  if (sine < 1e-3) return null; // the axis is seen from its end
  const between = less(from, origin);
  return along(from, axis, (cosine * dot(way, between) - dot(axis, between)) / sine);
}
