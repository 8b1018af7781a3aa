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
    this.slider.addEventListener("pointerdown", () => { this.held = true; });
    for (const end of ["pointerup", "pointercancel", "change"]) this.slider.addEventListener(end, () => this.release());
    this.slider.addEventListener("input", () => this.slide());
    this.slider.value = String(place);
    this.update(shown);
  }

  private release(): void {
    if (!this.held) return;
    this.held = false;
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
    for (const event of this.shown.offer.events) this.app.act(event);
  }

  private slide(): void {
    const { offer } = this.shown;
    if (!offer.slide) return;
    if (!this.taken) this.take();
    const event: ScriptEvent = { ...offer.slide, [offer.slid]: Number(this.slider.value) };
    this.app.act(event, true);
  }
}

export class Offers {
  readonly body = element("div", { hidden: true });
  private readonly list = element("ul", { class: "offers" });
  private lines = new Map<string, OfferLine>();
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
    const now = new Map<string, OfferLine>(), held = [...this.lines.values()].some((line) => line.held);
    for (const shown of offers) {
      // What has no events goes along what is chosen: while a slider does that, there is one already.
      const goesOn = shown.offer.events.length === 0;
      if (goesOn && held && !this.lines.has(shown.offer.name)) continue;
      const line = this.lines.get(shown.offer.name)
        ?? new OfferLine(shown, this.app, this.preview, goesOn ? this.place : 0, (place) => this.letGo(place));
      line.update(shown);
      now.set(shown.offer.name, line);
    }
    for (const [name, line] of this.lines) if (line.held && !now.has(name)) now.set(name, line);
    const before = [...this.lines.values()], after = [...now.values()];
    this.lines = now;
    if (after.length !== before.length || after.some((line, index) => line !== before[index])) {
      // Lines that stay are not taken out of the page: a slider would be let go.
      for (const line of before) if (!after.includes(line)) line.body.remove();
      for (const line of after) if (!line.body.isConnected || line.body.parentNode !== this.list) this.list.append(line.body);
      this.body.hidden = after.length === 0;
      if (!this.list.matches(":hover")) this.preview.draw([]);
    }
  }
}
