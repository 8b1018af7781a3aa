// How the frame's answer came about and what it cost, and whether frames of a drag are solved or predicted.

import type { App } from "../app";
import { ChangingText, element } from "./element";
import { answerText, hasEarlierErrors, levelText, numberOf, textOf } from "./frame_values";
import type { Painter } from "./painter";
import { digitsText, percentText, siText } from "./si_text";
import type { FrameMessage } from "../protocol";

const SHOWN: Record<string, (frame: FrameMessage) => string> = {
  answer: answerText,
  "error of the answer": errorOfAnswer,
  "error of the prediction": (frame) => shareText(numberOf(frame, "prediction_error")),
  level: levelText,
  time: (frame) => siText(numberOf(frame, "ms") / 1000, "s", 3),
  iterations: (frame) => iterationsText(frame),
  unknowns: (frame) => countText(numberOf(frame, "unknowns")),
  elements: (frame) => countText(numberOf(frame, "elements")),
  limits: limitsText,
  note: (frame) => textOf(frame, "note"),
};

export function showAnswer(app: App, painter: Painter): HTMLElement {
  const rows = Object.entries(SHOWN).map(([name, read]) => {
    const text = new ChangingText();
    return { line: element("div", { hidden: true }, element("dt", {}, name), element("dd", {}, text.node)), text, read };
  });
  const write = () => {
    if (!app.frame) return;
    for (const { line, text, read } of rows) {
      const shown = read(app.frame.header);
      text.set(shown);
      const empty = shown === "";
      if (line.hidden !== empty) line.hidden = empty;
    }
  };
  app.on("frame", () => painter.soon(write));
  return element("div", {}, predictChoice(app), element("dl", { class: "answer" }, ...rows.map((row) => row.line)));
}

/** Solved, or predicted in one of the ways that the scene can. */
function predictChoice(app: App): HTMLElement {
  const group = element("fieldset", { class: "row choice" }, element("legend", {}, "frames of a drag"));
  const hint = element("p", { class: "help", hidden: true });
  const show = () => {
    hint.hidden = way === "none";
    hint.textContent = `The script replays to these frames with --predict ${way}, and to solved ones without.`;
  };
  let way = "none";
  app.on("welcome", ({ predicts, predict }) => {
    way = predict;
    const ways = ["none", ...predicts.filter((way) => way !== "none")];
    const chosen = ways.includes(way) ? way : "none";
    group.replaceChildren(group.firstChild!, ...ways.map((one) => {
      const box = element("input", { type: "radio", name: "predict", value: one, checked: one === chosen });
      box.addEventListener("change", () => {
        way = one;
        show();
        app.send({ type: "show", predict: one as "none" | "linear" | "gmls" });
      });
      return element("label", {}, box, one === "none" ? "solved" : `predicted (${one})`);
    }));
    group.append(hint);
    show();
    group.hidden = ways.length < 2;
  });
  group.hidden = true;
  return group;
}

/** Whether limits hold, and which do not. Those that are no quantities' are among the marks. */
function limitsText(frame: FrameMessage): string {
  const broken = Object.keys(frame.limits).length ? textOf(frame, "violated_constraints") : "";
  return [textOf(frame, "constraint_status"), broken].filter(Boolean).join(": ");
}

/** The frame's error; of one that is not estimated of itself also where it is from. */
export function errorOfAnswer(frame: FrameMessage): string {
  const share = shareText(numberOf(frame, "estimate"));
  return hasEarlierErrors(frame) ? `about ${share}, by an earlier frame and the hand's way since` : share;
}

function shareText(value: number): string {
  return Number.isNaN(value) ? "" : percentText(value);
}

function iterationsText(frame: FrameMessage): string {
  const newton = numberOf(frame, "newton"), linear = countText(numberOf(frame, "iterations"));
  return newton > 0 ? `${linear} linear, ${newton} Newton` : linear;
}

function countText(value: number): string {
  return Number.isNaN(value) ? "" : value >= 1e7 ? digitsText(value) : value.toFixed(0);
}
