// Numbers with units and SI prefixes, as the console and the pictures of restshape write them.

const PREFIXES: Record<number, string> = {
  [-12]: "p", [-9]: "n", [-6]: "µ", [-3]: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T",
};
// Units whose prefix would be read for another one, or is not used.
const UNPREFIXED = ["ms", "1", "m²", "m^2", "m³", "m^3", "kg", "K", "deg", "°", "cent", "%"];

/** The factor and unit in which a number of this size reads well, such as 1e-6 and "MPa". */
export function scaledUnit(size: number, unit: string): { factor: number; unit: string } {
  const shown = unit === "1" ? "" : unit.replace("^2", "²").replace("^3", "³");
  if (!shown || !Number.isFinite(size) || size === 0 || UNPREFIXED.some((begin) => unit.startsWith(begin))) {
    return { factor: 1, unit: shown };
  }
  const rounded = Math.abs(Number(size.toPrecision(5)));
  const power = Math.min(Math.max(3 * Math.floor(Math.log10(rounded) / 3 + 1e-12), -12), 12);
  return { factor: 10 ** -power, unit: PREFIXES[power] + shown };
}

/** A number to some significant digits, without an exponent where it is between 1e-4 and 1e7. */
export function digitsText(value: number, digits = 4): string {
  if (Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  if (value === 0) return "0";
  const size = Math.abs(value);
  let text: string;
  if (size !== 0 && (size >= 1e7 || size < 1e-4)) {
    text = value.toExponential(digits - 1).replace("e+", "e");
  } else {
    const whole = size < 1 ? 1 : Math.floor(Math.log10(size)) + 1;
    text = whole >= digits ? value.toFixed(0) : value.toPrecision(digits);
  }
  return text.replaceAll("-", "−");
}

/** A value with its unit, such as 240.9 MPa. `like`: a number whose prefix it takes. */
export function siText(value: number, unit: string, digits = 4, like = value): string {
  if (Number.isNaN(value)) return "–";
  const scale = scaledUnit(like, unit);
  const text = digitsText(value * scale.factor, digits);
  return scale.unit ? `${text} ${scale.unit}` : text;
}

const ROUNDING = 1e-9;                                 // share of a value below which its error is rounding

/** A quantity beside the place of its extreme, with its estimated error where there is one, as pictures of restshape have it. */
export function extremeText(name: string, value: number, error: number | null | undefined, unit: string): string {
  const known = typeof error === "number" && Number.isFinite(error);
  const size = known && Math.abs(error) >= ROUNDING * Math.abs(value) ? Math.abs(error) : 0;
  return `${name} ${siText(value, unit)}${known ? ` (error ${siText(size, unit, 2)})` : ""}`;
}

/** An estimated error beside its value: "error 2.1 MPa (0.9 %)"; empty where none is estimated. null: it is infinite. */
export function errorText(error: number | null | undefined, value: number, unit: string): string {
  if (error === undefined || Number.isNaN(error)) return "";
  if (error === null || !Number.isFinite(error)) return "no limit under refinement";
  const share = Math.abs(error / value);
  const percent = Number.isFinite(share) ? ` (${percentText(share)})` : "";
  return `error ${siText(Math.abs(error), unit, 2, value)}${percent}`;
}

/** How far a predicted value is from the solution: "off by 2.1 MPa (0.9 %)"; empty where that is not known. roughly: by an earlier frame. */
export function distanceText(distance: number, value: number, unit: string, roughly: boolean): string {
  return Number.isNaN(distance) ? "" : errorText(distance, value, unit).replace("error", roughly ? "off by about" : "off by");
}

/** A share as a percentage of two digits. */
export function percentText(share: number): string {
  return `${digitsText(100 * share, 2)} %`;
}
