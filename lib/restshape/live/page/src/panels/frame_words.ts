// What the application says of the frame in words that have no place in the picture.

import { ChangingText, element, mark } from "./element";
import type { DrawnMark } from "./stage";

export interface FrameWords { body: HTMLElement; show(marks: DrawnMark[]): void; }

export function showFrameWords(): FrameWords {
  const body = element("ul", { class: "frame-words", hidden: true });
  const lines: { line: HTMLElement; text: ChangingText }[] = [];
  const show = (marks: DrawnMark[]) => {
    const said = marks.filter((one): one is Extract<DrawnMark, { kind: "words" }> => one.kind === "words" && one.at === null);
    while (lines.length < said.length) {
      const text = new ChangingText();
      const line = element("li", {}, text.node);
      lines.push({ line, text });
      body.append(line);
    }
    lines.forEach(({ line, text }, index) => {
      const words = said[index];
      if (line.hidden !== !words) line.hidden = !words;
      text.set(words?.text ?? "");
      mark(line, "data-meaning", words?.meaning ?? null);
    });
    if (body.hidden !== (said.length === 0)) body.hidden = said.length === 0;
  };
  return { body, show };
}
