// What the lines, dots and arrows in the picture are that have no words beside them.

import { element } from "./element";
import type { DrawnMark } from "./stage";

const MOST = 5; // entries; a picture has no room for more

export interface Entry { sign: string; name: string; meaning: string; }

/** The entries for marks of a frame, each name once. */
export function entriesOf(marks: readonly DrawnMark[]): Entry[] {
  const found = new Map<string, Entry>();
  for (const mark of marks) {
    if (mark.kind === "words" || mark.kind === "value" || !mark.name || mark.words.some(Boolean) || !mark.points.length) continue;
    const dots = mark.kind === "lines" && mark.starts.length === mark.points.length / 3;
    found.set(mark.name, { sign: mark.kind === "arrows" ? "→" : dots ? "●" : "—", name: mark.name, meaning: mark.meaning });
  }
  const all = [...found.values()], more = all.length - MOST;
  return more > 0 ? [...all.slice(0, MOST), { sign: "…", name: `and ${more} more`, meaning: "guide" }] : all;
}

/** Shows entries where they are others than before. */
export function showLegend(): { show: (marks: readonly DrawnMark[]) => void } {
  const list = document.getElementById("legend")!;
  let shown = "";
  return {
    show: (marks) => {
      const entries = entriesOf(marks), asked = JSON.stringify(entries);
      if (asked === shown) return;
      shown = asked;
      list.hidden = !entries.length;
      list.replaceChildren(...entries.map(({ sign, name, meaning }) => {
        const line = element("li", {}, element("span", { "aria-hidden": "true" }, `${sign} `), name);
        line.style.color = `var(--${meaning}, var(--guide))`;
        return line;
      }));
    },
  };
}
