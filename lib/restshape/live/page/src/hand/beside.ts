// Words beside the hand: why something was refused, how far it has gone; and words for those who do not see the picture.

import { refusedWords, type App } from "../app";

const SHOWN = 3_500; // ms that words stay after the last ones

export class Beside {
  private readonly box = document.getElementById("beside")!;
  private readonly said = document.getElementById("said")!;
  private readonly stage = document.getElementById("stage")!;
  private x = 0;
  private y = 0;
  private timer = 0;
  private readonly room = { right: 0, bottom: 0, height: 0 };

  constructor(app: App) {
    app.on("refused", ({ message, todo }) => this.refuse(message, todo));
    app.on("frame", ({ header }) => {
      const refused = refusedWords(header);
      if (refused) this.refuse(refused, "");
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
    if (this.box.textContent !== text || this.box.hidden) {
      this.box.textContent = text;
      this.box.hidden = false;
      this.measure();
    }
    this.box.dataset["kind"] = kind;
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

  /** Sizes are read once for each text: the browser lays the page out for that. */
  private measure(): void {
    const { offsetWidth, offsetHeight } = this.box;
    this.room.right = Math.max(this.stage.clientWidth - offsetWidth - 4, 4);
    this.room.bottom = this.stage.clientHeight - offsetHeight - 4;
    this.room.height = offsetHeight;
  }

  private place(): void {
    const { right, bottom, height } = this.room;
    const left = Math.min(Math.max(this.x + 18, 4), right);
    const above = this.y - height - 18;
    const top = Math.max(Math.min(above > 4 ? above : this.y + 24, bottom), 4);
    this.box.style.transform = `translate(${left}px, ${top}px)`;
  }
}
