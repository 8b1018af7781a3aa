// The quantities of the frame: values with units, estimated errors, limits and whether they hold.

import { refusedWords, type App } from "../app";
import type { FrameMessage, QuantityInfo } from "../protocol";
import { ChangingText, element, mark } from "./element";
import { distanceOf, hasEarlierErrors, limitsOf, quantityValue, STATUSES } from "./frame_values";
import type { Painter } from "./painter";
import { distanceText, errorText, siText } from "./si_text";

const PLOTTED = 3;                                     // the first ones are plotted from the start

interface Row { info: QuantityInfo; value: ChangingText; error: ChangingText; status: ChangingText; limits: ChangingText; line: HTMLElement; last: Shown | null; }
/** What a row says of a frame. */
interface Shown { value: string; error: string; status: FrameMessage["limits"][string] | undefined; }

/** `plotted`: is told which quantities are chosen for plots. */
export function showQuantities(app: App, painter: Painter, plotted: (name: string, on: boolean) => void): HTMLElement {
  const body = element("tbody");
  const table = element("table", { class: "quantities" },
    element("caption", {}, "Quantities"),
    element("thead", {}, element("tr", {}, ...["quantity", "value", "limit", "plot"].map((title) => element("th", { scope: "col" }, title)))),
    body);
  let rows: Row[] = [];
  const build = (quantities: QuantityInfo[]) => {
    // Limits that are formulas change with their parameters: the rows stay.
    if (quantities.length !== rows.length || quantities.some((info, index) => info.name !== rows[index]!.info.name)) {
      rows = quantities.map((info, index) => rowOf(info, index < PLOTTED, plotted));
      body.replaceChildren(...rows.map((row) => row.line));
      table.hidden = rows.length === 0;
    }
    rows.forEach((row, index) => {
      row.info = quantities[index]!;
      row.limits.set(limitText(row.info));
    });
    write();
  };
  const write = () => { if (app.frame) for (const row of rows) update(row, app.frame.header); };
  app.on("welcome", ({ quantities }) => build(quantities));
  app.on("known", ({ quantities }) => { if (quantities) painter.soon(() => build(quantities)); });
  app.on("frame", () => painter.soon(write));
  table.hidden = true;
  return table;
}

function rowOf(info: QuantityInfo, chosen: boolean, plotted: (name: string, on: boolean) => void): Row {
  const value = new ChangingText(), error = new ChangingText(), status = new ChangingText(), limits = new ChangingText();
  const box = element("input", { type: "checkbox", "aria-label": `plot ${info.name}`, checked: chosen });
  box.addEventListener("change", () => plotted(info.name, box.checked));
  const line = element("tr", {},
    element("th", { scope: "row" }, ...breakable(info.name)),
    element("td", { class: "value" }, value.node, element("small", {}, error.node)),
    element("td", { class: "limit" }, element("span", { class: "status" }, status.node), element("small", {}, limits.node)),
    element("td", {}, box));
  plotted(info.name, chosen);
  return { info, value, error, status, limits, line, last: null };
}

/** A name as it is written, which a narrow column breaks after its underscores. */
function breakable(name: string): (Node | string)[] {
  return name.split(/(?<=_)/).flatMap((part, index) => (index ? [element("wbr"), part] : [part]));
}

function update(row: Row, frame: FrameMessage): void {
  const { value, error, status } = shownOf(row, frame);
  row.value.set(value);
  row.error.set(error);
  // The line below the value stays once it was there: rows do not change their height from frame to frame.
  if (error) mark(row.line, "data-estimated", "");
  row.status.set(status ? `${STATUSES[status].sign} ${STATUSES[status].word}` : "");
  mark(row.line, "data-limit", status ?? null);
}

/** What a frame says of a quantity; a refused one has no answer of its own, and leaves what was known. */
function shownOf(row: Row, frame: FrameMessage): Shown {
  const { name, unit } = row.info, value = quantityValue(frame, name);
  const known = !Number.isNaN(value);
  if (!known && row.last && refusedWords(frame)) return { ...row.last, error: "as before" };
  const distance = distanceText(distanceOf(frame, name), value, unit, hasEarlierErrors(frame));
  const now = { value: siText(value, unit), error: errorText(frame.errors[name], value, unit) || distance, status: known ? frame.limits[name] : undefined };
  row.last = known ? now : null;
  return now;
}

function limitText(info: QuantityInfo): string {
  const values = limitsOf(info).map((limit) => siText(limit.value, info.unit, 3));
  return values.length > 1 ? values.join(" to ") : limitsOf(info).map((limit) => `${limit.name} ${values[0]!}`).join("");
}
