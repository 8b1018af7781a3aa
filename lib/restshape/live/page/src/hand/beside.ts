// Words beside the hand: why something was refused, how far it has gone; and words for those who do not see the picture.

import { refusedWords, type App } from "../app";

const SHOWN = 3_500; // ms that words stay after the last ones
const FOOT = 90; // pixels of the colours below the picture
const SAID = 12_000; // ms that what was refused or noted stays below the picture

export class Beside {
  private readonly box = document.getElementById("beside")!;
  private readonly said = document.getElementById("said")!;
  private readonly stage = document.getElementById("stage")!;
  private x = 0;
  private y = 0;
  private timer = 0;
  private forgetting = 0;
  private refusedAt = 0;                               // the message that was refused last; 0: that is forgotten
  private free = false;                                // the words belong to no place in the picture
  private readonly room = { right: 0, bottom: 0, top: 0, height: 0 };

  constructor(private readonly app: App) {
    app.on("refused", ({ id, message, todo }) => this.refuse(id, message, todo));
    app.on("frame", ({ header }) => {
      const refused = refusedWords(header);
      if (refused) this.refuse(header.id, refused, "");
      else if (this.refusedAt && header.id > this.refusedAt) this.forget();
    });
    app.on("note", (note) => this.saySoon(note));
    app.on("role", () => this.forget());
  }

  /** Where the hand is, in pixels of the canvas. */
  moveTo(x: number, y: number): void {
    this.x = x;
    this.y = y;
    this.free = false;
    if (!this.box.hidden) this.place();
  }

  show(text: string, kind: "guide" | "refused" = "guide"): void {
    if (this.box.textContent !== text || this.box.hidden) {
      this.box.textContent = text;
      this.box.hidden = false;
      this.measure();
    }
    this.box.dataset["kind"] = kind;
    this.sayOnce();
    this.place();
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.hide(), SHOWN);
  }

  hide(): void {
    clearTimeout(this.timer);
    this.box.hidden = true;
    this.sayOnce();
  }

  /** What stands beside the hand is not seen below the picture as well; screen readers have it there. */
  private sayOnce(): void { this.said.classList.toggle("unseen", !this.box.hidden && this.box.textContent === this.said.textContent); }

  /** A sentence below the picture, which screen readers read out. */
  say(text: string): void {
    if (this.said.textContent !== text) this.said.textContent = text;
    this.sayOnce();
  }

  /** Why something is not done, and what would be; id: of the message that is refused, 0: of none. */
  refuse(id: number, message: string, todo: string): void {
    const text = todo ? `${message}: ${todo}` : message;
    this.free = !this.app.held && !this.app.selected;
    this.show(text, "refused");
    this.saySoon(text);
    this.refusedAt = id;
  }

  /** Says what is of interest for a while. */
  private saySoon(text: string): void {
    this.say(text);
    clearTimeout(this.forgetting);
    this.forgetting = window.setTimeout(() => { if (this.said.textContent === text) this.forget(); }, SAID);
  }

  private forget(): void {
    this.refusedAt = 0;
    this.say("");
  }

  /** Sizes are read once for each text: the browser lays the page out for that. */
  private measure(): void {
    const { offsetWidth, offsetHeight } = this.box;
    this.room.right = Math.max(this.stage.clientWidth - offsetWidth - 4, 4);
    this.room.bottom = this.stage.clientHeight - offsetHeight - 4;
    this.room.height = offsetHeight;
    const tools = document.getElementById("tools")!;
    this.room.top = tools.offsetTop + tools.offsetHeight + 4;
  }

  private place(): void {
    const { right, bottom, top: least, height } = this.room;
    const above = this.y - height - 18;
    // Over the buttons there is no room; what belongs to no place is said below the shape.
    const left = this.free ? right / 2 : Math.min(Math.max(this.x + 18, 4), right);
    const top = this.free ? Math.max(bottom - FOOT, least) : Math.max(Math.min(above > least ? above : this.y + 24, bottom), least);
    this.box.style.transform = `translate(${left}px, ${top}px)`;
  }
}
