// What takes long: since when, what it is, and a button that gives it up.

import type { App } from "../app";
import { button, ChangingText, element } from "./element";

export function showBusy(app: App): HTMLElement {
  const text = new ChangingText();
  let shows = false;                                    // frames of it come meanwhile: it is not over with one
  const cancel = button("Cancel", "give it up; the shape is as it was before", () => {
    app.send({ type: "cancel" });
    cancel.disabled = true;
  });
  const body = element("div", { class: "busy", role: "status", hidden: true },
    element("progress", { "aria-label": "computing" }), element("span", {}, text.node), cancel);
  const end = () => { if (!body.hidden) body.hidden = true; };
  app.on("busy", ({ seconds, what, shows: many }) => {
    shows = many ?? false;
    text.set(`${what} ${seconds.toFixed(seconds < 10 ? 1 : 0)} s`);
    if (body.hidden) cancel.disabled = app.role === "looker";
    // Before the first frame there is none that could be given up.
    cancel.hidden = app.frame === null;
    body.hidden = false;
  });
  for (const over of ["done", "refused", "declined", "rates", "struck", "saved", "written", "welcome"] as const) app.on(over, end);
  app.on("frame", () => { if (!shows) end(); });
  app.on("link", (link) => { if (link === "ended") end(); });
  app.on("lost", ({ restarting }) => {
    shows = false;
    if (!restarting) end();
  });
  return body;
}
