// Numbers of the scene at a slider or a keyboard: their units, ranges and steps.

import type { NumberInfo, ScriptEvent } from "../protocol";
import { quantityOf } from "./typed_values";

const WITH_UNIT = /^\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)\s*(\S.*?)?\s*$/i;

/** Text of a scene such as "10 mm" as its number and unit; a formula has none. */
export function textParts(text: string): { number: number; unit: string } | null {
  const found = WITH_UNIT.exec(text.replace("−", "-"));
  return found ? { number: Number(found[1]), unit: found[2] ?? "" } : null;
}

const DIGITS = 7; // that have room in a field

/** Text of a scene as a field shows it: what a hand has made of a number has digits that nobody reads. */
export function shownText(text: string): string {
  const parts = textParts(text);
  if (!parts || !text.includes(".") || text.replace(/e.*|\D/gi, "").length <= DIGITS) return text;
  const number = String(Number(parts.number.toPrecision(DIGITS)));
  return parts.unit ? `${number} ${parts.unit}` : number;
}

/** What is sent for typed text: a bare number has the unit that the scene writes there. */
export function typedValue(typed: string, before: string): number | string | null {
  const value = quantityOf(typed);
  const unit = textParts(before)?.unit ?? "";
  return typeof value === "number" && unit ? `${typed.trim()} ${unit}` : value;
}

const WIDE = 20;                                       // times a number's size: bounds that far apart are no range

export interface SliderRange { low: number; high: number; step: number; unit: string; factor: number; }

/** The range of a slider in the unit that the scene writes, which is `factor` of the number's own. */
export function sliderRange(info: NumberInfo): SliderRange {
  const parts = textParts(info.text);
  const factor = parts && parts.unit && info.value !== 0 && parts.number !== 0 ? parts.number / info.value : 1;
  const unit = factor === 1 && !(parts?.unit && parts.number === info.value) ? "" : parts!.unit;
  const value = info.value * factor;
  const size = Math.abs(value) || 1;
  const least = (info.low ?? -Infinity) * factor, most = (info.high ?? Infinity) * factor;
  let low = value > 0 ? value / 2 : value - size, high = value > 0 ? value * 2 : value + size;
  // Bounds that lie far apart say what is possible, not what is near.
  if (most - least <= WIDE * size) [low, high] = [least, most];
  else [low, high] = [Math.max(low, least), Math.min(high, most)];
  if (info.whole) return { low: Math.floor(low), high: Math.max(Math.ceil(high), Math.floor(low) + 1), step: 1, unit, factor };
  const step = 10 ** Math.floor(Math.log10(Math.max(high - low, Number.MIN_VALUE)) - 2.4);
  return { low: rounded(low, step), high: rounded(high, step), step, unit, factor };
}

/** A multiple of a power of ten without digits beyond it. */
export function rounded(value: number, step: number): number {
  const decimals = Math.min(Math.max(0, -Math.floor(Math.log10(step) + 1e-9)), 15);
  return Number((Math.round(value / step) * step).toFixed(decimals));
}

/** The event that gives a number the place of its slider. */
export function slid(info: NumberInfo, range: SliderRange, place: number): ScriptEvent {
  return { do: "set", key: info.key, value: range.unit ? `${place} ${range.unit}` : place };
}

/** The numbers whose keys hold all words that are searched for, parameters first. */
export function foundNumbers(numbers: NumberInfo[], words: string, most: number): { shown: NumberInfo[]; more: number } {
  const wanted = words.toLowerCase().split(/\s+/).filter(Boolean);
  const found = numbers.filter((one) => wanted.every((word) => one.key.toLowerCase().includes(word)));
  return { shown: found.slice(0, most), more: Math.max(0, found.length - most) };
}
