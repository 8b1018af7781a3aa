// What others draw over the shape by a name: lines, arrows, dots and words.

import type { Object3D } from "three";

import { Dots } from "./dots";
import type { Labels, Word } from "./labels";
import { Segments } from "./segments";
import type { Shared } from "./shared";
import type { Theme } from "./theme";

/** Lines through points, three numbers each. A line of one point is a dot. moved: displacements of the points. */
export interface LinesDrawn {
  points: Float32Array; starts: ArrayLike<number>; meaning: string; moved?: Float32Array | null; words?: readonly string[]; width?: number;
}
/** Vectors at points, all at one scale, the longest as long as a part of the shape. tips: which of them end at their points. */
export interface ArrowsDrawn {
  points: Float32Array; vectors: Float32Array; meaning: string; moved?: Float32Array | null; tips?: readonly boolean[]; words?: readonly string[];
}
const NONE = new Float32Array(0);
const LONGEST = 0.1; // of the shape's size: the longest arrow
const HEAD = 11; // pixels
const ORDER = 20; // above the shape
const MANY = 24; // dots, which are then drawn smaller

const CASED = ["node"]; // what lies where colours are darkest, and is seen there by a seam of the ground's colour
const SEAM = 1.5; // pixels at each side

interface Drawn { casing?: Segments; lines?: Segments; heads?: Segments; dots?: Dots; }

export class Marks {
  private readonly drawn = new Map<string, Drawn>();

  constructor(
    private readonly group: Object3D, private readonly shared: Shared, private readonly theme: Theme,
    private readonly labels: Labels, private readonly changed: () => void,
  ) {}

  /** Draws lines under a name, in place of those before; null takes them away. */
  setLines(name: string, lines: LinesDrawn | null): void {
    const drawn = this.begin(name, lines);
    if (!lines) return;
    const { points, starts, meaning } = lines;
    const moved = lines.moved ?? NONE;
    const width = lines.width ?? 2.5;
    drawn.heads?.clear();
    if (CASED.includes(meaning)) {
      drawn.casing ??= this.segments(0);
      drawn.casing.look(this.theme.colour("ground"), width + 2 * SEAM);
      drawn.casing.setLines(points, moved, starts);
    } else drawn.casing?.clear();
    drawn.lines ??= this.segments(0);
    drawn.lines.look(this.theme.colour(meaning), width);
    drawn.lines.setLines(points, moved, starts);
    this.setDots(drawn, points, moved, starts, meaning);
    this.labels.set(name, wordsOf(lines.words, meaning, points, moved, (i) => middleOf(points, starts, i)));
  }

  /** Draws arrows under a name. size: of the shape [m]. */
  setArrows(name: string, arrows: ArrowsDrawn | null, size: number): void {
    const drawn = this.begin(name, arrows);
    if (!arrows) return;
    const { points, vectors, meaning, tips = [] } = arrows;
    const { ends, starts } = arrowLines(points, vectors, LONGEST * size, tips);
    const moved = arrows.moved ? ofBothEnds(arrows.moved) : NONE;
    drawn.dots?.clear();
    drawn.casing?.clear();
    drawn.lines ??= this.segments(0);
    drawn.heads ??= this.segments(HEAD);
    for (const segments of [drawn.lines, drawn.heads]) {
      segments.look(this.theme.colour(meaning), 2);
      segments.setLines(ends, moved, starts);
    }
    // Beside the end that is away from the point.
    this.labels.set(name, wordsOf(arrows.words, meaning, ends, moved, (i) => 6 * i + (tips[i] ? 0 : 3)));
  }

  setWords(name: string, words: readonly Word[] | null): void {
    if (this.labels.set(name, words ?? [], true)) this.changed();
  }

  private begin(name: string, what: unknown): Drawn {
    const drawn = this.drawn.get(name) ?? {};
    if (!what && !this.drawn.has(name)) return drawn;
    if (what) this.drawn.set(name, drawn);
    else this.take(name, drawn);
    this.changed();
    return drawn;
  }

  private segments(head: number): Segments {
    const made = new Segments(this.shared, { colour: this.theme.colour("guide"), width: 2, through: true, head });
    made.mesh.renderOrder = ORDER;
    this.group.add(made.mesh);
    return made;
  }

  private setDots(drawn: Drawn, points: Float32Array, moved: Float32Array, starts: ArrayLike<number>, meaning: string): void {
    const alone = lonely(points.length / 3, starts);
    if (!alone.length) {
      drawn.dots?.clear();
      return;
    }
    if (!drawn.dots) {
      drawn.dots = new Dots(this.shared, { colour: this.theme.colour(meaning), rim: this.theme.colour("ground"), width: 10, through: true });
      drawn.dots.points.renderOrder = ORDER;
      this.group.add(drawn.dots.points);
    }
    drawn.dots.look(this.theme.colour(meaning), alone.length > MANY ? 5 : 10, alone.length <= MANY);
    drawn.dots.set(taken(points, alone), moved.length ? taken(moved, alone) : NONE);
  }

  private take(name: string, drawn: Drawn): void {
    for (const segments of [drawn.casing, drawn.lines, drawn.heads]) {
      if (segments) this.group.remove(segments.mesh);
      segments?.dispose();
    }
    if (drawn.dots) this.group.remove(drawn.dots.points);
    drawn.dots?.dispose();
    this.drawn.delete(name);
    this.labels.set(name, []);
  }
}

/** Numbers of the points that are alone in their lines. */
function lonely(count: number, starts: ArrayLike<number>): number[] {
  const alone: number[] = [];
  for (let i = 0; i < starts.length; i += 1) {
    const end = i + 1 < starts.length ? starts[i + 1]! : count;
    if (end - starts[i]! === 1) alone.push(starts[i]!);
  }
  return alone;
}

function taken(points: Float32Array, which: readonly number[]): Float32Array {
  return Float32Array.from(which.flatMap((i) => [...points.subarray(3 * i, 3 * i + 3)]));
}

/** Where the numbers of the middle point of a line begin. */
function middleOf(points: Float32Array, starts: ArrayLike<number>, line: number): number {
  const begin = starts[line] ?? 0;
  const end = line + 1 < starts.length ? starts[line + 1]! : points.length / 3;
  return 3 * (begin + ((end - begin) >> 1));
}

/** The displacements of points for both ends of an arrow at each. */
function ofBothEnds(moved: Float32Array): Float32Array {
  const both = new Float32Array(2 * moved.length);
  for (let i = 0; i < moved.length; i += 3) {
    const own = moved.subarray(i, i + 3);
    both.set(own, 2 * i);
    both.set(own, 2 * i + 3);
  }
  return both;
}

/** Words at points. at: where the numbers of the point of each begin. */
function wordsOf(
  words: readonly string[] | undefined, meaning: string, points: Float32Array, moved: Float32Array, at: (i: number) => number,
): Word[] {
  const placed = (words ?? []).map((text, i) => {
    const from = at(i);
    return { text, meaning, at: points.slice(from, from + 3), moved: moved.length ? moved.slice(from, from + 3) : null };
  });
  return placed.filter(({ text }) => text);
}

/** Lines from points along vectors, the longest of a given length. tips: which of them end at their points instead. */
export function arrowLines(
  points: Float32Array, vectors: Float32Array, longest: number, tips: readonly boolean[] = [],
): { ends: Float32Array; starts: number[] } {
  let most = 0;
  for (let i = 0; i < vectors.length; i += 3) most = Math.max(most, Math.hypot(vectors[i]!, vectors[i + 1]!, vectors[i + 2]!));
  const factor = most > 0 ? longest / most : 0;
  const ends = new Float32Array(2 * points.length);
  const starts: number[] = [];
  for (let i = 0; i < points.length; i += 3) {
    starts.push((2 * i) / 3);
    for (let k = 0; k < 3; k += 1) {
      const far = factor * vectors[i + k]!;
      ends[2 * i + k] = points[i + k]! - (tips[i / 3] ? far : 0);
      ends[2 * i + 3 + k] = ends[2 * i + k]! + far;
    }
  }
  return { ends, starts };
}
