// How frames are drawn: field, colours, scale of the deformation, wireframe, marks.

import type { App, Look } from "../app";
import { COLOUR_MAPS } from "../draw/colour_maps";
import { element } from "./element";

const COLOURS = { auto: "by the field", ...Object.fromEntries(COLOUR_MAPS.map((name) => [name, name])), none: "none" };
const SWITCHES: [keyof Look & ("wireframe" | "rest" | "handles"), string][] = [
  ["wireframe", "edges of the mesh"], ["rest", "outline before deformation"], ["handles", "what can be held"],
];

export function showLook(app: App): HTMLElement {
  const field = element("select", {});
  field.addEventListener("change", () => app.send({ type: "show", field: field.value }));
  app.on("welcome", (welcome) => {
    field.replaceChildren(...welcome.fields.map((one) => element("option", { value: one.name }, one.unit && one.unit !== "1" ? `${one.label} [${one.unit}]` : one.label)));
    field.value = welcome.field;
  });
  const colours = element("select", {}, ...Object.entries(COLOURS).map(([name, text]) => element("option", { value: name }, text)));
  colours.addEventListener("change", () => app.changeLook({ colours: colours.value }));
  const marks = checkbox("marks", true, (on) => app.send({ type: "show", marks: on }));
  const switches = SWITCHES.map(([name, text]) => ({ name, ...checkbox(text, app.look[name], (on) => app.changeLook({ [name]: on })) }));
  const scale = scaleLine(app);
  app.on("look", (look) => {
    colours.value = look.colours;
    for (const { name, box } of switches) box.checked = look[name];
    scale.update(look);
  });
  return element("div", { class: "look" }, element("h2", {}, "Picture"),
    labelled("field", field), labelled("colours", colours), scale.body,
    element("div", { class: "switches" }, ...switches.map((one) => one.label), marks.label), themeLine());
}

/** The factor by which displacements are drawn: chosen by the page, or by hand from 1 on. */
function scaleLine(app: App): { body: HTMLElement; update(look: Look): void } {
  const auto = checkbox("chosen by the page", app.look.autoScale, (on) => app.changeLook({ autoScale: on }));
  const text = element("input", { type: "text", inputmode: "decimal", size: 6, "aria-label": "scale of the deformation" });
  const slider = element("input", { type: "range", min: -2, max: 5, step: 0.02, "aria-label": "scale of the deformation, slider" });
  const one = element("button", { type: "button", title: "draw displacements as they are", click: () => choose(1) }, "1 : 1");
  const choose = (scale: number) => { if (scale >= 0 && Number.isFinite(scale)) app.changeLook({ scale, autoScale: false }); };
  text.addEventListener("change", () => choose(text.value.trim() ? Number(text.value) : NaN));
  slider.addEventListener("input", () => choose(Number((10 ** Number(slider.value)).toPrecision(3))));
  let drawn = app.look.scale;
  const show = (scale: number) => {
    if (document.activeElement !== text) text.value = String(Number(scale.toPrecision(3)));
    if (document.activeElement !== slider) slider.value = String(Math.log10(Math.max(scale, 0.01)));
  };
  const update = (look: Look) => {
    auto.box.checked = look.autoScale;
    show(look.autoScale ? drawn : look.scale);
  };
  update(app.look);
  app.on("scaled", (scale) => show((drawn = scale)));
  const body = element("div", { class: "scale-line" }, element("span", {}, "deformation ×"), text, one, auto.label, slider);
  app.on("welcome", ({ trueScale }) => { body.hidden = trueScale; });
  return { body, update };
}

/** Light, dark, or as the system is; kept for the next time. */
function themeLine(): HTMLElement {
  const choice = element("select", {}, ...["as the system", "light", "dark"].map((name) => element("option", { value: name }, name)));
  const show = () => {
    if (choice.value === "light" || choice.value === "dark") document.documentElement.dataset["theme"] = choice.value;
    else delete document.documentElement.dataset["theme"];
  };
  choice.value = stored("theme") ?? "as the system";
  choice.addEventListener("change", () => {
    show();
    try { localStorage.setItem("theme", choice.value); } catch { /* no storage: it holds for this page */ }
  });
  if (choice.selectedIndex < 0) choice.selectedIndex = 0;
  show();
  return labelled("theme", choice);
}

function stored(key: string): string | null {
  try { return localStorage.getItem(key); } catch { return null; }
}

function checkbox(text: string, on: boolean, changed: (on: boolean) => void): { label: HTMLLabelElement; box: HTMLInputElement } {
  const box = element("input", { type: "checkbox", checked: on });
  box.addEventListener("change", () => changed(box.checked));
  return { label: element("label", {}, box, text), box };
}

function labelled(text: string, control: HTMLElement): HTMLElement {
  return element("label", { class: "row" }, element("span", {}, text), control);
}
