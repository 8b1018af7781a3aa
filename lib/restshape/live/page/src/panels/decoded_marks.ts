// Marks of a frame with their arrays, and by their kind.

import type { Frame } from "../app";
import type { MarkMessage } from "../protocol";
import type { DrawnMark } from "./stage";

export type Offer = Extract<MarkMessage, { kind: "offer" }>;
export type ChartMark = Extract<MarkMessage, { kind: "chart" }>;
export type ToneMark = Extract<MarkMessage, { kind: "tone" }>;

/** An offer, and what it would look like. */
export interface ShownOffer { offer: Offer; lines: DrawnMark[]; }

export interface MarksByKind { drawn: DrawnMark[]; offers: ShownOffer[]; charts: ChartMark[]; tones: ToneMark[]; }

/** Sorts the marks of a frame. Arrays are copied, for they are drawn after the message is gone. */
export function byKind(marks: MarkMessage[], read: Frame["read"]): MarksByKind {
  const found: MarksByKind = { drawn: [], offers: [], charts: [], tones: [] };
  for (const mark of marks) {
    if (mark.kind === "offer") found.offers.push({ offer: mark, lines: mark.lines.flatMap((line) => decoded(line, read)) });
    else if (mark.kind === "chart") found.charts.push(mark);
    else if (mark.kind === "tone") found.tones.push(mark);
    else found.drawn.push(...decoded(mark, read));
  }
  return found;
}

function decoded(mark: MarkMessage, read: Frame["read"]): DrawnMark[] {
  const copy = (place: Parameters<Frame["read"]>[0]) => Float32Array.from(read(place));
  if (mark.kind === "lines") {
    const { kind, name, meaning, starts, words } = mark;
    return [{ kind, name, meaning, starts, words, points: copy(mark.points), moved: mark.moved ? copy(mark.moved) : null }];
  }
  if (mark.kind === "arrows") {
    const { kind, name, meaning, unit, words, tips } = mark;
    const moved = mark.moved ? copy(mark.moved) : null;
    return [{ kind, name, meaning, unit, words, tips, moved, points: copy(mark.points), vectors: copy(mark.vectors) }];
  }
  return mark.kind === "words" ? [mark] : [];
}
