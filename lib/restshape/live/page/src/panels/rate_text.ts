// Derivatives of quantities in words.

import { percentText, siText } from "./si_text";

const NOTHING = 1e-7;                                   // of a value: smaller changes are of the solver
export const UNCHANGED = "does not change";
const WAYS = ["x", "y", "z"];

/** How far an arrow along x is turned [degrees, clockwise as pictures count] to show where a quantity grows; null: nowhere. */
export function arrowTurn(rate: number[]): number | null {
  const [x = 0, y = 0] = rate;
  if (rate.length > 2 || (x === 0 && y === 0) || !Number.isFinite(x + y)) return null;
  return rate.length === 1 ? (x > 0 ? 0 : 180) : (Math.atan2(-y, x) * 180) / Math.PI;
}

/**
 * How a quantity changes with a place: for each millimetre along x, y and z, and what that is of the value.
 *
 * rate: in `unit` a metre; unit, value: of the quantity.
 */
export function rateText(rate: number[], unit: string, value: number): string {
  const steps = rate.map((one) => one / 1000);
  const size = Math.max(...steps.map(Math.abs).filter(Number.isFinite), 0);
  if (!(size > NOTHING * Math.abs(value))) return UNCHANGED;
  // One way alone may matter: of the others there is noise.
  const clean = steps.map((one) => (Math.abs(one) > NOTHING * size ? one : 0));
  const parts = clean.map((one, index) => `${one > 0 ? "+" : ""}${siText(one, unit, 3, size)} in ${WAYS[index]}`);
  const share = Math.hypot(...steps) / Math.abs(value);
  return `${parts.join(", ")} a mm${Number.isFinite(share) ? ` (${percentText(share)})` : ""}`;
}

/** How a quantity changes with a number of the scene: what one percent more of the number makes of it. */
export function shareText(rate: number, number: number, unit: string, value: number): string {
  const change = 0.01 * number * rate;
  if (!(Math.abs(change) > NOTHING * Math.abs(value))) return UNCHANGED;
  const sign = change > 0 ? "+" : "";
  const share = change / Math.abs(value);
  return `${sign}${siText(change, unit, 3)}${Number.isFinite(share) ? ` (${sign}${percentText(share)})` : ""}`;
}

/** Whether a quantity changes with a place at all. size: of its derivative, in its unit a metre. */
export function fallsAtAll(size: number, value: number): boolean { return Number.isFinite(size) && size / 1000 > NOTHING * Math.abs(value); }

/** How fast a quantity falls, beside the arrow that shows which way. */
export function fallText(name: string, size: number, unit: string, value: number): string {
  const step = size / 1000, share = step / Math.abs(value);
  return `${name} falls by ${siText(step, unit, 3)} a mm${Number.isFinite(share) ? ` (${percentText(share)})` : ""}`;
}
