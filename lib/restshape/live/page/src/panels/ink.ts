// Colours of canvases, read once from the style of the page, and again when light becomes dark.

export interface Ink { text: string; ground: string; faint: string; inside: string; outside: string; limit: string; curves: string[]; }

const listeners = new Set<() => void>();
for (const query of ["(prefers-color-scheme: dark)", "(forced-colors: active)"]) {
  matchMedia(query).addEventListener("change", () => listeners.forEach((then) => then()));
}
new MutationObserver(() => listeners.forEach((then) => then())).observe(document.documentElement, { attributeFilter: ["data-theme", "class"] });

/** Is told when the colours are others. */
export function onNewInk(then: () => void): void {
  listeners.add(then);
}

/** The colours at an element; this asks the browser for its style, so that it is not for each frame. */
export function inkOf(at: Element): Ink {
  const style = getComputedStyle(at);
  const colour = (name: string, otherwise: string) => style.getPropertyValue(name).trim() || otherwise;
  return {
    text: style.color,
    ground: colour("--raised", "#f4f5f7"),
    faint: colour("--line", "#9996"),
    inside: colour("--inside", "#1f6fd0"),
    outside: colour("--outside", "#c8321e"),
    limit: colour("--limit", "#b3261e"),
    curves: ["--accent", "--outside", "--load", "--force", "--soft"].map((name) => colour(name, "#0058a3")),
  };
}
