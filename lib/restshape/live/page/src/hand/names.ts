// Names for what the hand makes.

/** The first of NAME1, NAME2, ... that is not taken. */
export function newName(begin: string, taken: ReadonlySet<string>): string {
  let number = 1;
  while (taken.has(`${begin}${number}`)) number += 1;
  return `${begin}${number}`;
}
