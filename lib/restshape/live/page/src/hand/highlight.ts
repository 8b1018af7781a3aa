// What lights up: under the pointer, and what is selected or held.

import { Dots } from "../draw/dots";
import type { Scene } from "../draw/scene";
import { pairsOf, Segments } from "../draw/segments";
import type { ThingInfo } from "../protocol";
import { numbersOf, type Target } from "./targets";

const NONE = new Float32Array(0);
const ORDER = 30;

export class Highlight {
  private readonly lines: Segments;
  private readonly dots: Dots;
  private target: Target | null = null;
  dot: number | null = null;
  private stale = true;

  constructor(private readonly scene: Scene, colour: string, width: number, private readonly glow: number) {
    const { theme, shared } = scene;
    this.lines = new Segments(shared, { colour: theme.colour(colour), width, through: true });
    this.dots = new Dots(shared, { colour: theme.colour(colour), rim: theme.colour("ground"), width: 4 * width - 1, through: true });
    for (const object of [this.lines.mesh, this.dots.points]) {
      object.renderOrder = ORDER;
      object.visible = false;
      scene.overlay.add(object);
    }
    scene.onDraw.push(() => this.draw());
  }

  /** The thing that is lit up. */
  get lit(): ThingInfo | null { return this.target?.thing ?? null; }

  show(target: Target | null, dot: number | null): void {
    if (target?.thing === this.target?.thing && target?.shown === this.target?.shown && dot === this.dot) {
      this.target = target;
      this.stale = true;
      return;
    }
    this.target?.shown.surface?.setGlow(0);
    this.target = target;
    this.dot = dot;
    this.stale = true;
    this.scene.request();
  }

  private draw(): void {
    const { target } = this;
    if (!target) {
      this.lines.clear();
      this.dots.clear();
      return;
    }
    const { shown } = target;
    // Of a sheet the point alone that is held: its colours are read.
    const sheet = target.thing.role === "cloth";
    if (shown.surface && !target.thing.triangles && !sheet) shown.surface.setGlow(this.glow);
    if (!this.stale) return;
    this.stale = false;
    const pairs = sheet ? [] : shown.surface ? rimOf(target) : target.paths.flatMap(([begin, end]) => pairsOf(end, [begin]));
    if (pairs.length) this.lines.setPairs(shown.points, shown.shifts, pairs);
    else this.lines.clear();
    const dots = this.dot === null ? target.dots : [this.dot];
    if (dots.length) this.dots.set(chosen(shown.points, dots), shown.shifts.length ? chosen(shown.shifts, dots) : NONE);
    else this.dots.clear();
  }
}

function chosen(of: Float32Array, which: readonly number[]): Float32Array {
  return Float32Array.from(which.flatMap((i) => [...of.subarray(3 * i, 3 * i + 3)]));
}

/** Those edges of a surface that belong to a target's triangles. */
function rimOf(target: Target): ArrayLike<number> {
  const edges = target.shown.starts;
  if (!target.thing.triangles) return edges; // all of it
  const nodes = new Set(numbersOf(target));
  const pairs: number[] = [];
  for (let i = 0; i < edges.length; i += 2) if (nodes.has(edges[i]!) && nodes.has(edges[i + 1]!)) pairs.push(edges[i]!, edges[i + 1]!);
  return pairs;
}
