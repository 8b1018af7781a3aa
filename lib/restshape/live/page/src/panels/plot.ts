// A small plot on a canvas: curves over an axis, with ticks, units, limits and a place that is marked.

import { element, mark } from "./element";
import { inkOf, onNewInk, type Ink } from "./ink";
import { extremes, pixel, placeNames, thinned, valueAt, type Axis } from "./plot_geometry";
import { axisRange, powerLabels, powerTicks, tickLabels, ticks } from "./ticks";

export interface Curve { name: string; x: ArrayLike<number>; y: ArrayLike<number>; }
export interface Drawing {
  curves: Curve[];
  xLabel: string;
  yLabel: string;
  limits?: { value: number; name: string }[];       // lines across
  at?: Record<string, number>;                      // upright lines by name
  least?: number;                                   // least length of the x axis; whole ticks where it is given
  logarithmic?: boolean;
  factor?: number;                                  // of y, to the unit of yLabel
  spoken: string;                                   // what is said to who does not see it
}

const DASHES = [[], [6, 3], [2, 2], [8, 3, 2, 3]];
const FONT = "11px system-ui, sans-serif";
const ROW = 12;                                         // pixels between rows of names

export class Plot {
  readonly canvas: HTMLCanvasElement;
  private width = 0;
  private saying = 0;
  private ink: Ink | null = null;
  private drawing: Drawing | null = null;

  /** `height` [px]; `chosen`: is told the x at which the plot is pressed. */
  constructor(private readonly height = 110, chosen?: (x: number) => void) {
    this.canvas = element("canvas", { class: "plot", role: "img" });
    this.canvas.style.height = `${height}px`;
    new ResizeObserver(([entry]) => {
      this.width = Math.round(entry!.contentRect.width);
      this.redraw();
    }).observe(this.canvas);
    onNewInk(() => { this.ink = null; this.redraw(); });
    if (chosen) {
      this.canvas.classList.add("choosable");
      this.canvas.addEventListener("click", (event) => chosen(valueAt(this.across, event.offsetX)));
    }
  }

  private across: Axis = { low: 0, high: 1, from: 0, to: 1, logarithmic: false };

  draw(drawing: Drawing): void {
    this.drawing = drawing;
    if (!this.canvas.hasAttribute("aria-label")) mark(this.canvas, "aria-label", drawing.spoken);
    this.redraw();
  }

  private redraw(): void {
    const { drawing, width, height } = this;
    if (!drawing || width < 60) return;
    const ratio = Math.min(devicePixelRatio || 1, 3);
    const wide = Math.round(width * ratio), high = Math.round(height * ratio);
    if (this.canvas.width !== wide || this.canvas.height !== high) Object.assign(this.canvas, { width: wide, height: high });
    const pen = this.canvas.getContext("2d");
    if (!pen) return;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = FONT;
    this.ink ??= inkOf(this.canvas);
    const up = this.axisUp(drawing);
    const labels = this.yTicks(drawing, up);
    const left = Math.ceil(Math.max(...labels.map(([, text]) => pen.measureText(text).width), 10)) + 8;
    this.across = this.axisAcross(drawing, left);
    this.frame(pen, drawing, labels, up, left);
    this.lines(pen, drawing, up);
    // Said when the plot rests: a name that changes with each frame is of use to nobody.
    clearTimeout(this.saying);
    this.saying = window.setTimeout(() => mark(this.canvas, "aria-label", drawing.spoken), 300);
  }

  private axisUp(drawing: Drawing): Axis {
    const logarithmic = drawing.logarithmic ?? false;
    let low = Infinity, high = -Infinity;
    const widen = (values: ArrayLike<number>) => {
      const [least, greatest] = extremes(values, logarithmic);
      low = Math.min(low, least);
      high = Math.max(high, greatest);
    };
    for (const curve of drawing.curves) widen(curve.y);
    const apart = high - low;
    // A limit far away would flatten the curve: it is left out, and said to be there by the words beside the value.
    widen((drawing.limits ?? []).map((limit) => limit.value).filter((value) =>
      !Number.isFinite(apart) || (value > low - 3 * apart && value < high + 3 * apart) || apart === 0));
    const [from, to] = axisRange(low, high, logarithmic);
    return { low: from, high: to, from: this.height - 30, to: 20, logarithmic };
  }

  private axisAcross(drawing: Drawing, left: number): Axis {
    let low = Infinity, high = -Infinity;
    for (const curve of drawing.curves) {
      const [least, greatest] = extremes(curve.x);
      low = Math.min(low, least);
      high = Math.max(high, greatest);
    }
    if (!Number.isFinite(low)) [low, high] = [0, 1];
    high = Math.max(high, low + (drawing.least ?? (high > low ? 0 : 1)));
    return { low, high, from: left, to: this.width - 10, logarithmic: false };
  }

  private yTicks(drawing: Drawing, up: Axis): [number, string][] {
    const factor = drawing.factor ?? 1;
    const count = Math.max(2, Math.floor(this.height / 34));
    const places = up.logarithmic ? powerTicks(up.low * factor, up.high * factor, count) : ticks(up.low * factor, up.high * factor, count);
    const words = up.logarithmic ? powerLabels(places) : tickLabels(places);
    return places.map((place, index) => [place / factor, words[index]!]);
  }

  private frame(pen: CanvasRenderingContext2D, drawing: Drawing, labels: [number, string][], up: Axis, left: number): void {
    const ink = this.ink!, bottom = this.height - 30, right = this.width - 10;
    pen.lineWidth = 1;
    pen.strokeStyle = ink.faint;
    pen.fillStyle = ink.text;
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    pen.beginPath();
    for (const [value, text] of labels) {
      const y = Math.round(pixel(up, value)) + 0.5;
      pen.moveTo(left, y);
      pen.lineTo(right, y);
      pen.fillText(text, left - 4, y);
    }
    pen.textAlign = "center";
    pen.textBaseline = "top";
    const across = this.across;
    const places = ticks(across.low, across.high, Math.max(2, Math.floor((right - left) / 70)))
      .filter((place) => drawing.least === undefined || Number.isInteger(place));
    tickLabels(places).forEach((text, index) => {
      const x = Math.round(pixel(across, places[index]!)) + 0.5;
      pen.moveTo(x, bottom);
      pen.lineTo(x, bottom + 3);
      const half = pen.measureText(text).width / 2;
      pen.fillText(text, Math.min(Math.max(x, half), this.width - half), bottom + 4);
    });
    pen.stroke();
    pen.textAlign = "right";
    pen.fillText(drawing.xLabel, right, bottom + 16);
    pen.textAlign = "left";
    pen.fillText(drawing.yLabel, 0, 1);
  }

  private lines(pen: CanvasRenderingContext2D, drawing: Drawing, up: Axis): void {
    const ink = this.ink!, bottom = this.height - 30, right = this.width - 10, across = this.across;
    pen.save();
    pen.beginPath();
    pen.rect(across.from - 3, 14, right - across.from + 6, bottom - 13);
    pen.clip();
    pen.lineWidth = 1.75;
    drawing.curves.forEach((curve, index) => {
      pen.strokeStyle = ink.curves[index % ink.curves.length]!;
      pen.setLineDash(DASHES[index % DASHES.length]!);
      strokePolyline(pen, thinned(curve.x, curve.y, across, up));
    });
    pen.lineWidth = 1;
    for (const limit of drawing.limits ?? []) {
      pen.strokeStyle = pen.fillStyle = ink.limit;
      pen.setLineDash([5, 3]);
      const y = Math.round(pixel(up, limit.value)) + 0.5;
      strokePolyline(pen, [across.from, y, right, y]);
      pen.textAlign = "right";
      pen.textBaseline = y < 30 ? "top" : "bottom";
      pen.fillText(limit.name, right - 2, y);
    }
    this.upright(pen, drawing);
    pen.restore();
  }

  /** Upright lines, and their names over all of them, each in the first row that is free. */
  private upright(pen: CanvasRenderingContext2D, drawing: Drawing): void {
    const bottom = this.height - 30, right = this.width - 10, { ground, text } = this.ink!;
    const names = Object.keys(drawing.at ?? {}), x = Object.values(drawing.at ?? {}).map((value) => Math.round(pixel(this.across, value)) + 0.5);
    pen.strokeStyle = text;
    pen.setLineDash([2, 2]);
    for (const at of x) strokePolyline(pen, [at, 14, at, bottom]);
    pen.textBaseline = "top";
    pen.textAlign = "left";
    const wide = names.map((name) => pen.measureText(name).width);
    const rows = Math.max(1, Math.floor((bottom - 16) / ROW));
    placeNames(x, wide, this.across.from, right, rows).forEach((place, index) => {
      if (!place || !names[index]) return;
      const top = 16 + ROW * place.row;
      pen.fillStyle = ground;
      pen.fillRect(place.left - 1, top - 1, wide[index]! + 2, ROW);
      pen.fillStyle = text;
      pen.fillText(names[index]!, place.left, top);
    });
  }
}

function strokePolyline(pen: CanvasRenderingContext2D, line: number[]): void {
  pen.beginPath();
  let begins = true;
  for (let index = 0; index < line.length; index += 2) {
    const x = line[index]!, y = line[index + 1]!;
    if (Number.isNaN(y)) { begins = true; continue; }
    const alone = begins && !(index + 3 < line.length && !Number.isNaN(line[index + 3]!));
    if (begins) pen.moveTo(x, y);
    else pen.lineTo(x, y);
    // A value by itself, between frames without one, is a dot.
    if (alone) pen.arc(x, y, 1, 0, 2 * Math.PI);
    begins = false;
  }
  pen.stroke();
}
