// Values that all shaders of the picture read: changed in one place, seen by all.

import { DataTexture, NearestFilter, RGBAFormat, Color, Vector2 } from "three";

import { colourTable, type ColourMap } from "./colour_maps";

export class Shared {
  readonly scale = { value: 1 };                    // of displacements
  readonly size = { value: new Vector2(1, 1) };     // of the canvas, in its pixels
  readonly pixels = { value: 1 };                   // of the canvas in a pixel of the page
  readonly ends = { value: new Vector2(0, 1) };     // values at the ends of the colours
  readonly map = { value: new DataTexture(colourTable("viridis") as Uint8Array<ArrayBuffer>, 256, 1, RGBAFormat) };
  readonly glowing = { value: new Color() };       // what lights up under the pointer
  wires = true;                                     // whether edges of elements are drawn
  private shown: ColourMap = "viridis";

  constructor() {
    this.map.value.magFilter = NearestFilter;
    this.map.value.minFilter = NearestFilter;
    this.map.value.needsUpdate = true;
  }

  colours(map: ColourMap): void {
    if (map === this.shown) return;
    this.shown = map;
    (this.map.value.image.data as Uint8Array).set(colourTable(map));
    this.map.value.needsUpdate = true;
  }
}
