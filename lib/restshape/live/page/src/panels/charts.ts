// Charts of the application, such as a resonance curve.

import type { ChartMark } from "./decoded_marks";
import { ChangingText, element } from "./element";
import type { Painter } from "./painter";
import { Plot } from "./plot";

const HEIGHT = 170;

class ShownChart {
  readonly plot = new Plot(HEIGHT);
  readonly body: HTMLElement;
  private readonly places = new ChangingText();

  constructor(private chart: ChartMark) {
    this.body = element("figure", {}, element("h2", {}, chart.name), this.plot.canvas);
    this.body.append(element("figcaption", { class: "help" }, this.places.node));
    if (chart.curves.length > 1) this.body.append(legend(chart.curves.map((curve) => curve.name)));
  }

  take(chart: ChartMark): void { this.chart = chart; }

  readonly draw = (): void => {
    const { name, curves, xLabel, yLabel, at, logarithmic } = this.chart;
    const places = Object.entries(at).map(([what, x]) => `${what} at ${Number(x.toPrecision(4))}`).join(", ");
    this.places.set(places);
    this.plot.draw({ curves, xLabel, yLabel, at, logarithmic, spoken: `${name}: ${yLabel} over ${xLabel}${places ? `; ${places}` : ""}` });
  };
}

export class Charts {
  readonly body = element("div", { class: "charts", hidden: true });
  private charts = new Map<string, ShownChart>();

  constructor(private readonly painter: Painter) {}

  show(marks: ChartMark[]): void {
    const now = new Map<string, ShownChart>();
    for (const mark of marks) {
      const chart = this.charts.get(mark.name) ?? new ShownChart(mark);
      chart.take(mark);
      now.set(mark.name, chart);
      this.painter.inTurn(chart.draw);
    }
    const same = now.size === this.charts.size && [...now.keys()].every((name) => this.charts.has(name));
    this.charts = now;
    if (same) return;
    this.body.replaceChildren(...[...now.values()].map((chart) => chart.body));
    this.body.hidden = now.size === 0;
  }
}

/** Names of curves with the colour and dash that each has. */
function legend(names: string[]): HTMLElement {
  return element("ul", { class: "legend" }, ...names.map((name, index) => element("li", { "data-curve": index % 5 }, name)));
}
