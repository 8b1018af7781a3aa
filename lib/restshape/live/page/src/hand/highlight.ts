// What lights up: under the pointer, and what is selected or held.

import { Dots } from "../draw/dots";
import type { Scene } from "../draw/scene";
import { pairsOf, Segments } from "../draw/segments";
import type { Target } from "./targets";

const NONE = new Float32Array(0);
const ORDER = 30;

export class Highlight {
  private readonly lines: Segments;
  private readonly dots: Dots;
  private target: Target | null = null;
  private dot: number | null = null;
  private drawn: Float32Array | null = null;

  constructor(private readonly scene: Scene, colour: string, width: number, private readonly glow: number) {
    const { theme, shared } = scene;
    this.lines = new Segments(shared, { colour: theme.colour(colour), width, through: true, moves: false });
    this.dots = new Dots(shared, { colour: theme.colour(colour), rim: theme.colour("ground"), width: 4 * width - 1, through: true, moves: false });
    for (const object of [this.lines.mesh, this.dots.points]) {
      object.renderOrder = ORDER;
      object.visible = false;
      scene.overlay.add(object);
    }
    scene.onDraw.push(() => this.draw());
  }

  show(target: Target | null, dot: number | null): void {
    if (target?.thing === this.target?.thing && target?.shown === this.target?.shown && dot === this.dot) {
      this.target = target;
      return;
    }
    this.target?.shown.surface?.setGlow(0);
    this.target = target;
    this.dot = dot;
    this.drawn = null;
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
    if (shown.surface && !target.thing.triangles) shown.surface.setGlow(this.glow);
    if (shown.points === this.drawn) return;
    this.drawn = shown.points;
    const pairs = target.paths.flatMap(([begin, end]) => pairsOf(end, [begin]));
    if (pairs.length) this.lines.setPairs(shown.points, NONE, pairs);
    else this.lines.clear();
    const dots = this.dot === null ? target.dots : [this.dot];
    if (dots.length) this.dots.set(Float32Array.from(dots.flatMap((i) => [...shown.points.subarray(3 * i, 3 * i + 3)])), NONE);
    else this.dots.clear();
  }
}
