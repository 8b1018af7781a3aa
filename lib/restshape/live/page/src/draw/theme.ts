// Colours of the page's style sheet for what is drawn: light or dark as the page is.

import { Color } from "three";

export class Theme {
  private readonly known = new Map<string, Color>();

  /** The colour of a custom property, such as "ink"; the same object stays the colour when the page turns dark. */
  colour(name: string): Color {
    const known = this.known.get(name);
    if (known) return known;
    const made = new Color(read(name));
    this.known.set(name, made);
    return made;
  }

  /** Calls `then` when the page has turned light or dark. */
  onChange(then: () => void): void {
    const again = (): void => {
      for (const [name, colour] of this.known) colour.set(read(name));
      then();
    };
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", again);
    new MutationObserver(again).observe(document.documentElement, { attributes: true, attributeFilter: ["data-theme"] });
  }
}

function read(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim() || "#808080";
}
