// The panels of the page, each put into its section of index.html.

import type { App } from "../app";
import { showAnswer } from "./answer";
import { showBusy } from "./busy";
import { showEditButtons } from "./edit_buttons";
import { showEvents } from "./events";
import { showHelp } from "./help";
import { showLog } from "./log";
import { showLook } from "./look";
import { showMarks } from "./marks";
import { showNumbers } from "./numbers";
import type { Painter } from "./painter";
import { showPlayer } from "./player";
import { Plots } from "./plots";
import { showQuantities } from "./quantities";
import { showRates } from "./rates";
import { showScript } from "./script_list";
import type { Stage } from "./stage";
import { showThings } from "./things";

/** Puts all panels into the page. */
export function showPanels(app: App, stage: Stage, painter: Painter): void {
  const plots = new Plots(app, painter);
  const quantities = showQuantities(app, painter, (name, on) => plots.choose(name, on));
  const marks = showMarks(app, stage, painter);
  const rates = showRates(app, stage);
  const edit = showEditButtons(app);
  edit.append(showHelp());
  put("panel-edit", edit, showThings(app), showScript(app, painter));
  put("panel-quantities", quantities, marks.words, rates.body, showAnswer(app, painter));
  put("panel-plots", heading("Over the edit"), plots.body);
  put("panel-numbers", heading("Parameters and numbers"), showNumbers(app, painter, rates.of));
  put("panel-offers", marks.offers);
  put("panel-charts", marks.charts);
  put("panel-sound", marks.sound);
  put("panel-events", heading("Events"), showEvents(app, stage));
  put("panel-look", showLook(app));
  put("panel-notes", showLog(app));
  put("player", showPlayer(app));
  put("stage", showBusy(app));
  showWhatThereIs(app);
}

/** Nothing is shown before the first frame, and then no panel that has nothing in it. */
function showWhatThereIs(app: App): void {
  const panels = document.getElementById("panels")!;
  panels.dataset["empty"] = "";
  app.on("welcome", ({ numbers, events }) => {
    document.getElementById("panel-numbers")!.hidden = numbers.length === 0;
    document.getElementById("panel-events")!.hidden = Object.keys(events).length === 0;
  });
  app.on("frame", () => { delete panels.dataset["empty"]; });
}

function heading(text: string): HTMLElement {
  const made = document.createElement("h2");
  made.textContent = text;
  return made;
}

function put(id: string, ...bodies: HTMLElement[]): void {
  document.getElementById(id)?.append(...bodies);
}
