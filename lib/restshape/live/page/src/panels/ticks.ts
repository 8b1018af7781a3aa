// Ticks of axes: round numbers between two values.

/** Round numbers (1, 2 or 5 times a power of ten apart) from low to high, about `count` of them. */
export function ticks(low: number, high: number, count = 4): number[] {
  if (!(high > low) || !Number.isFinite(low) || !Number.isFinite(high)) return Number.isFinite(low) ? [low] : [];
  const rough = (high - low) / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  const share = rough / power;
  const step = power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
  const found: number[] = [];
  for (let index = Math.ceil(low / step - 1e-9); index * step <= high + 1e-9 * step; index += 1) {
    found.push(Number((index * step).toPrecision(12)));
  }
  return found;
}

/** Powers of ten from low to high, both positive; at most about `count`, further apart where there would be more. */
export function powerTicks(low: number, high: number, count = 5): number[] {
  if (!(low > 0) || !(high >= low)) return [];
  const first = Math.ceil(Math.log10(low) - 1e-9), last = Math.floor(Math.log10(high) + 1e-9);
  const step = Math.max(1, Math.ceil((last - first + 1) / count));
  const found: number[] = [];
  for (let power = first; power <= last; power += step) found.push(Number(`1e${power}`));
  return found;
}

/** The range of an axis around values: with a margin, and never empty. */
export function axisRange(low: number, high: number, logarithmic = false): [number, number] {
  if (!(low <= high)) return logarithmic ? [0.1, 10] : [0, 1];
  if (logarithmic) {
    const grown = Math.max((high / low) ** 0.05, 1.2);
    return [low / grown, high * grown];
  }
  const size = Math.max(Math.abs(low), Math.abs(high));
  // What differs by less than a thousandth is drawn as nearly level.
  const margin = Math.max(0.06 * (high - low), 1e-3 * size) || 1;
  return [low - margin, high + margin];
}

const RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/** Labels of powers of ten: 0.01, 100, 10⁻⁶. */
export function powerLabels(values: number[]): string[] {
  return values.map((value) => {
    const power = Math.round(Math.log10(value));
    if (power >= -3 && power <= 4) return String(value);
    return `10${power < 0 ? "⁻" : ""}${[...String(Math.abs(power))].map((digit) => RAISED[Number(digit)]).join("")}`;
  });
}

/** Labels of ticks, with as many decimals as tell them apart. */
export function tickLabels(values: number[]): string[] {
  const step = values.length > 1 ? Math.min(...values.slice(1).map((value, index) => value - values[index]!)) : Math.abs(values[0] ?? 1) || 1;
  const largest = Math.max(...values.map(Math.abs), 0);
  if (largest >= 1e6 || (largest > 0 && largest < 1e-3)) {
    return values.map((value) => (value === 0 ? "0" : Number(value.toPrecision(3)).toExponential().replace("e+", "e")).replaceAll("-", "−"));
  }
  const decimals = Math.min(Math.max(0, -Math.floor(Math.log10(step) + 1e-9)), 8);
  return values.map((value) => value.toFixed(decimals).replace("-", "−"));
}
