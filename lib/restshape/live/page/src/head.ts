// The line above the shape: which scene it is, what the last frame was, and whether there is a connection.

import type { App } from "./app";
import { hasEarlierErrors } from "./panels/frame_values";
import type { Painter } from "./panels/painter";
import type { FrameMessage } from "./protocol";

const LINKS = { connecting: "connecting", open: "connected", lost: "no connection: trying again", elsewhere: "goes on in another tab", ended: "the session has ended" };
const COLUMNS = ["level", "ms", "iterations", "estimate"];
const MEANINGS: Record<string, string> = {
  frame: "number of the frame, from 0 on", level: "what the frame reused: 0 all, 1 and 2 parts, 3 nothing", ms: "time that the frame took, in milliseconds",
  iterations: "of the linear solver", estimate: "estimated relative error of the answer; ≈ by an earlier frame",
};

export function showHead(app: App, painter: Painter): void {
  const title = document.getElementById("title")!;
  const status = document.getElementById("status")!;
  const connection = document.getElementById("connection")!;
  app.on("welcome", ({ scene, app: name }) => {
    title.textContent = scene;
    title.title = `${scene} (${name})`;
    document.title = `${scene} – restshape live`;
  });
  app.on("link", (link) => {
    connection.textContent = LINKS[link];
    connection.dataset["state"] = link;
  });
  const cells = new Map<string, HTMLElement>();
  const write = (): void => {
    if (!app.frame) return;
    for (const [name, text] of columns(app.frame.header)) {
      const shown = cell(status, cells, name);
      if (shown.textContent !== text) shown.textContent = text;
    }
  };
  app.on("frame", () => painter.soon(write));
}

function columns(header: FrameMessage): [string, string][] {
  const shown: [string, string][] = [["frame", String(header.number)]];
  for (const name of COLUMNS) {
    const value = header.columns[name];
    const roughly = name === "estimate" && hasEarlierErrors(header) ? "≈ " : "";
    if (typeof value === "number" && Number.isFinite(value)) shown.push([name, roughly + short(value)]);
    else if (typeof value === "string" && value) shown.push([name, value]);
  }
  return shown;
}

/** Three digits, without an exponent where that is short. */
function short(value: number): string { return Number.isInteger(value) ? String(value) : Number(value.toPrecision(3)).toString().replaceAll("-", "−"); }

function cell(status: HTMLElement, cells: Map<string, HTMLElement>, name: string): HTMLElement {
  const known = cells.get(name);
  if (known) return known;
  const group = document.createElement("div");
  const term = document.createElement("dt");
  const value = document.createElement("dd");
  term.textContent = name;
  group.title = MEANINGS[name] ?? "";
  group.append(term, value);
  status.append(group);
  cells.set(name, value);
  return value;
}
