// Buttons and keys of what is done most: undo, redo, analyse, idle, run, save; recording on and off.

import type { App } from "../app";
import { button, element, mark } from "./element";

/** Whether keys are typed into a field, which has its own undo. */
function typing(event: KeyboardEvent): boolean {
  const at = event.target;
  if (at instanceof HTMLTextAreaElement || (at instanceof HTMLElement && at.isContentEditable)) return true;
  return at instanceof HTMLInputElement && !["range", "checkbox", "radio", "button"].includes(at.type);
}

export function showEditButtons(app: App): HTMLElement {
  const acts: Record<string, [string, string]> = {
    undo: ["Undo", "take the last edit back (Ctrl+Z)"],
    redo: ["Redo", "do it again (Ctrl+Shift+Z)"],
    analyse: ["Analyse", "one analysed frame"],
    idle: ["Idle", "one frame without an edit"],
  };
  const buttons = Object.entries(acts).map(([name, [text, title]]) => {
    const made = button(text, title, () => { app.act({ do: name }); });
    made.dataset["event"] = name;
    return made;
  });
  const run = button("Run", "time goes on by itself while nothing is edited (R)", () => setRun(run.getAttribute("aria-pressed") !== "true"));
  const setRun = (on: boolean) => app.send({ type: "run", on });
  const save = button("Save", "write the script to its file (Ctrl+S)", () => app.send({ type: "save" }));
  const record = button("Record", "write frames to a recording", () => {
    const on = record.getAttribute("aria-pressed") !== "true";
    record.setAttribute("aria-pressed", String(on));
    app.send({ type: "record", on });
  });
  const restart = button("Restart", "begin the simulation again, with the script so far", () => app.send({ type: "restart" }));
  const ask = button("Take the hand", "another page has the hand: ask for it", () => app.send({ type: "hand" }));
  const arrange = () => {
    const known = app.welcome?.events ?? {};
    const looks = app.role === "looker";
    for (const made of buttons) made.disabled = looks || !(made.dataset["event"]! in known);
    record.hidden = !app.welcome?.recordable;
    run.hidden = !app.welcome?.goesOn || app.welcome.player;
    for (const made of [save, record, restart, run]) made.disabled = looks;
    ask.hidden = !app.welcome || !looks;
  };
  app.on("welcome", arrange);
  app.on("role", arrange);
  app.on("frame", ({ header }) => {
    mark(run, "aria-pressed", String(header.runs === true));
    mark(record, "aria-pressed", String(header.records === true));
  });
  addEventListener("keydown", (event) => {
    const plain = !event.ctrlKey && !event.metaKey && !event.altKey && !event.defaultPrevented;
    if (plain && event.key.toLowerCase() === "r" && !typing(event) && !run.hidden && !run.disabled) run.click();
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    const key = event.key.toLowerCase();
    if (key === "s") app.send({ type: "save" });
    else if (typing(event)) return;
    else if (key === "z") app.act({ do: event.shiftKey ? "redo" : "undo" });
    else if (key === "y") app.act({ do: "redo" });
    else return;
    event.preventDefault();
  });
  for (const made of [record, run]) made.setAttribute("aria-pressed", "false");
  arrange();
  return element("div", { class: "row", role: "toolbar", "aria-label": "Edit" }, ...buttons, run, save, record, restart, ask);
}
