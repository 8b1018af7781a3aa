// Changes that the application offers: to click, and to slide along.

import type { App } from "../app";
import type { ScriptEvent } from "../protocol";
import type { ShownOffer } from "./decoded_marks";
import { ChangingText, element, mark } from "./element";
import { MarkGroup, type Stage } from "./stage";

class OfferLine {
  readonly body: HTMLElement;
  held = false;                                         // the slider is in the hand
  private taken = false;
  private gesture = 0;
  private readonly name = new ChangingText();
  private readonly text = new ChangingText();
  private readonly slider = element("input", { type: "range", min: 0, max: 1, step: 0.005, value: 0 });

  /** `place`: of the slider at first, where the one before it was let go; `released`: it is let go. */
  constructor(private shown: ShownOffer, private readonly app: App, preview: MarkGroup, place: number, private readonly released: (place: number) => void) {
    const press = element("button", { type: "button", click: () => this.take() }, this.name.node);
    this.body = element("li", {}, press, element("p", { class: "help" }, this.text.node), this.slider);
    const show = () => preview.draw(this.shown.lines);
    const hide = () => preview.draw([]);
    for (const [begin, end] of [["pointerenter", "pointerleave"], ["focusin", "focusout"]] as const) {
      this.body.addEventListener(begin, show);
      this.body.addEventListener(end, hide);
    }
    press.addEventListener("click", hide);
    this.slider.addEventListener("pointerdown", () => {
      this.held = true;
      this.gesture = this.app.gesture();
    });
    for (const end of ["pointerup", "pointercancel", "change"]) this.slider.addEventListener(end, () => this.release());
    this.slider.addEventListener("input", () => this.slide());
    this.slider.value = String(place);
    this.update(shown);
  }

  /** The name of what it offers. */
  get called(): string { return this.shown.offer.name; }

  private release(): void {
    if (!this.held) return;
    this.held = false;
    this.gesture = 0;
    this.released(Number(this.slider.value));
  }

  update(shown: ShownOffer): void {
    this.shown = shown;
    const { offer } = shown;
    this.name.set(offer.name);
    this.text.set(offer.text);
    mark(this.slider, "aria-label", `how far: ${offer.name}`);
    const none = offer.slide === null;
    if (this.slider.hidden !== none) this.slider.hidden = none;
  }

  private take(): void {
    this.taken = true;
    const gesture = this.gesture || this.app.gesture();
    for (const event of this.shown.offer.events) this.app.act(event, false, gesture);
  }

  private slide(): void {
    const { offer } = this.shown;
    if (!offer.slide) return;
    if (!this.taken) this.take();
    const event: ScriptEvent = { ...offer.slide, [offer.slid]: Number(this.slider.value) };
    this.app.act(event, true, this.gesture);
  }
}

export class Offers {
  readonly body = element("div", { hidden: true });
  private readonly list = element("ul", { class: "offers" });
  private lines: OfferLine[] = [];
  private offers: ShownOffer[] = [];
  private place = 0;                                    // of the slider that was let go last

  private readonly preview: MarkGroup;

  constructor(private readonly app: App, stage: Stage) {
    this.preview = new MarkGroup(stage, "offer");
    this.body.append(element("h2", {}, "Suggestions"), this.list);
  }

  private letGo(place: number): void {
    this.place = place;
    this.show(this.offers);
  }

  /** Shows what is offered now; a line whose slider is in the hand stays until it is let go. */
  show(offers: ShownOffer[]): void {
    this.offers = offers;
    const held = this.lines.find((line) => line.held);
    const now: OfferLine[] = [];
    for (const shown of offers) {
      const { name, events } = shown.offer;
      // What has no events goes along what is chosen: while a slider does that, there is one already.
      const goesOn = events.length === 0;
      if (goesOn && held && held.called !== name) continue;
      const before = held?.called === name && !now.includes(held) ? held : this.lines[now.length];
      const line = before?.called === name && !now.includes(before) && (before === held || !before.held) ? before
        : new OfferLine(shown, this.app, this.preview, goesOn ? this.place : 0, (place) => this.letGo(place));
      line.update(shown);
      now.push(line);
    }
    if (held && !now.includes(held)) now.splice(Math.min(this.lines.indexOf(held), now.length), 0, held);
    const same = now.length === this.lines.length && now.every((line, index) => line === this.lines[index]);
    this.lines = now;
    if (same) return;
    this.arrange(held);
    this.body.hidden = now.length === 0;
    if (!this.list.matches(":hover")) this.preview.draw([]);
  }

  /** Puts the lines into the page in their order. Those that stay are not moved: a press, or a slider, would be let go. */
  private arrange(held: OfferLine | undefined): void {
    const bodies = new Set<Element>(this.lines.map((line) => line.body));
    for (const body of [...this.list.children]) if (!bodies.has(body)) body.remove();
    let next = this.list.firstElementChild;
    for (const line of this.lines) {
      while (line === held && next && next !== line.body) {
        const passed = next;
        next = next.nextElementSibling;
        passed.remove();
      }
      if (line.body === next) next = next.nextElementSibling;
      else this.list.insertBefore(line.body, next);
    }
  }
}
