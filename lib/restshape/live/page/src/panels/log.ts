// What was refused, noted, saved and lost, the newest first; read out as it comes.

import { refusedWords, type App } from "../app";
import { button, element } from "./element";

const MOST = 60;

type Kind = "refused" | "note" | "saved" | "lost" | "ended";
const SIGNS: Record<Kind, string> = { refused: "✕ refused", note: "note", saved: "✓ saved", lost: "! lost", ended: "! ended" };

export function showLog(app: App): HTMLElement {
  const list = element("ol", { class: "log", role: "log", "aria-live": "polite", "aria-label": "Messages" });
  const clear = button("Clear", "forget these messages", () => list.replaceChildren());
  let last = "", times = 1;
  const say = (kind: Kind, text: string) => {
    const said = `${kind} ${text}`;
    if (said === last && list.firstElementChild) {
      times += 1;
      list.firstElementChild.querySelector(".times")!.textContent = ` (${times} times)`;
      return;
    }
    [last, times] = [said, 1];
    list.prepend(element("li", { "data-kind": kind }, element("strong", {}, SIGNS[kind]), " ", text, element("span", { class: "times" })));
    while (list.children.length > MOST) list.lastElementChild!.remove();
  };
  app.on("refused", ({ message, place, todo }) => say("refused", [message, place && `at ${place}`, todo].filter(Boolean).join(" · ")));
  app.on("note", (message) => say("note", message));
  app.on("saved", ({ path, events, options }) => say("saved", `${events} events in ${path}${options ? `: replay it with ${options}` : ""}`));
  app.on("lost", ({ message, restarting }) => restarting ? say("lost", `${message}: it begins again with the script so far`) : say("ended", message));
  let refusedBefore = "";
  app.on("frame", ({ header }) => {
    const text = refusedWords(header);
    if (text && text !== refusedBefore) say("refused", text);
    refusedBefore = text;
  });
  return element("div", {}, element("h2", {}, "Messages"), list, element("p", { class: "row" }, clear));
}
