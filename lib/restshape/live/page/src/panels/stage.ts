// What the panels need of the drawing: places pressed on the canvas, marks to draw, and the picture.

import type { MarkMessage } from "../protocol";

/** Lines, arrows and words as they are drawn: `MarkMessage` with its arrays. Points and vectors have three numbers each. */
export type DrawnMark =
  | { kind: "lines"; name: string; meaning: string; starts: number[]; words: string[]; points: Float32Array; moved: Float32Array | null }
  | { kind: "arrows"; name: string; meaning: string; unit: string; words: string[]; points: Float32Array; vectors: Float32Array }
  | { kind: "words"; text: string; at: number[] | null; meaning: string };

export interface Stage {
  /** The place [m] at which the canvas is pressed next; null: given up by Escape, or by another pick. */
  pick(what: string): Promise<number[] | null>;
  /** Draws marks besides those of the frame, in place of those drawn under the same name before; empty: none. */
  draw(name: string, marks: DrawnMark[]): void;
  /** Lines, arrows and words of the last frame's marks with their arrays. */
  drawn(marks: MarkMessage[]): DrawnMark[];
}
