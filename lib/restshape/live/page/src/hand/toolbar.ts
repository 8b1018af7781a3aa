// Buttons over the picture: what the hand does, what is done with what is selected, and how the picture is seen.

import type { App, Tool } from "../app";
import type { Scene } from "../draw/scene";
import { savePicture } from "../draw/picture";
import { Video } from "../draw/video";
import { button, element } from "../panels/element";
import type { Pointer } from "./pointer";
import { titleOf, type Targets } from "./targets";
import type { Tools } from "./tools";
import { WAYS, type Way } from "./ways";

const TOOLS: [Tool, string, string, string | null][] = [
  ["hold", "Hold", "take hold and drag", "press"],
  ["pull", "Pull", "bend curves (or hold Alt while pressing)", "pull"],
  ["hole", "Hole", "press at the middle, drag to the radius; stays chosen", "hole"],
  ["arc", "Arc", "drag an edge into an arc", "arc"],
  ["look", "View", "drag moves the picture only", null],
];

export function showToolbars(app: App, scene: Scene, tools: Tools, pointer: Pointer): void {
  const hand = document.getElementById("tools")!;
  const modes = TOOLS.map(([tool, text, title, event]) => {
    const made = button(text, title, () => app.tell("tool", tool));
    return { tool, event, made };
  });
  const selection = element("div", { class: "row selection" });
  hand.append(element("div", { class: "row" }, ...modes.map(({ made }) => made)), selection);
  const arrange = (): void => {
    for (const { tool, event, made } of modes) {
      made.hidden = event !== null && !(event in (app.welcome?.events ?? {}));
      made.disabled = event !== null && app.role !== "hand";
      made.setAttribute("aria-pressed", String(app.tool === tool));
    }
    selection.replaceChildren(...chosen(app, tools, pointer, pointer.targets));
  };
  for (const what of ["welcome", "tool", "role", "selected"] as const) app.on(what, arrange);
  app.on("known", ({ things, events }) => { if (things || events) arrange(); });
  arrange();
  showView(app, scene, pointer);
}

/** Buttons for what is selected. */
function chosen(app: App, tools: Tools, pointer: Pointer, targets: Targets): HTMLElement[] {
  const { selected } = app;
  if (!selected || app.role !== "hand") return [];
  const made: HTMLElement[] = [element("strong", {}, titleOf(selected))];
  if (["edge", "hole", "group", "control"].includes(selected.role) && tools.may("smooth")) {
    made.push(button("Smooth", "fair this curve", () => tools.smooth()));
  }
  const target = targets.find(app.things, selected.name);
  if (selected.role === "edge" && target && tools.may("insert")) {
    made.push(button("Insert vertex", "in the middle of this edge (or double click on it)", () => tools.insert(targets.grip(target))));
  }
  if (["vertex", "hole", "region", "plank"].includes(selected.role) && tools.may("delete")) {
    made.push(button("Delete", "delete this (Delete)", () => tools.remove()));
  }
  if (selected.parameters?.length) made.push(parameters(selected.parameters, pointer));
  return made;
}

function parameters(names: readonly string[], pointer: Pointer): HTMLElement {
  const options = ["", ...names].map((name) => {
    const option = element("option", { value: name }, name || "move freely");
    option.selected = name === (pointer.parameter ?? "");
    return option;
  });
  const list = element("select", { "aria-label": "What of the plank the hand changes" }, ...options);
  list.addEventListener("change", () => { pointer.parameter = list.value || null; });
  return list;
}

function showView(app: App, scene: Scene, pointer: Pointer): void {
  const video = new Video(scene.canvas);
  const film = button("Video", "record the picture as a video", () => film.setAttribute("aria-pressed", String(video.toggle(app.welcome?.scene ?? "live"))));
  film.setAttribute("aria-pressed", "false");
  film.hidden = !video.possible;
  const ways = element("select", { "aria-label": "Way of the hand in space" }, ...WAYS.map((way) => element("option", { value: way }, wayText(way))));
  ways.addEventListener("change", () => { pointer.way = ways.value as Way; });
  ways.hidden = true;
  app.on("welcome", ({ dim }) => { ways.hidden = dim !== 3; });
  document.getElementById("view")!.append(
    ways,
    button("Fit", "show all (F)", () => scene.fit()),
    button("+", "closer (+)", () => scene.view.zoom(1.25)),
    button("−", "farther (−)", () => scene.view.zoom(0.8)),
    button("PNG", "the picture as a file", () => savePicture(scene, app.welcome?.scene ?? "live")),
    film,
  );
}

function wayText(way: Way): string {
  if (way === "screen") return "hand in the screen";
  return way.length === 2 ? `hand in the plane ${way}` : `hand along ${way}`;
}
