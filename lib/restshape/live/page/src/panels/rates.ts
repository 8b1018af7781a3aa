// Sensitivity before the press: how each quantity changes as what is selected moves.

import type { App, Rates } from "../app";
import { element } from "./element";
import { quantityValue } from "./frame_values";
import { arrowTurn, fallsAtAll, fallText, rateText, shareText, UNCHANGED } from "./rate_text";
import type { ArrowsToDraw, Stage } from "./stage";

const REST = 400;                                       // [ms] without a frame until rates are asked for again
const NAME = "where it falls";                          // of the arrow in the picture
const SVG = "http://www.w3.org/2000/svg";

export interface RatePanel { body: HTMLElement; of(name: string): void; }

export function showRates(app: App, stage: Stage): RatePanel {
  const list = element("ul", { class: "rates" });
  const title = element("h2");
  const drawn = element("input", { type: "checkbox", checked: true });
  const quantity = element("select", { "aria-label": "quantity whose fall is drawn" });
  const choice = element("p", { class: "row" }, element("label", {}, drawn, "draw where it falls:"), quantity);
  const body = element("div", { hidden: true }, title, element("div", { "aria-live": "polite" }, list), choice);
  let of = "", asked = 0, timer = 0, seen = -1;
  let known: Rates | null = null;
  const ask = () => {
    if (of && !app.held) asked = app.wonder({ type: "rates", of });
  };
  const draw = () => stage.setArrows(NAME, known && drawn.checked && !app.held ? fallOf(app, stage, known, quantity.value) : null);
  const forget = () => {
    known = null;
    draw();
  };
  const select = (name: string) => {
    if (name === of) return;
    of = name;
    forget();
    if (!of) body.hidden = true;
    ask();
  };
  for (const control of [drawn, quantity]) control.addEventListener("change", draw);
  app.on("selected", (thing) => select(thing?.name ?? ""));
  app.on("held", draw);
  app.on("rates", (rates) => {
    if (rates.id !== asked || rates.of !== of) return;
    known = rates;
    title.textContent = of.includes(".") ? `With 1 % more of ${of}` : `As ${of} moves`;
    list.replaceChildren(...lines(app, rates));
    body.hidden = list.children.length === 0;
    offer(quantity, Object.keys(rates.rates).filter((name) => rates.rates[name]!.length > 1));
    choice.hidden = quantity.options.length === 0;
    draw();
  });
  app.on("declined", ({ id }) => {
    if (id !== asked) return;
    body.hidden = true;
    forget();
  });
  app.on("frame", ({ header }) => {
    clearTimeout(timer);
    // An arrow of the shape before would be wrong.
    if (known && header.number !== seen) forget();
    seen = header.number;
    if (of && !header.held) timer = window.setTimeout(ask, REST);
  });
  return { body, of: select };
}

/** Offers names to choose from; the one that is chosen stays where it can. */
function offer(choice: HTMLSelectElement, names: string[]): void {
  const before = choice.value;
  if (names.join() === [...choice.options].map((one) => one.value).join()) return;
  choice.replaceChildren(...names.map((name) => element("option", { value: name }, name)));
  if (names.includes(before)) choice.value = before;
}

/** An arrow at what is selected, the way on which a quantity falls fastest; null where it does not change. */
function fallOf(app: App, stage: Stage, { of, rates, units }: Rates, name: string): ArrowsToDraw | null {
  const rate = rates[name], place = stage.where(of);
  if (!rate || !place || rate.length < 2) return null;
  const size = Math.hypot(...rate), value = app.frame ? quantityValue(app.frame.header, name) : NaN;
  if (!fallsAtAll(size, value)) return null;
  const way = [0, 1, 2].map((k) => -(rate[k] ?? 0) / size);
  const words = [fallText(name, size, units[name] ?? "", value)];
  return {
    points: Float32Array.from(place.at), moved: Float32Array.from(place.moved), vectors: Float32Array.from(way), meaning: "inside", tips: [], words,
  };
}

function lines(app: App, rates: Rates): HTMLElement[] {
  return Object.entries(rates.rates).map(([name, rate]) => {
    const value = app.frame ? quantityValue(app.frame.header, name) : NaN;
    const unit = rates.units[name] ?? "";
    const number = rates.of.includes(".") ? app.welcome?.numbers.find((one) => one.key === rates.of)?.value ?? NaN : NaN;
    const text = rates.of.includes(".") ? shareText(rate[0] ?? NaN, number, unit, value) : rateText(rate, unit, value);
    return element("li", {}, arrow(text === UNCHANGED ? [] : rate), element("span", {}, `${name}: ${text}`));
  });
}

/** An arrow the way on which the quantity grows fastest; a bar where there is but one way. */
function arrow(rate: number[]): Element {
  const picture = document.createElementNS(SVG, "svg");
  for (const [name, value] of Object.entries({ viewBox: "-10 -10 20 20", width: "18", height: "18", "aria-hidden": "true" })) picture.setAttribute(name, value);
  const turn = arrowTurn(rate);
  if (turn === null) return picture;
  const path = document.createElementNS(SVG, "path");
  path.setAttribute("d", "M -8 0 H 7 M 2 -4.5 L 7.5 0 L 2 4.5");
  path.setAttribute("transform", `rotate(${turn.toFixed(1)})`);
  path.setAttribute("class", "rate-arrow");
  picture.append(path);
  return picture;
}
