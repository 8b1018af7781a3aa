// What a browser without a graphics card draws pixel by pixel: colours of values, edges, lines, and what hides what.

import assert from "node:assert/strict";
import { test } from "node:test";

import { Color } from "three";

import { colourTable } from "../../../lib/restshape/live/page/src/draw/colour_maps";
import { Depth } from "../../../lib/restshape/live/page/src/draw/software/depth";
import { fillLit } from "../../../lib/restshape/live/page/src/draw/software/lit_triangles";
import { LitPalette } from "../../../lib/restshape/live/page/src/draw/software/lit_palette";
import { Palette, VALUES, type Tint } from "../../../lib/restshape/live/page/src/draw/software/palette";
import { packed, Raster } from "../../../lib/restshape/live/page/src/draw/software/raster";
import { dot, line } from "../../../lib/restshape/live/page/src/draw/software/strokes";
import { fill } from "../../../lib/restshape/live/page/src/draw/software/triangles";

const MAP = colourTable("viridis");
const GROUND = packed(255, 255, 255);
const tint: Tint = { map: MAP, body: [10, 20, 30], glowing: [255, 0, 0], glow: 0, wire: 0 };
const ink = { red: 0, green: 0, blue: 0, opacity: 1 };

function raster(size: number): Raster {
  const made = new Raster();
  made.resize(size, size);
  made.clear(new Color(1, 1, 1));
  return made;
}

function palette(of: Tint): Palette {
  const made = new Palette();
  made.make(of);
  return made;
}

function lit(of: Tint): LitPalette {
  const made = new LitPalette();
  made.make(of);
  return made;
}

/** Triangles of an uneven grid over all of a picture, with nodes between pixels. */
function grid(size: number, count: number): { x: Float32Array; y: Float32Array; cells: Uint32Array } {
  const nodes = (count + 1) ** 2, x = new Float32Array(nodes), y = new Float32Array(nodes), cells: number[] = [];
  for (let i = 0; i < nodes; i += 1) {
    const column = i % (count + 1), row = Math.floor(i / (count + 1));
    const inside = column > 0 && column < count && row > 0 && row < count;
    x[i] = (column * size) / count + (inside ? 1.7 * Math.sin(3 * i) : 0);
    y[i] = (row * size) / count + (inside ? 1.7 * Math.cos(5 * i) : 0);
    if (column < count && row < count) cells.push(i, i + 1, i + count + 1, i + 1, i + count + 2, i + count + 1);
  }
  return { x, y, cells: Uint32Array.from(cells) };
}

function value(i: number): number { return packed(MAP[4 * i]!, MAP[4 * i + 1]!, MAP[4 * i + 2]!); }

test("triangles cover each pixel of what they make up, and no other", () => {
  const drawn = raster(64), { x, y, cells } = grid(64, 9);
  fill(drawn, { x, y, cells, shares: new Float32Array(x.length).fill(NaN), inCells: false, element: 0 }, palette(tint));
  assert.ok(drawn.pixels.every((pixel) => pixel === packed(10, 20, 30)));
  // Each triangle by itself: together they have all pixels, and none twice.
  const times = new Uint8Array(64 * 64);
  for (let t = 0; 3 * t < cells.length; t += 1) {
    const one = raster(64);
    fill(one, { x, y, cells: cells.slice(3 * t, 3 * t + 3), shares: new Float32Array(x.length).fill(NaN), inCells: false, element: 0 }, palette(tint));
    one.pixels.forEach((pixel, at) => { times[at] = times[at]! + (pixel === GROUND ? 0 : 1); });
  }
  assert.ok(times.every((count) => count === 1));
});

test("a value has its colour at the middle of each pixel, also beyond the ends of the colours", () => {
  const drawn = raster(40), { x, y, cells } = grid(40, 4);
  const shares = x.map((place) => (place / 40) * 1.5 * VALUES - 0.25 * VALUES);
  fill(drawn, { x, y, cells, shares, inCells: false, element: 0 }, palette(tint));
  for (let at = 0; at < 1600; at += 1) {
    const share = (((at % 40) + 0.5) / 40) * 1.5 * VALUES - 0.25 * VALUES;
    const near = [share - 0.01, share + 0.01].map((one) => value(Math.min(Math.max(Math.floor(one), 0), 255)));
    assert.ok(near.includes(drawn.pixels[at]!), `pixel ${at}`);
  }
});

test("edges of elements are white, and those inside an element are not drawn", () => {
  const cells = Uint32Array.from([2, 0, 1, 2, 1, 3]), x = Float32Array.from([0, 40, 0, 40]), y = Float32Array.from([0, 0, 40, 40]);
  const wired = { ...tint, wire: 0.4 };
  for (const [element, white] of [[1, true], [2, false]] as const) {
    const drawn = raster(40);
    fill(drawn, { x, y, cells, shares: new Float32Array(4).fill(NaN), inCells: false, element }, palette(wired));
    assert.equal(drawn.pixels[20 * 40 + 20] !== packed(10, 20, 30), white, `the diagonal of elements of ${element}`);
    assert.equal(drawn.pixels[20 * 40 + 12], packed(10, 20, 30));
    // Half a pixel from the edge it is as white as the shader has it: by 1.3 - 0.5 of all.
    const red = 10 + 245 * 0.4 * 0.8;
    assert.ok(Math.abs((drawn.pixels[20]! & 255) - red) <= 1);
  }
});

test("lines and dots have their areas, whatever their direction", () => {
  for (const angle of [0, 0.4, 1.1, Math.PI / 2, 2.5]) {
    const drawn = raster(60), across = 20 * Math.cos(angle), up = 20 * Math.sin(angle);
    line(drawn, 30 - across, 30 - up, 30 + across, 30 + up, 3, ink);
    const area = drawn.pixels.reduce((sum, pixel) => sum + (255 - (pixel & 255)) / 255, 0);
    assert.ok(Math.abs(area - 3 * (40 + 2 * 0.3 * 3)) < 6, `${area} at ${angle}`);
  }
  const drawn = raster(30);
  dot(drawn, 15.2, 14.7, 10, 1.2, { ...ink, red: 200 }, ink);
  const area = drawn.pixels.reduce((sum, pixel) => sum + (255 - ((pixel >> 8) & 255)) / 255, 0);
  assert.ok(Math.abs(area - Math.PI * 25) < 2, `${area}`);
  assert.equal(drawn.pixels[14 * 30 + 15], packed(200, 0, 0));
});

test("in space the nearer triangle and its lines are seen, whichever comes first", () => {
  const x = Float32Array.from([0, 40, 0, 0, 40, 0]), y = Float32Array.from([0, 0, 40, 0, 0, 40]);
  const seen = Float32Array.from([-1, 1, -2, 1, 1, -2, -1, -1, -2, -1, 1, -4, 1, 1, -4, -1, -1, -4]);
  const z = Float32Array.from([0.2, 0.2, 0.2, 0.6, 0.6, 0.6]);
  const of = { x, y, z, seen, normals: null, shares: new Float32Array(6).fill(NaN), inCells: false, element: 0 };
  for (const order of [[0, 3], [3, 0]]) {
    const drawn = raster(40), depth = new Depth();
    depth.resize(40, 40);
    for (const first of order) {
      fillLit(drawn, depth, { ...of, cells: Uint32Array.from([first, first + 1, first + 2]) }, lit({ ...tint, body: first ? [0, 0, 200] : [200, 0, 0] }), 0);
    }
    // A face towards the eye has 0.42 + 0.38 + 0.2 * 0.66 of its colour, to a step of 255.
    assert.equal(drawn.pixels[10 * 40 + 10], packed(187, 0, 0));
    line(drawn, 0, 5, 20, 5, 2, ink, { depth, from: 0.4, to: 0.4 });
    assert.equal(drawn.pixels[5 * 40 + 10], packed(187, 0, 0));
    line(drawn, 0, 5, 20, 5, 2, ink, { depth, from: 0.1, to: 0.1 });
    assert.equal(drawn.pixels[5 * 40 + 10], packed(0, 0, 0));
  }
});

test("a face that reaches behind the eye is left out", () => {
  const drawn = raster(40), depth = new Depth(), cells = Uint32Array.from([0, 1, 2]);
  depth.resize(40, 40);
  const of = { x: Float32Array.from([0, 40, 0]), y: Float32Array.from([0, 0, 40]), seen: new Float32Array(9).fill(-1), normals: null, cells };
  for (const nearest of [-Infinity, -0.5]) {
    const z = Float32Array.from([nearest, 0, 0]);
    fillLit(drawn, depth, { ...of, z, shares: new Float32Array(3).fill(NaN), inCells: false, element: 0 }, lit(tint), 0);
    assert.equal(drawn.pixels.some((pixel) => pixel !== GROUND), nearest > -1);
  }
});

test("only what has changed is cleared and shown", () => {
  const drawn = raster(50);
  drawn.reach(10, 10, 3);
  drawn.clear(new Color(1, 1, 1));
  drawn.reach(30, 20, 2);
  assert.deepEqual(drawn.changed(), { left: 7, top: 7, right: 32, bottom: 22 });
  drawn.clear(new Color(1, 1, 1));
  assert.deepEqual(drawn.changed(), { left: 28, top: 18, right: 32, bottom: 22 });
  drawn.clear(new Color(0, 0, 0));
  assert.deepEqual(drawn.changed(), { left: 0, top: 0, right: 50, bottom: 50 });
});
