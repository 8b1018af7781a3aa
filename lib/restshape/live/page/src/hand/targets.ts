// What of the picture can be taken hold of, and where: things of the session, found in its parts.

import { Vector3 } from "three";

import type { Parts, Shown } from "../draw/parts";
import type { Scene } from "../draw/scene";
import type { ThingInfo } from "../protocol";
import { boxArea, boxOf, inside, nearestOnPath, rayHit, type Triple } from "./nearest";

export type Path = readonly [number, number];        // numbers of the first point, and of the one after the last
export interface Target { thing: ThingInfo; shown: Shown; dots: number[]; paths: Path[]; }
/** at: where it is taken hold of, in the shape without displacements. dot: number of the dot, where it is one. material: the point of a sheet, in its pattern. */
export interface Grip { target: Target; at: [number, number, number]; dot: number | null; material?: [number, number]; }

const ORDER = ["vertex", "control", "edge", "hole", "region", "panel", "group", "support", "body", "plank", "cloth"];

export class Targets {
  private all: Target[] = [];
  private things: readonly ThingInfo[] = [];
  chosen: ThingInfo | null = null;                   // what is selected
  private version = -1;
  private parts: Parts | null = null;
  private readonly flat = new Map<Shown, Float32Array>();
  private readonly work = new Vector3();

  constructor(private readonly scene: Scene) {}

  /** All in the order in which keys go through them. */
  list(things: readonly ThingInfo[]): readonly Target[] {
    const { parts } = this.scene;
    if (things === this.things && parts === this.parts && parts.version === this.version) return this.all;
    this.things = things;
    this.parts = parts;
    this.version = parts.version;
    this.all = things.map((thing) => target(thing, parts)).filter((one): one is Target => one !== null);
    this.all.sort((a, b) => ORDER.indexOf(a.thing.role) - ORDER.indexOf(b.thing.role));
    return this.all;
  }

  find(things: readonly ThingInfo[], name: string): Target | null {
    return this.list(things).find(({ thing }) => thing.name === name) ?? null;
  }

  /** What is under a pixel: a support before a vertex before a control point before an edge before what lies inside. reach: pixels. */
  at(things: readonly ThingInfo[], x: number, y: number, reach: number, free: (thing: ThingInfo) => boolean): Grip | null {
    const all = this.list(things).filter(({ thing }) => free(thing));
    this.flat.clear();
    const area = this.areaAt(all, x, y);
    // In the middle of a small hole the hole is meant, though its vertices are within reach.
    const near = area ? Math.min(reach, this.fromMiddle(area.target, x, y)) : reach;
    return this.dotAt(all, x, y, near) ?? this.edgeAt(all, x, y, near) ?? area ?? this.bodyAt(all, x, y);
  }

  private fromMiddle(target: Target, x: number, y: number): number {
    const xy = this.pixels(target.shown);
    let far = 0;
    for (const [begin, end] of target.paths) for (let i = begin; i < end; i += 1) far = Math.max(far, Math.hypot(xy[2 * i]! - x, xy[2 * i + 1]! - y));
    const { left, right, low, high } = boxOf(xy, target.paths);
    return Math.max(Math.hypot(x - 0.5 * (left + right), y - 0.5 * (low + high)), 0.2 * far);
  }

  /** Where a target is taken hold of by keys: its middle; of several dots the first. */
  grip(target: Target): Grip {
    const { shown, dots, paths, thing } = target;
    if (thing.role === "cloth") return gripOfCloth(target, nodeNear(target, middle(target)));
    if (dots.length) return { target, at: placeOf(shown, dots[0]!), dot: dots[0]! };
    if (thing.role === "edge" && paths[0]) {
      const [begin, end] = paths[0];
      return { target, at: placeOf(shown, (begin + end - 1) >> 1), dot: null };
    }
    return { target, at: middle(target), dot: null };
  }

  private dotAt(all: readonly Target[], x: number, y: number, reach: number): Grip | null {
    let found: Grip | null = null;
    let best = reach;
    for (const target of all) {
      for (const dot of target.dots) {
        const xy = this.pixels(target.shown);
        const distance = Math.hypot(xy[2 * dot]! - x, xy[2 * dot + 1]! - y) + this.rank(target.thing);
        if (distance >= best) continue;
        best = distance;
        found = { target, at: placeOf(target.shown, dot), dot };
      }
    }
    return found;
  }

  /** Pixels by which a dot counts as farther away: of several at one place what is selected comes first, then a support. */
  private rank({ name, role }: ThingInfo): number {
    if (this.chosen?.name === name && this.chosen.role === role) return -3;
    return role === "support" ? -1 : role === "vertex" ? 0 : 1;
  }

  private edgeAt(all: readonly Target[], x: number, y: number, reach: number): Grip | null {
    let found: Grip | null = null;
    let best = reach * 0.8;
    for (const target of all) {
      if (!["edge", "support"].includes(target.thing.role)) continue;
      for (const [begin, end] of target.paths) {
        const near = nearestOnPath(this.pixels(target.shown), begin, end, x, y);
        if (near.distance >= best) continue;
        best = near.distance;
        const a = placeOf(target.shown, near.piece);
        const b = placeOf(target.shown, Math.min(near.piece + 1, end - 1));
        found = { target, at: [0, 1, 2].map((k) => a[k]! + near.part * (b[k]! - a[k]!)) as [number, number, number], dot: null };
      }
    }
    return found;
  }

  private areaAt(all: readonly Target[], x: number, y: number): Grip | null {
    let found: Target | null = null;
    let best = Infinity;
    for (const target of all) {
      if (!["hole", "region", "panel"].includes(target.thing.role) || !target.paths.length) continue;
      const xy = this.pixels(target.shown);
      const area = boxArea(xy, target.paths);
      if (area >= best || !inside(xy, target.paths, x, y)) continue;
      best = area;
      found = target;
    }
    if (!found) return null;
    const [first] = found.paths[0]!;
    const rest = placeOf(found.shown, first);
    const drawn = drawnAt(found.shown, first, this.scene.shared.scale.value);
    const at = this.inPlane(x, y, drawn[2]);
    return { target: found, at: [0, 1, 2].map((k) => at[k]! + rest[k]! - drawn[k]!) as [number, number, number], dot: null };
  }

  /** The place of the plane at a height that is under a pixel. */
  inPlane(x: number, y: number, height: number): [number, number, number] {
    const { origin, direction } = this.scene.view.ray(x, y);
    const t = direction.z ? (height - origin.z) / direction.z : 0;
    return [origin.x + t * direction.x, origin.y + t * direction.y, height];
  }

  private bodyAt(all: readonly Target[], x: number, y: number): Grip | null {
    const { origin, direction } = this.scene.view.ray(x, y);
    const from: Triple = [origin.x, origin.y, origin.z];
    const way: Triple = [direction.x, direction.y, direction.z];
    let best = Infinity, node = 0;
    let found: Target | null = null;
    for (const shown of this.scene.parts.all.values()) {
      const { surface } = shown;
      if (!surface?.mesh.visible) continue;
      const here = all.filter((target) => target.shown === shown);
      const ranges = here.length ? here : [null]; // what cannot be held still hides what is behind
      for (const target of ranges) {
        for (const [first, count] of target?.thing.triangles ?? [[0, surface.cells.length / 3]] as const) {
          const hit = rayHit(surface.points, surface.shifts, this.scene.shared.scale.value, surface.cells, first, first + count, from, way);
          if (hit.t < best) [best, found, node] = [hit.t, target, surface.cells[3 * hit.triangle + cornerOf(hit)] ?? 0];
        }
      }
    }
    if (!found) return null;
    if (found.thing.role === "cloth") return gripOfCloth(found, node);
    return { target: found, at: [0, 1, 2].map((k) => from[k]! + best * way[k]!) as [number, number, number], dot: null };
  }

  /** The place of the surface that is under a pixel, in the shape without displacements; null: there is none. */
  onSurface(x: number, y: number): [number, number, number] | null {
    const { origin, direction } = this.scene.view.ray(x, y);
    let best = Infinity;
    let found: [number, number, number] | null = null;
    for (const { surface } of this.scene.parts.all.values()) {
      if (!surface?.mesh.visible) continue;
      const { points, shifts, cells } = surface;
      const hit = rayHit(points, shifts, this.scene.shared.scale.value, cells, 0, cells.length / 3,
        [origin.x, origin.y, origin.z], [direction.x, direction.y, direction.z]);
      if (hit.t >= best) continue;
      best = hit.t;
      const [a, b, c] = [0, 1, 2].map((k) => 3 * cells[3 * hit.triangle + k]!) as [number, number, number];
      const share = 1 - hit.u - hit.v;
      found = [0, 1, 2].map((k) => share * points[a + k]! + hit.u * points[b + k]! + hit.v * points[c + k]!) as [number, number, number];
    }
    return found;
  }

  /** Pixels of a part's points as they lie on the screen; of each only once a look. */
  private pixels(shown: Shown): Float32Array {
    const known = this.flat.get(shown);
    if (known) return known;
    const xy = new Float32Array((2 * shown.points.length) / 3);
    for (let i = 0, k = 0; k < xy.length; i += 3, k += 2) {
      this.scene.view.toScreen(...drawnAt(shown, i / 3, this.scene.shared.scale.value), this.work);
      xy[k] = this.work.x;
      xy[k + 1] = this.work.y;
    }
    this.flat.set(shown, xy);
    return xy;
  }
}

/** What people call a thing. */
export function titleOf({ role, name }: ThingInfo): string { return role === name ? name : `${role} ${name}`; }

/** The corner (0 to 2) of a triangle that is nearest to where a ray hits it. */
function cornerOf({ u, v }: { u: number; v: number }): number {
  const share = [1 - u - v, u, v];
  return share.indexOf(Math.max(...share));
}

/** A sheet, taken hold of at a node: where that is now, and where in the pattern. */
function gripOfCloth(target: Target, node: number): Grip {
  const [x, y] = placeOf(target.shown, node);
  return { target, at: drawnAt(target.shown, node, 1), dot: node, material: [x, y].map((one) => Number(one.toPrecision(9))) as [number, number] };
}

/** The node of a surface that is nearest to a place in the shape without displacements. */
function nodeNear({ shown }: Target, place: readonly number[]): number {
  let best = Infinity, found = 0;
  for (let i = 0; 3 * i < shown.points.length; i += 1) {
    const own = placeOf(shown, i), distance = Math.hypot(...own.map((one, k) => one - place[k]!));
    if (distance < best) [best, found] = [distance, i];
  }
  return found;
}

function target(thing: ThingInfo, parts: Parts): Target | null {
  const shown = parts.all.get(thing.part);
  if (!shown) return null;
  const names = new Set(thing.lines?.length ? thing.lines : [thing.name]);
  const dots: number[] = [];
  const paths: Path[] = [];
  shown.names.forEach((name, i) => {
    if (!names.has(name)) return;
    if (shown.part.kind === "dots") dots.push(i);
    else if (shown.part.kind === "lines") paths.push([shown.starts[i]!, shown.starts[i + 1] ?? shown.points.length / 3]);
  });
  return { thing, shown, dots, paths };
}

/** Where a point is drawn. */
export function drawnAt(shown: Shown, i: number, scale: number): [number, number, number] {
  const { points, shifts } = shown;
  const s = shifts.length ? scale : 0;
  return [0, 1, 2].map((k) => (points[3 * i + k] ?? 0) + (s ? s * shifts[3 * i + k]! : 0)) as [number, number, number];
}

/** The middle of what a target is drawn through, without displacements, and the displacement there. */
export function anchorOf(target: Target): { at: number[]; moved: number[] } {
  const { shown, dots, paths, thing } = target;
  const edge = thing.role === "edge" ? paths[0] : undefined;
  const numbers = dots.length ? dots.slice(0, 1) : edge ? [(edge[0] + edge[1] - 1) >> 1] : [...numbersOf(target)];
  const moved = [0, 0, 0];
  if (shown.shifts.length) for (const i of numbers) for (let k = 0; k < 3; k += 1) moved[k] = moved[k]! + shown.shifts[3 * i + k]! / numbers.length;
  const first = numbers[0];
  return { at: (dots.length || edge) && first !== undefined ? placeOf(shown, first) : middle(target), moved };
}

export function placeOf(shown: Shown, i: number): [number, number, number] {
  return [shown.points[3 * i] ?? 0, shown.points[3 * i + 1] ?? 0, shown.points[3 * i + 2] ?? 0];
}

/** The middle of the box around a target. */
export function middle(target: Target): [number, number, number] {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const i of numbersOf(target)) {
    const place = placeOf(target.shown, i);
    for (let k = 0; k < 3; k += 1) {
      low[k] = Math.min(low[k]!, place[k]!);
      high[k] = Math.max(high[k]!, place[k]!);
    }
  }
  return [0, 1, 2].map((k) => (low[k]! <= high[k]! ? 0.5 * (low[k]! + high[k]!) : 0)) as [number, number, number];
}

/** Numbers of the points that a target is drawn through. */
export function* numbersOf({ shown, dots, paths, thing }: Target): Generator<number> {
  yield* dots;
  for (const [begin, end] of paths) for (let i = begin; i < end; i += 1) yield i;
  if (!shown.surface) return;
  for (const [first, count] of thing.triangles ?? [[0, shown.surface.cells.length / 3]] as const) {
    for (let i = 3 * first; i < 3 * (first + count); i += 1) yield shown.surface.cells[i]!;
  }
}
