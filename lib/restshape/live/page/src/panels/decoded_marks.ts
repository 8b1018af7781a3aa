// Marks of a frame with their arrays, and by their kind.

import type { Frame } from "../app";
import type { MarkMessage, PointPlaces } from "../protocol";
import type { DrawnMark } from "./stage";

export type Offer = Extract<MarkMessage, { kind: "offer" }>;
export type ChartMark = Extract<MarkMessage, { kind: "chart" }>;
export type ToneMark = Extract<MarkMessage, { kind: "tone" }>;

/** An offer, and what it would look like. */
export interface ShownOffer { offer: Offer; lines: DrawnMark[]; }

export interface MarksByKind { drawn: DrawnMark[]; offers: ShownOffer[]; charts: ChartMark[]; tones: ToneMark[]; }

/** A mark as it came, and what is drawn of it. */
export interface TakenMark { mark: MarkMessage; drawn: DrawnMark[]; }

/** The marks of a frame, those that stay from the frame before. Arrays are copied, for they are drawn after the message is gone. */
export function taken(marks: readonly (MarkMessage | null)[], read: Frame["read"], before: readonly TakenMark[]): TakenMark[] {
  return marks.flatMap((mark, place) => {
    const kept = before[place];
    if (!mark) return kept ? [kept] : [];
    return [{ mark, drawn: mark.kind === "offer" ? mark.lines.flatMap((line) => decoded(line, read)) : decoded(mark, read) }];
  });
}

/** Sorts marks. */
export function byKind(marks: readonly TakenMark[]): MarksByKind {
  const found: MarksByKind = { drawn: [], offers: [], charts: [], tones: [] };
  for (const { mark, drawn } of marks) {
    if (mark.kind === "offer") found.offers.push({ offer: mark, lines: drawn });
    else if (mark.kind === "chart") found.charts.push(mark);
    else if (mark.kind === "tone") found.tones.push(mark);
    else found.drawn.push(...drawn);
  }
  return found;
}

function decoded(mark: MarkMessage, read: Frame["read"]): DrawnMark[] {
  if (mark.kind === "lines") {
    const { kind, name, meaning, starts, words } = mark;
    return [{ kind, name, meaning, starts, words, ...places(mark, read) }];
  }
  if (mark.kind === "arrows") {
    const { kind, name, meaning, unit, words, tips } = mark;
    return [{ kind, name, meaning, unit, words, tips, vectors: Float32Array.from(read(mark.vectors)), ...places(mark, read) }];
  }
  return mark.kind === "words" || mark.kind === "value" ? [mark] : [];
}

/** Where the points of a mark are; of one at nodes of the shape room for that. */
function places({ points, moved, nodes }: PointPlaces, read: Frame["read"]): { points: Float32Array; moved: Float32Array | null; nodes?: Uint32Array } {
  if (nodes) return { points: new Float32Array(3 * nodes.shape[0]!), moved: null, nodes: Uint32Array.from(read(nodes)) };
  return { points: points ? Float32Array.from(read(points)) : new Float32Array(0), moved: moved ? Float32Array.from(read(moved)) : null };
}
