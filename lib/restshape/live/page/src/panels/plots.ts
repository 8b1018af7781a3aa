// A plot of each chosen quantity over the frames of the edit.

import type { App } from "../app";
import type { QuantityInfo } from "../protocol";
import { element } from "./element";
import { FrameHistory } from "./frame_history";
import { limitsOf, QUANTITY, quantityValue } from "./frame_values";
import type { Painter } from "./painter";
import { Plot } from "./plot";
import { extremes } from "./plot_geometry";
import { scaledUnit, siText } from "./si_text";

/** Columns of a frame that are of no interest over the edit. */
const BORING = new Set(["index", "line", "t", "checksum"]);

export class Plots {
  readonly body: HTMLElement;
  private readonly history = new FrameHistory();
  private readonly plots = new Map<string, { plot: Plot; draw: () => void }>();
  private readonly list = element("div", { class: "plots" });
  private readonly others = element("select", { "aria-label": "plot another column of the frames" });
  private offered = "";

  constructor(private readonly app: App, private readonly painter: Painter) {
    this.body = element("div", {}, this.list, element("p", { class: "row" }, this.others));
    this.others.addEventListener("change", () => {
      if (this.others.value) this.choose(this.others.value, !this.plots.has(this.others.value));
      this.others.value = "";
    });
    // A page that comes back to the same scene goes on with what it has seen.
    let scene = "";
    app.on("welcome", (welcome) => {
      if (welcome.scene !== scene) this.history.clear();
      scene = welcome.scene;
    });
    app.on("frame", () => this.take());
    app.on("player", () => this.askAll());
  }

  /** Shows the plot of a quantity or column, or takes it away. */
  choose(name: string, on: boolean): void {
    const known = this.plots.get(name);
    if (known && !on) {
      known.plot.canvas.remove();
      this.plots.delete(name);
    } else if (!known && on) {
      const plot = new Plot(110, (frame) => this.seek(Math.round(frame)));
      const draw = () => this.draw(name, plot);
      this.plots.set(name, { plot, draw });
      this.list.append(plot.canvas);
      this.painter.inTurn(draw);
    }
    this.offered = "";
    this.offer();
  }

  private take(): void {
    const frame = this.app.frame!.header;
    const kept = this.app.player !== null && this.app.welcome?.player === true;
    const values: [string, number][] = [];
    for (const [column, value] of Object.entries(frame.columns)) {
      if (typeof value !== "number" || BORING.has(column)) continue;
      values.push([column.startsWith(QUANTITY) ? column.slice(QUANTITY.length) : column, value]);
    }
    for (const { name } of this.app.welcome?.quantities ?? []) values.push([name, quantityValue(frame, name)]);
    this.history.add(frame.number, values, kept);
    this.askAll();
    this.offer();
  }

  private askAll(): void {
    for (const { draw } of this.plots.values()) this.painter.inTurn(draw);
  }

  private draw(name: string, plot: Plot): void {
    const info: QuantityInfo = this.app.welcome?.quantities.find((one) => one.name === name) ?? { name, unit: unitOf(name) };
    const { x, y } = this.history.points(name);
    const [low, high] = extremes(y);
    const scale = scaledUnit(Math.max(Math.abs(low), Math.abs(high)), info.unit);
    const now = this.app.frame ? quantityValue(this.app.frame.header, name) : NaN;
    const playing = this.app.player !== null && this.app.welcome?.player === true;
    plot.draw({
      curves: [{ name, x: x.slice(), y: y.slice() }],
      xLabel: "frame", yLabel: scale.unit ? `${name} [${scale.unit}]` : name,
      least: 10, limits: limitsOf(info), factor: scale.factor,
      at: playing && this.app.frame ? { "": this.app.frame.header.number } : {},
      spoken: `${name} over ${this.history.last + 1} frames, now ${siText(now, info.unit)}, from ${siText(low, info.unit)} to ${siText(high, info.unit)}`,
    });
  }

  /** Columns that can be plotted besides; the list is made anew only where there are others. */
  private offer(): void {
    const frame = this.app.frame?.header;
    if (!frame) return;
    const quantities = new Set((this.app.welcome?.quantities ?? []).map((one) => one.name));
    const names = Object.entries(frame.columns)
      .filter(([column, value]) => typeof value === "number" && !BORING.has(column) && !column.startsWith(QUANTITY) && !quantities.has(column))
      .map(([column]) => column);
    const offered = names.join();
    if (offered === this.offered) return;
    this.offered = offered;
    this.others.replaceChildren(
      element("option", { value: "" }, "plot another column …"),
      ...names.map((name) => element("option", { value: name }, `${this.plots.has(name) ? "✓ " : ""}${name}`)));
  }

  private seek(frame: number): void {
    if (this.app.welcome?.player) this.app.send({ type: "seek", frame });
  }
}

/** The unit of a column that is no quantity: times are in milliseconds. */
function unitOf(column: string): string {
  return column === "ms" || column.startsWith("ms_") ? "ms" : "";
}
