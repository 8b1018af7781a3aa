// Sliders and typed numbers: parameters of the scene, and all its other numbers by a search.

import { refusedWords, type App } from "../app";
import type { NumberInfo } from "../protocol";
import { element, mark } from "./element";
import { foundNumbers, rounded, shownText, slid, sliderRange, typedValue, type SliderRange } from "./given_numbers";
import type { Painter } from "./painter";

const MOST = 48;                                       // found numbers that are shown at a time
const FIRST = 6;                                       // shown before anything is searched for

/** A number with its slider and its text, which stay while it changes. */
class NumberLine {
  readonly body: HTMLElement;
  private readonly slider: HTMLInputElement;
  private readonly text: HTMLInputElement;
  private range: SliderRange;
  private sliding = false;
  private readonly why = element("p", { class: "wrong", role: "alert", hidden: true });
  private asked = 0;                                   // the message with what was typed last
  private gesture = 0;
  private taken = false;                               // what was typed: its new value comes next
  private refused = false;                             // since it was in the hand: it shows what was not taken

  constructor(private info: NumberInfo, private readonly app: App, chosen: (key: string) => void) {
    this.range = sliderRange(info);
    this.slider = element("input", { type: "range", "aria-label": `${info.key}, slider` });
    this.text = element("input", { type: "text", "aria-label": info.key, spellcheck: false, size: 9 });
    this.body = element("div", { class: "number" }, element("label", { title: info.key }, shortened(info)), this.text, this.why, this.slider);
    this.slider.addEventListener("input", () => this.slide());
    this.slider.addEventListener("change", () => { this.sliding = false; this.restore(); });
    this.text.addEventListener("change", () => this.typed());
    this.text.addEventListener("input", () => { this.taken = false; });
    this.text.addEventListener("blur", () => this.restore());
    this.body.addEventListener("focusin", () => chosen(info.key));
    this.arrange();
  }

  /** Takes a new value in, unless the hand is on it. */
  update(info: NumberInfo): void {
    this.info = info;
    if (this.sliding || (document.activeElement === this.text && !this.taken)) return;
    this.taken = false;
    const range = sliderRange(info);
    const place = info.value * range.factor;
    if (range.unit !== this.range.unit || place < this.range.low || place > this.range.high) this.range = range;
    this.arrange();
  }

  /** Something was refused: the number is what it was, once it is no longer in the hand. */
  refuse(): void {
    this.refused = true;
    if (!this.sliding && document.activeElement !== this.text) this.restore();
  }

  /** Why a message was refused, or that it was not (empty): what was typed is marked until the next answer. */
  answer(id: number, why: string): void {
    if (!this.asked || id < this.asked) return;
    const own = id === this.asked ? why : "";
    this.why.textContent = own && `${this.text.value}: ${own.replace(new RegExp(`^.*${escaped(this.info.key)}: `), "")}`;
    this.why.hidden = !own;
    mark(this.text, "aria-invalid", own ? "true" : null);
    if (own) return;
    this.asked = 0;
    this.taken = true;
  }

  private restore(): void {
    if (this.refused) {
      this.arrange();
      // What is wrong stands no more; why it was stays until the next answer.
      mark(this.text, "aria-invalid", null);
    }
    this.refused = false;
  }

  private arrange(): void {
    const { low, high, step, factor } = this.range;
    for (const [name, value] of Object.entries({ min: low, max: high, step })) mark(this.slider, name, String(value));
    this.slider.value = String(this.info.value * factor);
    this.write();
    mark(this.slider, "aria-valuetext", this.text.value);
  }

  /** The text as it fits; what it is of, where that says more. */
  private write(): void {
    const { text } = this.info;
    this.text.value = shownText(text);
    mark(this.text, "title", this.text.value === text ? null : text);
  }

  private slide(): void {
    if (!this.sliding) this.gesture = this.app.gesture();
    this.sliding = true;
    const event = slid(this.info, this.range, rounded(Number(this.slider.value), this.range.step));
    this.text.value = String(event["value"]);
    mark(this.slider, "aria-valuetext", this.text.value);
    this.app.act(event, true, this.gesture);
  }

  private typed(): void {
    const value = typedValue(this.text.value, this.info.text);
    if (value === null) this.write();
    else this.asked = this.app.act({ do: "set", key: this.info.key, value });
  }
}

/** `chosen`: is told the key of a number whose slider or text is in the hand. */
export function showNumbers(app: App, painter: Painter, chosen: (key: string) => void): HTMLElement {
  const parameters = element("div", { class: "numbers" }), found = element("div", { class: "numbers" });
  const search = element("input", { type: "search", placeholder: "search numbers of the scene", "aria-label": "search numbers of the scene" });
  const more = element("p", { class: "help", role: "status" });
  const lines = new Map<string, NumberLine>();
  const lineOf = (info: NumberInfo) => {
    let line = lines.get(info.key);
    if (line) line.update(info);
    else lines.set(info.key, line = new NumberLine(info, app, chosen));
    return line.body;
  };
  const arrange = (into: HTMLElement, infos: NumberInfo[]) => {
    const wanted = infos.map(lineOf);
    // Lines that are there already are left where they are, so that what is typed into stays under the cursor.
    if (wanted.length !== into.children.length || wanted.some((body, index) => into.children[index] !== body)) into.replaceChildren(...wanted);
  };
  const show = () => {
    const numbers = app.welcome?.numbers ?? [];
    arrange(parameters, numbers.filter((one) => one.parameter));
    const { shown, more: rest } = foundNumbers(numbers.filter((one) => !one.parameter), search.value, search.value ? MOST : FIRST);
    arrange(found, shown);
    more.textContent = rest ? `and ${rest} more: type words of their keys` : shown.length ? "" : "no number has these words in its key";
  };
  search.addEventListener("input", show);
  app.on("welcome", show);
  const refuse = () => { for (const line of lines.values()) line.refuse(); };
  const answer = (id: number, why: string) => {
    for (const line of lines.values()) line.answer(id, why);
    if (why) refuse();
  };
  app.on("refused", ({ id, message }) => answer(id, message));
  app.on("frame", ({ header }) => answer(header.id, refusedWords(header)));
  app.on("known", ({ numbers }) => { if (numbers) painter.soon(show); });
  return element("div", {}, parameters, search, found, more);
}

/** Text as a pattern that finds it. */
function escaped(text: string): string { return text.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"); }

function shortened(info: NumberInfo): string {
  return info.parameter ? info.key.replace(/^parameters\./, "") : info.key;
}
