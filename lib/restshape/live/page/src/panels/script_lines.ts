// Lines of edit scripts as they are read in a list.

import type { ScriptEvent } from "../protocol";

/** The events of a script's text, without its header; lines that are no events are left out. */
export function eventsOf(script: string): ScriptEvent[] {
  const found: ScriptEvent[] = [];
  for (const line of script.split("\n")) {
    if (!line.trim()) continue;
    try {
      const event: unknown = JSON.parse(line);
      if (event !== null && typeof event === "object" && typeof (event as ScriptEvent).do === "string") found.push(event as ScriptEvent);
    } catch { /* a line that is being written */ }
  }
  return found;
}

/** An event in a line: what is done, and its keys. */
export function eventLine(event: ScriptEvent): string {
  const keys = Object.entries(event).filter(([key]) => !["do", "t", "note", "gesture"].includes(key));
  return [event.do, ...keys.map(([key, value]) => `${key} ${valueText(value)}`)].join(" · ");
}

/** Events of which many come one after the other count as one in a list. */
export function continues(before: ScriptEvent | null, event: ScriptEvent): boolean {
  if (!before || before.do !== event.do) return false;
  if (event.do === "set") return before["key"] === event["key"];
  return ["drag", "slide", "idle"].includes(event.do);
}

function valueText(value: unknown): string {
  if (typeof value === "number") return String(Number(value.toPrecision(5)));
  if (Array.isArray(value)) return `(${value.map(valueText).join(", ")})`;
  return typeof value === "string" ? value : JSON.stringify(value);
}
