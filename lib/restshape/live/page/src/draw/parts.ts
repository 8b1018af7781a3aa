// The parts of the picture by name, as frames give them.

import { Vector3, type Object3D } from "three";

import type { Part } from "../protocol";
import { Bounds } from "./bounds";
import { arrivedPart, nothingSent, type Arrived, type Sent } from "./shifted";
import { Dots } from "./dots";
import { follow } from "./follow";
import type { Box } from "./labels";
import { Segments } from "./segments";
import type { Shared } from "./shared";
import { Surface, type Read } from "./surface";
import type { Theme } from "./theme";
import type { View } from "./view";

const HANDLE = 5; // pixels from the middle of a dot to its rim
const HANDLES = 60;
const NONE = new Float32Array(0);
const ORDER = { surface: 0, border: 4, lines: 6, dots: 8 };

/** A part as it is now, with what draws it. */
export interface Shown {
  part: Part;
  surface?: Surface;
  border?: Segments;
  lines?: Segments;
  dots?: Dots;
  points: Float32Array;
  shifts: Float32Array;
  starts: Uint32Array;
  names: readonly string[];
  pieces: Uint32Array;                               // of the shape's border that its points lie on
  readonly kept: Sent;
}

export class Parts {
  readonly all = new Map<string, Shown>();
  readonly bounds = new Bounds();
  version = 0;                                       // counts changes of names and numbers of points
  private readonly work = new Vector3();

  constructor(private readonly group: Object3D, private readonly shared: Shared, private readonly theme: Theme, private readonly dim: 2 | 3) {}

  update(parts: readonly Part[], read: Read): void {
    for (const part of parts) {
      if (part.gone) this.take(part.name);
      else this.change(part, read);
    }
    if (parts.some(({ role }) => role === "shape" || role === "outline")) this.bend();
  }

  /** Handles go where the shape is drawn. */
  private bend(): void {
    const shape = this.shape();
    if (!shape) return;
    const size = this.bounds.size() || this.measure().size();
    for (const shown of this.all.values()) {
      if (shown.part.role !== "outline" || shown.part.arrays["displacement"]) continue;
      if (shape.shifts.length === 0) shown.shifts = NONE;
      else {
        const count = shown.points.length / 3;
        if (shown.shifts.length !== 3 * count) shown.shifts = new Float32Array(3 * count);
        if (shown.pieces.length !== count) shown.pieces = new Uint32Array(count);
        follow(shown.shifts, shown.points, shape.starts, shape.points, shape.shifts, size, shown.pieces);
      }
      shown.dots?.set(shown.points, shown.shifts);
    }
  }

  /** What is drawn as the shape. */
  shape(): Shown | undefined {
    for (const shown of this.all.values()) if (shown.surface && shown.part.role === "shape") return shown;
    return undefined;
  }

  clear(): void { for (const name of [...this.all.keys()]) this.take(name); }

  /** The number of the mode whose shape is drawn as the displacement; 0: none is. */
  mode(): number {
    for (const { part } of this.all.values()) if (part.mode) return part.mode;
    return 0;
  }

  *surfaces(): Generator<Surface> { for (const { surface } of this.all.values()) if (surface) yield surface; }

  /** Measures the box around all places without displacements. */
  measure(): Bounds { return this.box(this.bounds, 0); }

  /** The box around all places as they are drawn. */
  drawnBox(): Bounds { return this.box(new Bounds(), this.shared.scale.value); }

  /** Where the dots are seen by which the shape is held; none where there are more than words could leave free. */
  handles(view: View): Box[] {
    const found: Box[] = [], scale = this.shared.scale.value;
    for (const { part, dots } of this.all.values()) {
      if (part.role !== "outline" || !dots?.points.visible) continue;
      const { places, shifts, count } = dots;
      if (found.length + count > HANDLES) return [];
      for (let k = 0; k < 3 * count; k += 3) {
        const [dx, dy, dz] = shifts.length ? [shifts[k]!, shifts[k + 1]!, shifts[k + 2]!] : [0, 0, 0];
        const { x, y } = view.toScreen(places[k]! + scale * dx, places[k + 1]! + scale * dy, places[k + 2]! + scale * dz, this.work);
        found.push([x - HANDLE, y - HANDLE, x + HANDLE, y + HANDLE]);
      }
    }
    return found;
  }

  private box(bounds: Bounds, scale: number): Bounds {
    bounds.clear();
    for (const { points, shifts, surface } of this.all.values()) bounds.add(points, surface ? shifts : NONE, scale);
    return bounds;
  }

  private change(given: Part, from: Read): void {
    let shown = this.all.get(given.name);
    if (shown && shown.part.kind !== given.kind) {
      this.take(given.name);
      shown = undefined;
    }
    if (!shown) this.all.set(given.name, (shown = this.make(given)));
    const arrived = arrivedPart(given, from, shown.kept), { part, read } = arrived;
    const { points, displacement, starts } = part.arrays;
    const before = shown.points.length;
    if (points) shown.points = read(points) as Float32Array;
    if (displacement) shown.shifts = read(displacement) as Float32Array;
    else if (shown.shifts.length !== shown.points.length) shown.shifts = NONE; // of an outline: found by what it follows
    if (starts) shown.starts = read(starts) as Uint32Array;
    if (part.names) shown.names = part.names;
    if (part.names ?? starts ?? shown.points.length !== before) this.version += 1;
    shown.part = part;
    this.draw(shown, arrived);
  }

  private draw(shown: Shown, { part, read, along }: Arrived): void {
    const { surface, border, lines, dots, points, shifts } = shown;
    if (surface) {
      surface.update(part, read, along);
      const edges = part.arrays["border"];
      if (edges) shown.starts = read(edges) as Uint32Array; // of a surface: pairs of points
      if (border && (edges ?? part.arrays["points"] ?? part.arrays["displacement"])) border.setPairs(points, shifts, shown.starts);
    }
    if (lines && (part.arrays["points"] ?? part.arrays["displacement"])) lines.setLines(points, shifts, shown.starts);
    if (dots && (part.arrays["points"] ?? part.arrays["displacement"])) dots.set(points, shifts);
  }

  private make(part: Part): Shown {
    const shown: Shown = { part, points: NONE, shifts: NONE, starts: new Uint32Array(0), names: [], pieces: new Uint32Array(0), kept: nothingSent() };
    const lit = this.dim === 3;
    if (part.kind === "surface") {
      const shape = part.role === "shape";
      shown.surface = new Surface(this.shared, lit, part.role !== "plank", shape, this.theme.colour(BODY[part.role]));
      shown.border = new Segments(this.shared, { colour: this.theme.colour("ink"), width: shape ? 1.5 : 1, opacity: shape ? 0.9 : 0.6 });
      this.add(shown.surface.mesh, ORDER.surface + (shape ? 0.5 : 0));
      this.add(shown.border.mesh, ORDER.border);
    } else if (part.kind === "lines") {
      const rest = part.role === "outline";
      shown.lines = new Segments(this.shared, { colour: this.theme.colour(LINE[part.role]), width: rest ? 1.25 : 2, moves: !rest });
      this.add(shown.lines.mesh, ORDER.lines);
    } else {
      shown.dots = new Dots(this.shared, { colour: this.theme.colour("ground"), rim: this.theme.colour(LINE[part.role]), width: 7 });
      this.add(shown.dots.points, ORDER.dots);
    }
    return shown;
  }

  private add(object: Object3D, order: number): void {
    object.renderOrder = order;
    this.group.add(object);
  }

  private take(name: string): void {
    const shown = this.all.get(name);
    if (!shown) return;
    for (const drawn of [shown.surface, shown.border, shown.lines, shown.dots]) {
      if (!drawn) continue;
      this.group.remove("mesh" in drawn ? drawn.mesh : drawn.points);
      drawn.dispose();
    }
    this.all.delete(name);
    this.version += 1;
  }
}

/** Names of colours in the style sheet, by role. */
const BODY = { shape: "body", outline: "body", body: "solid", plank: "plank", support: "support", load: "load", goal: "goal" };
const LINE = { shape: "ink", outline: "rest", body: "soft", plank: "soft", support: "support", load: "load", goal: "goal" };
