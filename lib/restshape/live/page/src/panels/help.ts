// Help for keyboard and mouse: key ? opens it.

import { button, element } from "./element";

const KEYS: [string, string][] = [
  ["Tab", "goes from one part of the page to the next; in the shape, through what can be held"],
  ["Enter", "takes hold of what is selected, and lets go"],
  ["Arrows", "move what is held, or the picture; with Shift ten times as far, with Alt a tenth"],
  ["Page up, Page down", "move what is held up and down in space"],
  ["Escape", "lets go; ends picking a place"],
  ["Delete", "deletes what is selected"],
  ["H", "goes to the handles that turn and scale what is selected"],
  ["I", "inserts a vertex in the edge that is selected"],
  ["F, + and −", "show all, closer, farther"],
  ["Ctrl+Z", "takes the last edit back"],
  ["Ctrl+Shift+Z, Ctrl+Y", "does it again"],
  ["Ctrl+S", "writes the script"],
  ["R", "lets time go on by itself, or stand still"],
  ["Space", "plays and pauses a recorded script"],
  [", and .", "one frame back, one frame on"],
  ["?", "opens and closes this help"],
];

const MOUSE: [string, string][] = [
  ["Press and drag", "moves what lights up; beside the shape, the picture (in space: turns it)"],
  ["Alt and drag", "pulls a curve, which bends"],
  ["Double click", "inserts a vertex in an edge; beside the shape, shows all"],
  ["Wheel", "closer, farther, towards the pointer"],
  ["Right button", "moves the picture"],
  ["Two fingers", "let go of what is held, and move the picture"],
];

export function showHelp(): HTMLElement {
  const dialog = element("dialog", { class: "help-dialog", "aria-label": "Keys and mouse" });
  const close = button("Close", "Escape", () => dialog.close());
  dialog.append(element("h2", {}, "Mouse and touch"), list(MOUSE), element("h2", {}, "Keys"), list(KEYS), close);
  const toggle = () => {
    if (dialog.open) dialog.close();
    else {
      dialog.showModal();
      dialog.scrollTop = 0;                            // the focus on its button has scrolled it
    }
  };
  addEventListener("keydown", (event) => {
    const at = event.target;
    const typed = at instanceof HTMLElement && at.closest("input:not([type=range], [type=checkbox], [type=radio]), textarea");
    if (event.key !== "?" || typed || event.ctrlKey || event.metaKey) return;
    toggle();
    event.preventDefault();
  });
  const opener = button("?", "keys and mouse (?)", toggle);
  opener.setAttribute("aria-label", "keys and mouse");
  return element("span", {}, opener, dialog);
}

function list(rows: readonly [string, string][]): HTMLElement {
  return element("dl", {}, ...rows.flatMap(([key, what]) => [element("dt", {}, element("kbd", {}, key)), element("dd", {}, what)]));
}
