// Where the curves of a plot lie, in pixels.

export interface Axis { low: number; high: number; from: number; to: number; logarithmic: boolean; }

/** The pixel of a value; NaN where it has none. */
export function pixel(axis: Axis, value: number): number {
  const { low, high, from, to } = axis;
  const share = axis.logarithmic ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
  return from + share * (to - from);
}

/** The value at a pixel. */
export function valueAt(axis: Axis, place: number): number {
  const share = (place - axis.from) / (axis.to - axis.from);
  return axis.logarithmic ? axis.low * (axis.high / axis.low) ** share : axis.low + share * (axis.high - axis.low);
}

/** The smallest and largest number among values, (Infinity, -Infinity) where there is none; of positive ones where asked. */
export function extremes(values: ArrayLike<number>, positive = false): [number, number] {
  let low = Infinity, high = -Infinity;
  for (let index = 0; index < values.length; index += 1) {
    const value = values[index]!;
    if (!Number.isFinite(value) || (positive && value <= 0)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return [low, high];
}

/**
 * A polyline through values with at most four points a column of pixels: first, least, greatest and last value of each,
 * so that no peak is lost. NaN parts it.
 *
 * Returns x and y [px] in turn.
 */
export function thinned(x: ArrayLike<number>, y: ArrayLike<number>, across: Axis, up: Axis): number[] {
  const line: number[] = [];
  let column = NaN, first = 0, least = 0, greatest = 0, last = 0;
  const put = (index: number) => line.push(pixel(across, x[index]!), pixel(up, y[index]!));
  const close = () => {
    if (Number.isNaN(column)) return;
    const [one, other] = least < greatest ? [least, greatest] : [greatest, least];
    for (const index of new Set([one, other, last])) if (index !== first) put(index);
    column = NaN;
  };
  for (let index = 0; index < y.length; index += 1) {
    const value = y[index]!;
    if (!Number.isFinite(value) || (up.logarithmic && value <= 0)) {
      close();
      if (line.length && !Number.isNaN(line[line.length - 1]!)) line.push(NaN, NaN);
      continue;
    }
    const here = Math.floor(pixel(across, x[index]!));
    if (here !== column) {
      close();
      column = here;
      put(index);
      first = least = greatest = last = index;
      continue;
    }
    if (value < y[least]!) least = index;
    if (value > y[greatest]!) greatest = index;
    last = index;
  }
  close();
  return line;
}

export interface NamePlace { left: number; row: number; }

/**
 * Where names of upright lines go, so that none covers another one: beside its line, in the first row that is free there.
 *
 * x: of the lines, wide: of their names, both in pixels; from, to: between which names lie; rows: how many there are. A name
 * that finds no place has null.
 */
export function placeNames(x: readonly number[], wide: readonly number[], from: number, to: number, rows: number): (NamePlace | null)[] {
  const taken: { row: number; left: number; right: number }[] = [];
  return x.map((at, index) => {
    const size = wide[index]!;
    for (let row = 0; row < rows; row += 1) {
      for (const left of [at + 3, at - 3 - size]) {
        const right = left + size;
        const free = left >= from && right <= to && taken.every((other) => other.row !== row || left > other.right + 4 || right < other.left - 4);
        if (!free) continue;
        taken.push({ row, left, right });
        return { left, row };
      }
    }
    return null;
  });
}
