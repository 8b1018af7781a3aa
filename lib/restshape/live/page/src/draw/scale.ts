// How much larger than they are displacements are drawn.

const WANTED = 0.08; // of the shape's size: the largest displacement as drawn
const SMALLEST = 0.02;
const LARGEST = 0.2;

/** The largest displacement. */
export function largest(shifts: Float32Array): number {
  let most = 0;
  for (let i = 0; i < shifts.length; i += 3) {
    const square = shifts[i]! ** 2 + shifts[i + 1]! ** 2 + shifts[i + 2]! ** 2;
    if (square > most) most = square;
  }
  return Math.sqrt(most);
}

/** A factor that reads well (1, 2, 5, 10, ...) and stays as long as displacements remain visible and inside the picture. */
export function autoScale(before: number, most: number, size: number): number {
  if (!(most > 0) || !(size > 0)) return before;
  const drawn = (before * most) / size;
  if (drawn >= SMALLEST && drawn <= LARGEST) return before;
  return readable((WANTED * size) / most);
}

/** The nearest of 1, 2, 5 times a power of ten that is no larger; 1 for what is between 0.2 and 1. */
export function readable(factor: number): number {
  if (factor < 1 && factor > 0.2) return 1;
  const power = 10 ** Math.floor(Math.log10(factor) + 1e-9);
  const digit = factor / power + 1e-9;
  const round = (digit >= 5 ? 5 : digit >= 2 ? 2 : 1) * power;
  return Number(round.toPrecision(1));
}
