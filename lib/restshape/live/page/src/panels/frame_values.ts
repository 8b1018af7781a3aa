// Numbers and words of a frame, by the names that people know.

import type { FrameMessage, QuantityInfo } from "../protocol";

export const QUANTITY = "q_";                        // begins the columns of quantities
const LEVELS = ["idle", "relocation", "reconnection", "reconstruction"];

/** A number of a frame's columns; NaN where it has none. */
export function numberOf(frame: FrameMessage, column: string): number {
  const value: unknown = frame.columns[column];
  return typeof value === "number" ? value : NaN;
}

export function textOf(frame: FrameMessage, column: string): string {
  const value: unknown = frame.columns[column];
  return typeof value === "string" ? value : "";
}

/** The value of a quantity: of the scene, or a column of the application's own. */
export function quantityValue(frame: FrameMessage, name: string): number {
  const value = numberOf(frame, QUANTITY + name);
  return Number.isNaN(value) ? numberOf(frame, name) : value;
}

/** What was reused for a frame, such as "1 relocation". */
export function levelText(frame: FrameMessage): string {
  const level = numberOf(frame, "level");
  return Number.isNaN(level) ? "–" : `${level} ${LEVELS[level] ?? ""}`.trim();
}

/** How the answer of a frame came about. */
export function answerText(frame: FrameMessage): string {
  if (textOf(frame, "refused")) return "refused: as before";
  if (numberOf(frame, "predicted") > 0) return "predicted";
  if (numberOf(frame, "stale") > 0) return "of an earlier shape";
  return "solved";
}

/** Whether a predicted frame has the errors of an earlier one, grown with the way of the hand: it has no residual then. */
export function hasEarlierErrors(frame: FrameMessage): boolean {
  return numberOf(frame, "predicted") > 0 && !Number.isNaN(numberOf(frame, "estimate")) && Number.isNaN(numberOf(frame, "residual"));
}

/** How far a quantity of a predicted frame is from the solution; NaN where that is not known. */
export function distanceOf(frame: FrameMessage, name: string): number { return numberOf(frame, `${name}_distance`); }

/** The sign and word of a limit's status, so that it is told without its colour. */
export const STATUSES = {
  holds: { sign: "✓", word: "holds" },
  uncertain: { sign: "?", word: "uncertain" },
  fails: { sign: "✕", word: "fails" },
} as const;

/** The limits of a quantity with their names, such as "at most". */
export function limitsOf(info: QuantityInfo): { value: number; name: string }[] {
  const found = [];
  if (typeof info.limitLow === "number") found.push({ value: info.limitLow, name: "at least" });
  if (typeof info.limitHigh === "number") found.push({ value: info.limitHigh, name: "at most" });
  return found;
}
