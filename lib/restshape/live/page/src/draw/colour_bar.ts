// The colours of the field beside its values, with its extremes.

import type { Painter } from "../panels/painter";
import { siText, scaledUnit } from "../panels/si_text";
import type { FieldInfo } from "../protocol";
import { colourTable, type ColourMap } from "./colour_maps";

export interface BarState { field: FieldInfo | null; map: ColourMap; ends: [number, number]; low: number; high: number; note: string; }

export class ColourBar {
  private readonly caption = document.createElement("figcaption");
  private readonly strip = document.createElement("canvas");
  private readonly scale = document.createElement("div");
  private readonly extremes = document.createElement("div");
  private readonly values = [0, 1, 2].map(() => document.createElement("span"));
  private map: ColourMap | null = null;
  private state: BarState | null = null;

  constructor(private readonly into: HTMLElement, private readonly painter: Painter) {
    this.strip.width = 256;
    this.strip.height = 1;
    this.strip.setAttribute("role", "img");
    this.scale.className = "scale";
    this.extremes.className = "extremes";
    this.values.forEach((value, i) => { value.style.left = `${50 * i}%`; });
    this.scale.append(...this.values);
    into.append(this.caption, this.strip, this.scale, this.extremes);
    into.hidden = true;
  }

  show(state: BarState): void {
    this.state = state;
    this.painter.soon(this.write);
  }

  private readonly write = (): void => {
    const { state } = this;
    if (!state) return;
    const { field, map, ends, low, high, note } = state;
    for (const element of [this.strip, this.scale]) element.hidden = !field;
    this.into.hidden = !field && !note;
    if (!field) {
      put(this.caption, "");
      put(this.extremes, note);
      return;
    }
    this.paint(map);
    const size = Math.max(Math.abs(ends[0]), Math.abs(ends[1]));
    const { factor, unit } = scaledUnit(size, field.unit);
    put(this.caption, unit ? `${field.label} [${unit}]` : field.label);
    const span = factor * (ends[1] - ends[0]);
    [ends[0], 0.5 * (ends[0] + ends[1]), ends[1]].forEach((value, i) => put(this.values[i]!, plain(value * factor, span)));
    name(this.strip, `colours of ${field.label}, from ${siText(ends[0], field.unit)} to ${siText(ends[1], field.unit)}`);
    put(this.extremes, `${low === 0 ? "0" : siText(low, field.unit)} to ${siText(high, field.unit)}${note ? ` · ${note}` : ""}`);
  };

  private paint(map: ColourMap): void {
    if (map === this.map) return;
    this.map = map;
    const pixels = new ImageData(256, 1);
    pixels.data.set(colourTable(map));
    this.strip.getContext("2d")?.putImageData(pixels, 0, 0);
  }
}

/** A value in as many digits as tell hundredths of the span apart. */
function plain(value: number, span: number): string {
  const decimals = span > 0 ? Math.max(0, 2 - Math.floor(Math.log10(span))) : 0;
  const text = decimals > 6 || Math.abs(value) >= 1e6 ? value.toPrecision(3) : value.toFixed(decimals);
  return Number(text).toString().replace("-", "−");
}

/** Names an element for screen readers. */
function name(element: HTMLElement, text: string): void {
  if (element.getAttribute("aria-label") !== text) element.setAttribute("aria-label", text);
}

const written = new WeakMap<HTMLElement, string>();

function put(element: HTMLElement, text: string): void {
  if (written.get(element) === text) return;
  written.set(element, text);
  element.textContent = text;
}
