// Tests of the drawing's and the hand's pure functions, run by tests/live/test_page_units.py.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

import { Color, Group, Vector2 } from "three";

import { Bounds } from "../../../lib/restshape/live/page/src/draw/bounds";
import { arrivedPart, nothingSent } from "../../../lib/restshape/live/page/src/draw/shifted";
import { chosenMap, colourTable, ends } from "../../../lib/restshape/live/page/src/draw/colour_maps";
import { follow } from "../../../lib/restshape/live/page/src/draw/follow";
import { arrowLines, Marks } from "../../../lib/restshape/live/page/src/draw/marks";
import { addNormals } from "../../../lib/restshape/live/page/src/draw/normals";
import { autoScale, largest, readable } from "../../../lib/restshape/live/page/src/draw/scale";
import { Ahead } from "../../../lib/restshape/live/page/src/draw/ahead";
import { Sharpness } from "../../../lib/restshape/live/page/src/draw/sharpness";
import { pairsOf, type Segments } from "../../../lib/restshape/live/page/src/draw/segments";
import { whatDraws } from "../../../lib/restshape/live/page/src/draw/drawn";
import { frameOf } from "../../../lib/restshape/live/page/src/frames";
import { newName } from "../../../lib/restshape/live/page/src/hand/names";
import { boxArea, inside, nearestOnPath, rayHit } from "../../../lib/restshape/live/page/src/hand/nearest";
import { folded, Labels, placeOf, roomFor } from "../../../lib/restshape/live/page/src/draw/labels";
import { Turns } from "../../../lib/restshape/live/page/src/hand/turns";
import { turn } from "../../../lib/restshape/live/page/src/hand/turning";
import { placeOnWay } from "../../../lib/restshape/live/page/src/hand/ways";
import type { ArrayPlace, FrameMessage, Part } from "../../../lib/restshape/live/page/src/protocol";

const SIDES = [[1, -1], [-1, -1], [1, 1], [-1, 1]];

interface Known { viridis: number[][]; RdBu: number[][]; message: string; }
const known = JSON.parse(readFileSync(process.env["PAGE_KNOWN"]!, "utf8")) as Known;

function close(found: ArrayLike<number>, wanted: ArrayLike<number>, error = 1e-6): void {
  assert.equal(found.length, wanted.length);
  for (let i = 0; i < wanted.length; i += 1) assert.ok(Math.abs(found[i]! - wanted[i]!) <= error, `${i}: ${found[i]} is not ${wanted[i]}`);
}

test("colours are those of reports", () => {
  for (const map of ["viridis", "RdBu"] as const) {
    const table = colourTable(map);
    known[map].forEach((colour, i) => assert.deepEqual([...table.subarray(4 * i, 4 * i + 3)], colour, `${map} ${i}`));
  }
  assert.equal(chosenMap("auto", true), "RdBu");
  assert.equal(chosenMap("auto", false), "viridis");
  assert.equal(chosenMap("viridis", true), "viridis");
});

test("ends of colours suit the field", () => {
  assert.deepEqual(ends(2, 5, false, false), [2, 5]);
  assert.deepEqual(ends(2, 5, false, true), [0, 5]);
  assert.deepEqual(ends(-1, 3, true, false), [-3, 3]);
  assert.deepEqual(ends(4, 4, false, false), [4, 8]);
  assert.deepEqual(ends(Infinity, -Infinity, false, false), [0, 1]);
});

test("arrays of a message are read where they lie", () => {
  const bytes = Uint8Array.from(Buffer.from(known.message, "base64")).buffer;
  const length = new DataView(bytes).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length))) as FrameMessage;
  const { read } = frameOf(header, bytes, 4 + length);
  const { points, cells } = header.parts[0]!.arrays;
  const places = read(points!);
  assert.equal(places.buffer, bytes);
  close(places, [0, 0, 0, 1, 0, 0, 0, 2, 0]);
  assert.deepEqual([...read(cells!)], [0, 1, 2]);
  assert.throws(() => read({ at: points!.at, type: "f4", shape: [1_000, 3] }), RangeError);
});

test("the nearest point of a path, and what is inside of one", () => {
  const square = Float32Array.from([0, 0, 10, 0, 10, 10, 0, 10, 0, 0]);
  const near = nearestOnPath(square, 0, 5, 4, -3);
  assert.deepEqual([near.distance, near.piece], [3, 0]);
  assert.ok(Math.abs(near.part - 0.4) < 1e-12);
  assert.equal(inside(square, [[0, 5]], 5, 5), true);
  assert.equal(inside(square, [[0, 5]], 11, 5), false);
  // The same square as two paths that do not follow each other.
  const apart = Float32Array.from([10, 10, 0, 10, 0, 0, 0, 0, 10, 0, 10, 10]);
  assert.equal(inside(apart, [[0, 3], [3, 6]], 2, 9), true);
  assert.equal(boxArea(apart, [[0, 3], [3, 6]]), 100);
});

test("a ray hits the nearer triangle, where it is drawn", () => {
  const points = Float32Array.from([0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, -3, 4, 0, -3, 0, 4, -3]);
  const cells = Uint32Array.from([3, 4, 5, 0, 1, 2]);
  const none = new Float32Array(0);
  assert.equal(rayHit(points, none, 1, cells, 0, 2, [1, 1, 10], [0, 0, -1]).t, 10);
  assert.equal(rayHit(points, none, 1, cells, 0, 1, [1, 1, 10], [0, 0, -1]).t, 13);
  assert.equal(rayHit(points, none, 1, cells, 0, 2, [3, 3, 10], [0, 0, -1]).t, Infinity);
  const shifts = new Float32Array(18);
  for (let i = 2; i < 9; i += 3) shifts[i] = 0.5;
  // Aslant it hits where the triangle is drawn, 2 above its place: the shares of its nodes give that place.
  assert.deepEqual(rayHit(points, shifts, 4, cells, 0, 2, [9, 1, 10], [-1, 0, -1]), { t: 8, triangle: 1, u: 0.25, v: 0.25 });
});

test("a hand in space goes in a plane or along an axis", () => {
  const from = [1, 2, 3] as const;
  close(placeOnWay("screen", from, [5, 6, 13], [0, 0, -1], [0, 0, -1])!, [5, 6, 3]);
  close(placeOnWay("xz", from, [5, -8, 13], [0, 1, 0], [0, 1, 0])!, [5, 2, 13]);
  close(placeOnWay("x", from, [5, -8, 13], [0, 1, 0], [0, 1, 0])!, [5, 2, 3]);
  const slanted = Math.SQRT1_2;
  close(placeOnWay("z", [0, 0, 0], [1, -4, 0], [0, slanted, slanted], [0, 1, 0])!, [0, 0, 4]);
  assert.equal(placeOnWay("y", from, [5, -8, 13], [0, 1, 0], [0, 1, 0]), null);
  assert.equal(placeOnWay("xy", from, [5, -8, 13], [0, 1, 0], [0, 1, 0]), null);
});

test("displacements are drawn at a factor that reads well", () => {
  assert.deepEqual([readable(137), readable(0.034), readable(5.1), readable(0.7)], [100, 0.02, 5, 1]);
  close([largest(Float32Array.from([3, 4, 0, 1, 0, 0]))], [5]);
  const scale = autoScale(1, 1e-3, 2);
  assert.equal(scale, 100);
  assert.equal(autoScale(scale, 2e-3, 2), scale);
  assert.ok(autoScale(scale, 2e-2, 2) < scale);
  assert.equal(autoScale(7, 0, 2), 7);
});

test("the outline goes with the border of the mesh", () => {
  const points = Float32Array.from([0, 0, 0, 2, 0, 0, 2, 1, 0]);
  const shifts = Float32Array.from([0, 0, 0, 0, 2, 0, 0, 4, 0]);
  const found = new Float32Array(9);
  const pieces = new Uint32Array(3), places = Float32Array.from([0.5, 0, 0, 2, 0.25, 0, 0, 0.8, 0]);
  const look = (): void => follow(found, places, Uint32Array.from([0, 1, 1, 2]), points, shifts, 2.2, pieces);
  look();
  const first = found.slice();
  look();
  assert.deepEqual([...found], [...first]);
  assert.deepEqual([...pieces.subarray(0, 2)], [0, 1]);
  close(found, [0, 0.5, 0, 0, 2.5, 0, 0, 0, 0]);
});

test("lines, arrows, normals, boxes, names and turns", () => {
  assert.deepEqual(pairsOf(5, [0, 3]), [0, 1, 1, 2, 3, 4]);
  const { ends: arrows, starts } = arrowLines(Float32Array.from([0, 0, 0, 1, 1, 0]), Float32Array.from([0, 2, 0, 1, 0, 0]), 0.5);
  close(arrows, [0, 0, 0, 0, 0.5, 0, 1, 1, 0, 1.25, 1, 0]);
  assert.deepEqual(starts, [0, 2]);
  const pushing = arrowLines(Float32Array.from([0, 0, 0, 1, 1, 0]), Float32Array.from([0, 2, 0, 1, 0, 0]), 0.5, [true, false]);
  close(pushing.ends, [0, -0.5, 0, 0, 0, 0, 1, 1, 0, 1.25, 1, 0]);
  const normals = new Float32Array(9);
  addNormals(normals, Float32Array.from([0, 0, 0, 2, 0, 0, 0, 3, 0]), new Float32Array(0), 1, Uint32Array.from([0, 1, 2]));
  close(normals, [0, 0, 6, 0, 0, 6, 0, 0, 6]);
  const box = new Bounds();
  box.add(Float32Array.from([0, 0, 0, 3, 4, 0]), Float32Array.from([0, 0, 0, 0, 0, 6]), 2);
  assert.equal(box.size(), 13);
  assert.equal(newName("hole_", new Set(["hole_1", "hole_3"])), "hole_2");
  close([turn({ x: 1, y: 0 }, { x: 0, y: -1 })], [Math.PI / 2]);
});

test("a picture that is drawn late takes fewer pixels until it is at rest", () => {
  let now = 0, changes = 0;
  const draw = (ms: number): number => {
    sharpness.request(now);
    sharpness.begin(now += ms, true);
    return sharpness.share;
  };
  const sharpness = new Sharpness(() => { changes += 1; });
  for (let i = 0; i < 40; i += 1) assert.equal(draw(16), 1);
  const late = Array.from({ length: 8 }, () => draw(30));
  assert.deepEqual([late[0], late[7], changes], [1, 0.5, 2]);
  for (let i = 0; i < 119; i += 1) assert.equal(draw(16), 0.5);
  assert.equal(draw(16), 0.75); // in time for long: tried again
  sharpness.settle();
  assert.equal(sharpness.share, 1);
  assert.equal(draw(16), 0.75); // it has learned what it can
  sharpness.settle();
});

test("a picture whose drawings take half a turn takes fewer pixels, and no fewer than they need", () => {
  let now = 0;
  const sharpness = new Sharpness(() => undefined);
  // What is drawn takes 10 ms with all pixels, less with fewer.
  const draw = (whole: number): number => {
    sharpness.request(now);
    sharpness.begin(now += 16, true);
    const share = sharpness.share;
    sharpness.took(whole * share ** 2);
    return share;
  };
  for (let i = 0; i < 40; i += 1) assert.equal(draw(7), 1);
  const shares = Array.from({ length: 60 }, () => draw(12));
  assert.deepEqual([shares[0], shares[2], shares[3], shares[59]], [1, 1, 0.75, 0.75]);
  for (let i = 0; i < 3; i += 1) draw(20);
  assert.equal(draw(20), 0.5);
  sharpness.settle();
  assert.equal(sharpness.share, 1);
});

test("a frame is drawn before the display asks, unless that was in vain three times", () => {
  const ahead = new Ahead();
  const turns = (frames: number, count: number): boolean[] => Array.from({ length: count }, () => {
    const wanted = Array.from({ length: frames }, () => ahead.wants());
    ahead.turn();
    return wanted.includes(true);
  });
  assert.deepEqual(turns(2, 2), [true, true]); // twice in vain
  assert.deepEqual(turns(1, 3), [true, true, true]);
  assert.deepEqual(turns(2, 5), [true, true, true, false, false]);
  const later = turns(1, 30);
  assert.equal(later.indexOf(true), 18);
  assert.ok(later.slice(18).every((one) => one));
});

test("the hand sends one place for each turn of the display, the last one always", () => {
  let turn: (() => void) | null = null;
  Object.assign(globalThis, { requestAnimationFrame: (call: () => void) => { turn = call; return 0; } });
  const turns = new Turns(), sent: number[] = [];
  for (const place of [1, 2, 3]) turns.take(() => sent.push(place));
  assert.deepEqual(sent, [1]);
  turn!();
  assert.deepEqual(sent, [1, 3]);
  turn!();
  turns.take(() => sent.push(4)); // nothing was sent since the last turn
  turns.take(() => sent.push(5));
  assert.deepEqual(sent, [1, 3, 4]);
  turns.flush();
  turns.flush();
  assert.deepEqual(sent, [1, 3, 4, 5]);
});

test("a part that has moved as it lies is read where it has gone", () => {
  const place = (at: number): ArrayPlace => ({ at, type: "f4", shape: [2, 3] });
  const sent = [Float32Array.of(0, 0, 0, 1, 2, 3), Float32Array.of(5, 5, 5, 6, 6, 6), Float32Array.of(7, 7, 7, 8, 8, 8)];
  const read = ({ at }: ArrayPlace): Float32Array => sent[at]!;
  const part = (arrays: Part["arrays"], shift?: [number, number, number]): Part =>
    ({ name: "shape", kind: "surface", role: "shape", arrays, ...(shift && { shift }) });
  const kept = nothingSent();
  const at = (given: Part, key: string): Float32Array | null => {
    const found = arrivedPart(given, read, kept), where = found.part.arrays[key];
    return where ? found.read(where) as Float32Array : null;
  };
  assert.equal(at(part({ points: place(0) }), "points"), sent[0]);
  close(at(part({}, [1, 0, -1]), "points")!, [1, 0, -1, 2, 2, 2]);
  close(at(part({}, [2, 0, 0]), "points")!, [2, 0, 0, 3, 2, 3]); // from where they came, not from where they were
  assert.equal(at(part({}, [2, 0, 0]), "points"), null); // as before
  assert.equal(arrivedPart(part({}, [3, 0, 0]), read, kept).along, true);
  assert.equal(at(part({}), "points"), sent[0]);
  close(at(part({ displacement: place(1) }, [0, 1, 0]), "displacement")!, [5, 6, 5, 6, 7, 6]);
  assert.equal(at(part({}, [0, 2, 0]), "points"), null);
  assert.equal(arrivedPart(part({ displacement: place(2) }), read, kept).along, false);
  assert.deepEqual([...sent[0]!], [0, 0, 0, 1, 2, 3]);
});

test("nodal lines have a seam in the colour of the ground, since they lie where colours are darkest", () => {
  const colours = new Map<string, Color>(), group = new Group();
  const colour = (name: string): Color => colours.get(name) ?? colours.set(name, new Color(0)).get(name)!;
  const shared = { scale: { value: 1 }, size: { value: new Vector2(1, 1) }, pixels: { value: 1 } };
  const marks = new Marks(group, shared as never, { colour } as never, { set: () => true } as never, () => {});
  const drawn = (): Segments[] => group.children.filter((one) => one.visible).map((one) => whatDraws(one) as Segments);
  const line = { points: Float32Array.of(0, 0, 0, 1, 0, 0), starts: [0] };
  marks.setLines("still", { ...line, meaning: "node" });
  const [seam, node] = drawn();
  assert.ok(seam!.width.value > node!.width.value + 2 && seam!.colour.value === colour("ground") && node!.colour.value === colour("node"));
  assert.deepEqual([...seam!.points], [...node!.points]);
  marks.setLines("still", { ...line, meaning: "guide" });
  assert.deepEqual(drawn().map((one) => one.colour.value), [colour("guide")]);
  marks.setLines("still", null);
  assert.equal(group.children.length, 0);
});

test("words leave handles free where another side of their place does", () => {
  const word = { width: 60, height: 17, spot: 0 }, around = { width: 400, height: 300, taken: [], handles: [], spots: 4 };
  const [left, top, right, bottom] = roomFor(word, 100, 100, around)!;
  assert.ok(left > 100 && bottom < 100);
  const beside: [number, number, number, number] = [left + 5, top + 2, left + 15, top + 12];
  const other = roomFor(word, 100, 100, { ...around, handles: [beside] })!;
  assert.ok(other[2] < 100 && word.spot === 1);         // to the left of its place
  const all = SIDES.map(([x, y]): [number, number, number, number] => [100 + 20 * x!, 100 + 12 * y!, 101 + 20 * x!, 101 + 12 * y!]);
  assert.deepEqual(roomFor(word, 100, 100, { ...around, handles: all }), other); // handles at all sides: where it was
  assert.equal(roomFor(word, 100, 100, { ...around, taken: all }), null);
  assert.ok(right - left === 60);
});

test("words stay within the picture on all sides of their place", () => {
  const free = { width: 390, height: 300, taken: [], handles: [], spots: 4 };
  for (const width of [100, 271, 380]) {
    for (const x of [5, 150, 380]) {
      for (let spot = 0; spot < 4; spot += 1) {
        const [left, , right] = roomFor({ width, height: 17, spot }, x, 150, free)!;
        assert.ok(left >= 0 && right <= 390, `${width} wide at ${x}, side ${spot}: from ${left} to ${right}`);
      }
    }
  }
  const tall = roomFor({ width: 60, height: 32, spot: 2 }, 100, 290, free)!;
  assert.ok(tall[3] === 300 && tall[1] === 268);
});

interface Written { style: { visibility: string; transform: string }; textContent: string; }

/** Words on a page that is none: their elements, and what waits for the painter's next turn; resized: how often they are placed anew. */
function labelled(): { labels: Labels; elements: Written[]; turn: () => void; resized: () => number } {
  const elements: Written[] = [];
  let waiting = (): void => {}, resized = 0;
  globalThis.document = {
    createElement: (kind: string) => (kind === "canvas" ? { getContext: () => null } : { style: {}, textContent: "" }),
  } as never;
  globalThis.devicePixelRatio = 1;
  const over = { append: (one: Written) => elements.push(one) }, painter = { soon: (then: () => void) => { waiting = then; } };
  const labels = new Labels(over as never, painter as never, () => { resized += 1; });
  return { labels, elements, turn: () => waiting(), resized: () => resized };
}

test("words that are written anew are placed anew where their size is another one", () => {
  const { labels, elements, turn, resized } = labelled(), peak = { at: [50, 50, 0], meaning: "guide" };
  for (const [text, count] of [["peak", 0], ["peak 12 MPa", 1], ["peak 14 MPa", 1]] as const) {
    labels.set("words", [{ ...peak, text }]);
    turn();
    assert.deepEqual([elements[0]!.textContent, resized()], [text, count]);
  }
});

test("words that say something by themselves have their places before those of lines", () => {
  const { labels, elements } = labelled();
  const at = Array.from({ length: 10 }, () => ({ at: [50, 50, 0], meaning: "guide" }));
  labels.set("lines", at.map((one, i) => ({ ...one, text: `line ${i}` })));
  labels.set("words", [{ ...at[0]!, text: "peak 12 MPa" }], true);
  labels.place({ toScreen: (x: number, y: number) => ({ x, y, z: 0 }) } as never, 400, 300, 1, []);
  const seen = elements.filter((one) => one.style.visibility !== "hidden").map((one) => one.textContent);
  assert.deepEqual(seen, ["peak 12 MPa"]);
});

test("words that are wider than the picture come in lines", () => {
  const width = (text: string): number => 10 * text.length;
  assert.deepEqual(folded("peak 12 MPa", 110, width), ["peak 12 MPa"]);
  assert.deepEqual(folded("strength is 12 MPa, nearer to it", 130, width), ["strength is", "12 MPa,", "nearer to it"]);
  assert.deepEqual(folded("unbreakable ends", 50, width), ["unbreakable", "ends"]);
});

test("words move from pixel to pixel of the display", () => {
  assert.equal(placeOf(10.3, 20.8, 1), "translate(10px, 21px)");
  assert.equal(placeOf(10.49, 20.51, 1), placeOf(9.5, 21.49, 1));
  assert.equal(placeOf(10.3, 20.8, 2), "translate(10.5px, 21px)");
});
