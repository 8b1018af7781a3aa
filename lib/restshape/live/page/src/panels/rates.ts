// Sensitivity before the press: how each quantity changes as what is selected moves.

import type { App, Rates } from "../app";
import { element } from "./element";
import { quantityValue, spoken } from "./frame_values";
import { arrowTurn, rateText, shareText } from "./rate_text";

const REST = 400;                                       // [ms] without a frame until rates are asked for again
const SVG = "http://www.w3.org/2000/svg";

export interface RatePanel { body: HTMLElement; of(name: string): void; }

export function showRates(app: App): RatePanel {
  const list = element("ul", { class: "rates" });
  const title = element("h2");
  const body = element("div", { hidden: true, "aria-live": "polite" }, title, list);
  let of = "", asked = 0, timer = 0;
  const ask = () => {
    if (of && !app.held) asked = app.wonder({ type: "rates", of });
  };
  const select = (name: string) => {
    if (name === of) return;
    of = name;
    if (!of) body.hidden = true;
    ask();
  };
  app.on("selected", (thing) => select(thing?.name ?? ""));
  app.on("rates", (rates) => {
    if (rates.id !== asked || rates.of !== of) return;
    title.textContent = of.includes(".") ? `With 1 % more of ${of}` : `As ${of} moves`;
    list.replaceChildren(...lines(app, rates));
    body.hidden = list.children.length === 0;
  });
  app.on("declined", ({ id }) => { if (id === asked) body.hidden = true; });
  app.on("frame", ({ header }) => {
    clearTimeout(timer);
    if (of && !header.held) timer = window.setTimeout(ask, REST);
  });
  return { body, of: select };
}

function lines(app: App, rates: Rates): HTMLElement[] {
  return Object.entries(rates.rates).map(([name, rate]) => {
    const value = app.frame ? quantityValue(app.frame.header, name) : NaN;
    const unit = rates.units[name] ?? "";
    const number = rates.of.includes(".") ? app.welcome?.numbers.find((one) => one.key === rates.of)?.value ?? NaN : NaN;
    const text = rates.of.includes(".") ? shareText(rate[0] ?? NaN, number, unit, value) : rateText(rate, unit, value);
    return element("li", {}, arrow(rate), element("span", {}, `${spoken(name)}: ${text}`));
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
