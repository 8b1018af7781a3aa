// Words beside the hand: why something was refused, how far it has gone; and words for those who do not see the picture.

import type { App } from "../app";

const SHOWN = 3_500; // ms that words stay after the last ones

export class Beside {
  private readonly box = document.getElementById("beside")!;
  private readonly said = document.getElementById("said")!;
  private readonly stage = document.getElementById("stage")!;
  private x = 0;
  private y = 0;
  private timer = 0;

  constructor(app: App) {
    app.on("refused", ({ message, todo }) => this.refuse(message, todo));
    app.on("frame", ({ header }) => {
      const refused = header.columns["refused"];
      if (typeof refused === "string" && refused) this.refuse(refused, "");
    });
    app.on("note", (note) => this.say(note));
  }

  /** Where the hand is, in pixels of the canvas. */
  moveTo(x: number, y: number): void {
    this.x = x;
    this.y = y;
    if (!this.box.hidden) this.place();
  }

  show(text: string, kind: "guide" | "refused" = "guide"): void {
    this.box.textContent = text;
    this.box.dataset["kind"] = kind;
    this.box.hidden = false;
    this.place();
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.hide(), SHOWN);
  }

  hide(): void {
    clearTimeout(this.timer);
    this.box.hidden = true;
  }

  /** A sentence below the picture, which screen readers read out. */
  say(text: string): void { if (this.said.textContent !== text) this.said.textContent = text; }

  private refuse(message: string, todo: string): void {
    const text = todo ? `${message}: ${todo}` : message;
    this.show(text, "refused");
    this.say(text);
  }

  private place(): void {
    const { clientWidth, clientHeight } = this.stage;
    const { offsetWidth, offsetHeight } = this.box;
    const left = Math.min(Math.max(this.x + 18, 4), Math.max(clientWidth - offsetWidth - 4, 4));
    const above = this.y - offsetHeight - 18;
    const below = above > 4 ? above : this.y + 24;
    const top = Math.max(Math.min(below, clientHeight - offsetHeight - 4), 4);
    this.box.style.transform = `translate(${left}px, ${top}px)`;
  }
}
