// Derivatives of quantities in words.

import { percentText, siText } from "./si_text";

const WAYS = ["x", "y", "z"];

/** How far an arrow along x is turned [degrees, clockwise as pictures count] to show where a quantity grows; null: nowhere. */
export function arrowTurn(rate: number[]): number | null {
  const [x = 0, y = 0] = rate;
  if (rate.length > 2 || (x === 0 && y === 0) || !Number.isFinite(x + y)) return null;
  return rate.length === 1 ? (x > 0 ? 0 : 180) : (Math.atan2(-y, x) * 180) / Math.PI;
}

/**
 * A derivative for each millimetre where it is per metre, along x, y and z, and what that is of the value.
 *
 * unit: of the derivative, such as "Pa/m"; value: of the quantity.
 */
export function rateText(rate: number[], unit: string, value: number): string {
  const metres = unit.endsWith("/m");
  const step = metres ? 1e-3 : 1;
  const own = metres ? unit.slice(0, -2) : unit;
  const size = Math.max(...rate.map((one) => Math.abs(one * step)).filter(Number.isFinite), 0);
  if (size === 0) return "does not change";
  const parts = rate.map((one, index) => {
    const sign = one > 0 ? "+" : "";
    return `${sign}${siText(one * step, own, 3, size)}${metres ? "/mm" : ""}${rate.length > 1 ? ` in ${WAYS[index]}` : ""}`;
  });
  const share = Math.hypot(...rate) * step / Math.abs(value);
  return `${parts.join(", ")}${metres && Number.isFinite(share) ? ` (${percentText(share)} of it per mm)` : ""}`;
}
