// Every event of edit scripts as a form.

import type { App } from "../app";
import type { ScriptEvent } from "../protocol";
import { element } from "./element";
import { EventForm } from "./event_form";
import { eventText } from "./schema_fields";
import type { Stage } from "./stage";

const NAMES = "names-of-things", KEYS = "keys-of-numbers";

export function showEvents(app: App, stage: Stage): HTMLElement {
  const names = element("datalist", { id: NAMES }), keys = element("datalist", { id: KEYS });
  const choice = element("select", { "aria-label": "event" });
  const text = element("p", { class: "help" });
  const place = element("div");
  let form: EventForm | null = null;
  let selected = "", schemas = "";
  const send = (event: ScriptEvent) => { app.act(event); };
  const show = () => {
    const schema = app.welcome?.events[choice.value];
    if (!schema || !hasForm(schema)) return;
    form = new EventForm(choice.value, schema, { lists: { names: NAMES, keys: KEYS }, pick: (what) => stage.pick(`press at ${what} in the picture`), send });
    text.textContent = eventText(schema);
    place.replaceChildren(form.body);
    if (selected) form.suggest(selected);
  };
  const offer = (events: Record<string, object>) => {
    const before = choice.value, now = JSON.stringify(events);
    // A page that has come back keeps what is typed.
    if (now === schemas || !Object.values(events).every(hasForm)) return;
    schemas = now;
    const known = Object.keys(events).sort();
    choice.replaceChildren(...known.map((name) => element("option", { value: name }, name)));
    choice.value = known.includes(before) ? before : known.includes("set") ? "set" : known[0] ?? "";
    show();
  };
  choice.addEventListener("change", show);
  app.on("welcome", (welcome) => {
    fill(names, app.things.map((thing) => thing.name));
    fill(keys, welcome.numbers.map((number) => number.key));
    offer(welcome.events);
  });
  app.on("known", (known) => {
    if (known.things) fill(names, known.things.map((thing) => thing.name));
    if (known.numbers) fill(keys, known.numbers.map((number) => number.key));
    if (known.events) offer(known.events);
  });
  app.on("selected", (thing) => {
    selected = thing?.name ?? "";
    if (selected) form?.suggest(selected);
  });
  return element("div", { class: "events" }, element("label", { class: "row" }, element("span", {}, "do"), choice), text, place, names, keys);
}

function fill(list: HTMLDataListElement, values: string[]): void {
  list.replaceChildren(...[...new Set(values)].map((value) => element("option", { value })));
}

/** Whether the schema of an event has come: names alone come before. */
function hasForm(schema: object): boolean { return "properties" in schema; }
