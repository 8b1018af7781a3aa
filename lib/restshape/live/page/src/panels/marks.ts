// What the application says of a frame, given to what draws, offers, charts and sounds it.

import type { App } from "../app";
import { Charts } from "./charts";
import { byKind, taken, type MarksByKind, type TakenMark } from "./decoded_marks";
import { quantityValue } from "./frame_values";
import { Offers } from "./offers";
import { showFrameWords } from "./frame_words";
import { showLegend } from "./legend";
import type { Painter } from "./painter";
import { Sound } from "./sound";
import { extremeText } from "./si_text";
import { MarkGroup, type Stage, type ValueText } from "./stage";

export interface MarkPanels { offers: HTMLElement; charts: HTMLElement; sound: HTMLElement; words: HTMLElement; }

export function showMarks(app: App, stage: Stage, painter: Painter): MarkPanels {
  const offers = new Offers(app, stage), charts = new Charts(painter), sound = new Sound(app, stage);
  const group = new MarkGroup(stage, "marks"), words = showFrameWords(), legend = showLegend();
  let now: MarksByKind | null = null;
  const write = () => {
    if (!now) return;
    words.show(now.drawn);
    legend.show(now.drawn);
    offers.show(now.offers);
    charts.show(now.charts);
    sound.show(now.tones);
    now = null;
  };
  let known: TakenMark[] = [];
  const written = new Map<string, string>();           // of quantities beside their places
  app.on("frame", ({ header, read }) => {
    const text: ValueText = ({ name, unit }) => {
      const value = quantityValue(header, name);
      // A refused frame has no value of its own, and shows the answer before it.
      if (!Number.isNaN(value)) written.set(name, extremeText(name, value, header.errors[name], unit));
      return written.get(name) ?? name;
    };
    if (!header.marks) {
      if (header.parts.some(({ role }) => role === "shape")) group.follow(text);
      return;
    }
    known = taken(header.marks, read, known);
    now = byKind(known);
    group.draw(now.drawn, text);                              // with the picture of their frame
    painter.soon(write);
  });
  return { offers: offers.body, charts: charts.body, sound: sound.body, words: words.body };
}
