// What can be taken hold of, as a list: what is chosen in it lights up in the picture.

import type { App } from "../app";
import type { ThingInfo } from "../protocol";
import { ChangingText, element, mark } from "./element";

const PLURALS: Record<string, string> = {
  vertex: "vertices", edge: "edges", control: "curves by their control points", hole: "holes", group: "groups", body: "bodies",
  support: "supports", plank: "planks", region: "regions", panel: "panels", cloth: "sheets, by any point",
};

export function showThings(app: App): HTMLElement {
  const count = new ChangingText();
  const lists = element("div");
  const body = element("details", { class: "things", hidden: true }, element("summary", {}, "What can be held: ", count.node), lists);
  let known = "";
  let buttons: { thing: ThingInfo; made: HTMLButtonElement }[] = [];
  const select = () => {
    for (const { thing, made } of buttons) mark(made, "aria-pressed", String(thing.name === app.selected?.name && thing.role === app.selected.role));
  };
  const build = () => {
    const roles = byRole(app.things), text = JSON.stringify([...roles].map(([role, things]) => [role, things.map(({ name }) => name)]));
    if (text === known) return;
    known = text;
    count.set([...roles].map(([role, things]) => `${things.length} ${things.length === 1 ? role : PLURALS[role] ?? role}`).join(", "));
    buttons = [];
    lists.replaceChildren(...[...roles].map(([role, things]) => {
      const row = element("div", { class: "row", role: "group", "aria-label": PLURALS[role] ?? role }, element("span", {}, PLURALS[role] ?? role));
      for (const thing of things) {
        const made = element("button", { type: "button", title: "select it: it lights up, and Enter in the picture takes hold" }, thing.name);
        made.addEventListener("click", () => app.tell("selected", thing));
        buttons.push({ thing, made });
        row.append(made);
      }
      return row;
    }));
    body.hidden = app.things.length === 0;
    select();
  };
  app.on("welcome", build);
  app.on("known", ({ things }) => { if (things) build(); });
  app.on("selected", select);
  return body;
}

/** The things by their roles, those of which there are fewest first. */
function byRole(things: readonly ThingInfo[]): Map<string, ThingInfo[]> {
  const found = new Map<string, ThingInfo[]>();
  for (const thing of things) found.set(thing.role, [...(found.get(thing.role) ?? []), thing]);
  return new Map([...found].sort(([, a], [, b]) => a.length - b.length));
}
