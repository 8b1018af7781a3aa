// The events done so far: the script of this session. Drags and slides of many frames take one line.

import type { App } from "../app";
import type { ScriptEvent } from "../protocol";
import { ChangingText, element } from "./element";
import type { Painter } from "./painter";
import { continues, eventLine, eventsOf } from "./script_lines";

const MOST = 300;                                       // lines that are shown

interface Line { event: ScriptEvent; times: number; text: ChangingText; item: HTMLLIElement; }

export function showScript(app: App, painter: Painter): HTMLElement {
  const list = element("ol", { class: "script", tabindex: 0, "aria-label": "Events done" });
  const count = new ChangingText();
  const body = element("details", { class: "script-panel" }, element("summary", {}, "Script ", count.node), list);
  const waiting: ScriptEvent[] = [];
  let last: Line | null = null, many = 0;
  const write = () => {
    for (const event of waiting) last = added(list, last, event);
    waiting.length = 0;
    count.set(`(${many === 1 ? "1 event" : `${many} events`})`);
    if (body.open) list.lastElementChild?.scrollIntoView({ block: "nearest" });
  };
  const add = (text: string) => {
    const events = eventsOf(text);
    many += events.length;
    // An event is left out that the list would lose at once.
    waiting.push(...events.slice(-4 * MOST));
    painter.soon(write);
  };
  app.on("welcome", ({ script }) => {
    list.replaceChildren();
    waiting.length = many = 0;
    last = null;
    add(script);
  });
  app.on("written", ({ lines }) => add(lines));
  return body;
}

function added(list: HTMLElement, last: Line | null, event: ScriptEvent): Line {
  if (last && continues(last.event, event)) {
    last.times += 1;
    last.event = event;
    last.text.set(`${eventLine(event)} (${last.times} times)`);
    return last;
  }
  const text = new ChangingText();
  text.set(eventLine(event));
  const item = element("li", {}, text.node);
  list.append(item);
  while (list.children.length > MOST) list.firstElementChild!.remove();
  return { event, times: 1, text, item };
}
