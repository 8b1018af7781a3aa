// Tests of the panels' pure functions, run by tests/live/test_panel_units.py.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

import { errorOfAnswer } from "../../../lib/restshape/live/page/src/panels/answer";
import { byKind, taken } from "../../../lib/restshape/live/page/src/panels/decoded_marks";
import { FrameHistory } from "../../../lib/restshape/live/page/src/panels/frame_history";
import { hasEarlierErrors } from "../../../lib/restshape/live/page/src/panels/frame_values";
import { foundNumbers, shownText, slid, sliderRange, typedValue } from "../../../lib/restshape/live/page/src/panels/given_numbers";
import { entriesOf } from "../../../lib/restshape/live/page/src/panels/legend";
import { extremes, pixel, placeNames, thinned, valueAt, type Axis } from "../../../lib/restshape/live/page/src/panels/plot_geometry";
import { arrowTurn, fallsAtAll, fallText, rateText, shareText } from "../../../lib/restshape/live/page/src/panels/rate_text";
import { exampleOf, fieldsOf } from "../../../lib/restshape/live/page/src/panels/schema_fields";
import { continues, eventLine, eventsOf } from "../../../lib/restshape/live/page/src/panels/script_lines";
import { distanceText, errorText, extremeText, siText } from "../../../lib/restshape/live/page/src/panels/si_text";
import { MarkGroup, type DrawnMark, type Stage, type ValueText, type WordToDraw } from "../../../lib/restshape/live/page/src/panels/stage";
import { axisRange, powerLabels, powerTicks, tickLabels, ticks } from "../../../lib/restshape/live/page/src/panels/ticks";
import type { FrameMessage, MarkMessage } from "../../../lib/restshape/live/page/src/protocol";
import { alike, partials, volumeGain } from "../../../lib/restshape/live/page/src/panels/tone_parameters";
import { pointText, TypedError, valueOf } from "../../../lib/restshape/live/page/src/panels/typed_values";

test("numbers of a scene are shown as written, but without digits that nobody reads", () => {
  for (const text of ["10 mm", "7850 kg/m^3", "5e-6 N m", "0.1234567", "2 * width", "210123456789", "a_1.234567890"]) assert.equal(shownText(text), text);
  assert.equal(shownText("0.15509690299999998"), "0.1550969");
  assert.equal(shownText("-12.345678901 mm"), "-12.34568 mm");
  assert.equal(shownText("1.0000000001e-05"), "0.00001");
});

test("numbers have SI prefixes as on the console", () => {
  assert.equal(siText(240_876_036, "Pa"), "240.9 MPa");
  assert.equal(siText(2.1e-4, "m", 3), "210 µm");
  assert.equal(siText(-999_999.99, "N"), "−1.000 MN");
  assert.equal(siText(12_345, "cent"), "12345 cent");
  assert.equal(siText(0.25, "1"), "0.2500");
  assert.equal(siText(0, "m"), "0 m");
  assert.equal(siText(NaN, "Pa"), "–");
  assert.equal(siText(2e9, "m^2"), "2.000e9 m²");
  assert.equal(errorText(2e6, 2e8, "Pa"), "error 2.0 MPa (1.0 %)");
  assert.equal(extremeText("peak", 240_876_036, -2e6, "Pa"), "peak 240.9 MPa (error 2.0 MPa)");
  assert.equal(extremeText("peak", 240_876_036, 1e-3, "Pa"), "peak 240.9 MPa (error 0 Pa)");
  for (const none of [undefined, null, NaN]) assert.equal(extremeText("peak", 240_876_036, none, "Pa"), "peak 240.9 MPa");
  assert.equal(errorText(null, 1, "Pa"), "no limit under refinement");
  assert.equal(errorText(Infinity, 1, "Pa"), "no limit under refinement");
  assert.equal(errorText(undefined, 1, "Pa"), "");
});

test("errors of predicted frames that are an earlier frame's are said to be", () => {
  const predicted = (columns: object): FrameMessage => ({ columns: { predicted: 1, estimate: 0.012, ...columns } }) as unknown as FrameMessage;
  assert.equal(hasEarlierErrors(predicted({})), true);
  assert.equal(hasEarlierErrors(predicted({ residual: 1e-3 })), false);
  assert.equal(hasEarlierErrors(predicted({ predicted: 0 })), false);
  assert.equal(errorOfAnswer(predicted({})), "about 1.2 %, by an earlier frame and the hand's way since");
  assert.equal(errorOfAnswer(predicted({ residual: 1e-3 })), "1.2 %");
  assert.equal(distanceText(2e6, 2e8, "Pa", true), "off by about 2.0 MPa (1.0 %)");
  assert.equal(distanceText(2e6, 2e8, "Pa", false), "off by 2.0 MPa (1.0 %)");
  assert.equal(distanceText(NaN, 2e8, "Pa", true), "");
});

test("what is drawn without words has its name in the legend, once", () => {
  const drawn = (kind: "lines" | "arrows", name: string, words: string[], starts: number[]): DrawnMark =>
    ({ kind, name, words, starts, meaning: "force", points: new Float32Array(9) }) as unknown as DrawnMark;
  const marks = [drawn("lines", "touches a body", [], [0, 1, 2]), drawn("lines", "support wall", ["", ""], [0]), drawn("arrows", "load", [], []),
    drawn("lines", "seam", ["seam", ""], [0]), drawn("lines", "support wall", [], [0])];
  assert.deepEqual(entriesOf(marks).map(({ sign, name }) => `${sign} ${name}`), ["● touches a body", "— support wall", "→ load"]);
  const many = Array.from({ length: 9 }, (_, k) => drawn("lines", `support ${k}`, [], [0]));
  assert.deepEqual(entriesOf(many).at(-1), { sign: "…", name: "and 4 more", meaning: "guide" });
});

test("ticks are round numbers inside of the range", () => {
  assert.deepEqual(ticks(0, 10, 5), [0, 2, 4, 6, 8, 10]);
  assert.deepEqual(ticks(-0.13, 0.21, 4), [-0.1, 0, 0.1, 0.2]);
  assert.deepEqual(tickLabels([-0.1, 0, 0.1, 0.2]), ["−0.1", "0.0", "0.1", "0.2"]);
  assert.deepEqual(powerLabels([1e-6, 0.01, 1, 1e12]), ["10⁻⁶", "0.01", "1", "10¹²"]);
  assert.deepEqual(powerTicks(0.5, 2e6, 4), [1, 100, 10_000, 1e6]);
  for (let trial = 0; trial < 200; trial += 1) {
    const low = (Math.random() - 0.5) * 10 ** (6 * Math.random() - 3), high = low + 10 ** (6 * Math.random() - 3);
    const found = ticks(low, high, 4);
    assert.ok(found.length >= 2 && found.length <= 9, `${found.length} ticks from ${low} to ${high}`);
    assert.ok(found.every((one) => one >= low - 1e-6 * (high - low) && one <= high + 1e-6 * (high - low)));
    assert.equal(new Set(tickLabels(found)).size, found.length, `labels of ${found.join()} are told apart`);
  }
  const [low, high] = axisRange(3, 3);
  assert.ok(low < 3 && high > 3);
  const level = axisRange(-1.00000001, -1);
  assert.ok(level[1] - level[0] > 1e-3);
});

test("thinned lines keep extremes and gaps", () => {
  const many = 10_000;
  const x = Float64Array.from({ length: many }, (_, index) => index);
  const y = Float64Array.from(x, (value) => Math.sin(value / 900));
  y[5_432] = 7;
  y[8_000] = NaN;
  const across: Axis = { low: 0, high: many, from: 40, to: 340, logarithmic: false };
  const up: Axis = { low: -1, high: 7, from: 100, to: 10, logarithmic: false };
  const line = thinned(x, y, across, up);
  assert.ok(line.length / 2 < 4.1 * 301, `${line.length / 2} points`);
  const heights = line.filter((_, index) => index % 2);
  assert.equal(Math.min(...heights.filter(Number.isFinite)), pixel(up, 7));
  assert.equal(heights.filter(Number.isNaN).length, 1);
  const log: Axis = { low: 1, high: 1000, from: 90, to: 0, logarithmic: true };
  assert.ok(Math.abs(pixel(log, 10) - 60) < 1e-9 && Math.abs(valueAt(log, 60) - 10) < 1e-9);
  assert.deepEqual(extremes([NaN, -1, 4], true), [4, 4]);
});

test("a history is cut where the hand takes over, and kept where a script is scrubbed", () => {
  const history = new FrameHistory();
  for (let frame = 0; frame < 200; frame += 1) history.add(frame, [["q", frame]], false);
  history.add(50, [["q", -1]], true);
  assert.equal(history.series("q").all[199], 199);
  history.add(60, [["q", -2]], false);
  assert.deepEqual([...history.series("q").all.subarray(58)], [58, 59, -2]);
  history.add(63, [["q", 5]], false);
  const { x, y } = history.points("q");
  assert.deepEqual([...x.slice(58), ...y.slice(58)], [58, 59, 60, 63, 58, 59, -2, 5]);
});

const POINT = { type: "array", items: { anyOf: [{ type: "number" }, { type: "string" }] }, minItems: 2, maxItems: 3 };
const SCHEMA = {
  properties: {
    t: { type: "number" }, do: { const: "drag" }, frames: { default: 1, type: "integer", minimum: 1 },
    to: { anyOf: [POINT, { type: "null" }], default: null }, path: { anyOf: [{ type: "array", items: { $ref: "#/$defs/P" }, minItems: 2 }, { type: "null" }] },
    on: { type: "string" }, mouth: { enum: ["kept", "straight"], type: "string" }, value: {},
  },
  required: ["t", "do", "on"], $defs: { P: POINT },
};

test("a schema becomes fields, whose typed texts become values", () => {
  const fields = new Map(fieldsOf(SCHEMA).map((field) => [field.name, field]));
  assert.deepEqual([...fields.keys()][0], "on");
  assert.deepEqual([...fields.values()].map((one) => `${one.name} ${one.kind}`).sort(),
    ["frames whole", "mouth choice", "on name", "path points", "to point", "value any"]);
  const value = (name: string, text: string) => valueOf(fields.get(name)!, text);
  assert.deepEqual(value("to", "0.3, 20 mm"), [0.3, "20 mm"]);
  assert.deepEqual(value("path", "0, 1; 2, 3, 4"), [[0, 1], [2, 3, 4]]);
  assert.deepEqual(value("value", "[1, 2]"), [1, 2]);
  assert.equal(value("value", "steel"), "steel");
  assert.equal(value("frames", ""), undefined);
  for (const [name, text] of [["to", "1"], ["path", "0, 1"], ["frames", "1.5"], ["frames", "2 mm"], ["on", " "]]) {
    assert.throws(() => value(name!, text!), TypedError, `${name}: ${text}`);
  }
  assert.equal(pointText([0.123456, -1e-9, 7], 2), "0.12346, 0");
});

test("numbers of the scene keep the unit that the scene writes", () => {
  const info = { key: "parameters.width", value: 0.01, text: "10 mm", unit: "m", parameter: true, low: 0.005, high: 0.02 };
  const range = sliderRange(info);
  assert.deepEqual([range.low, range.high, range.unit], [5, 20, "mm"]);
  assert.deepEqual(slid(info, range, 12.5), { do: "set", key: "parameters.width", value: "12.5 mm" });
  assert.equal(typedValue("12", "10 mm"), "12 mm");
  assert.equal(typedValue("1 cm", "10 mm"), "1 cm");
  assert.equal(typedValue("12", "0.3"), 12);
  const plain = sliderRange({ key: "k", value: -2, text: "-2", unit: "", parameter: false });
  assert.ok(plain.low < -2 && plain.high > -2 && plain.unit === "");
  const modes = sliderRange({ key: "modes", value: 5, text: "5", unit: "", parameter: false, whole: true, low: 1, high: 1000 });
  assert.deepEqual([modes.low, modes.high, modes.step], [2, 10, 1]);
  assert.ok(sliderRange({ key: "k", value: 0, text: "0", unit: "", parameter: false }).high > 0);
  const numbers = ["material.steel.thickness", "material.steel.density", "loads.top.value"].map((key) => ({ ...info, key }));
  assert.deepEqual(foundNumbers(numbers, "steel th", 5).shown.map((one) => one.key), ["material.steel.thickness"]);
  assert.equal(foundNumbers(numbers, "", 2).more, 1);
});

test("a tone does not clip, has only what is heard, and ends", () => {
  const tone = { frequencies: [523, 2093, 4, 40_000, 6000], decays: [3, 12, 1, 1, 0], amplitudes: [1, 0.5, 1, 1, 1e-6] };
  const played = partials(tone);
  assert.deepEqual(played.map((one) => one.frequency), [523, 2093]);
  assert.ok(played.reduce((sum, one) => sum + one.gain, 0) <= 0.5 + 1e-12);
  assert.ok(Math.abs(played[0]!.seconds - Math.log(1000) / 3) < 1e-9);
  assert.deepEqual(partials({ frequencies: [], decays: [], amplitudes: [] }), []);
  const mark = { kind: "tone", name: "", ...tone } as const;
  const shifted = (cents: number) => ({ ...mark, frequencies: mark.frequencies.map((one) => one * 2 ** (cents / 1200)) });
  assert.ok(alike(mark, shifted(0.5)) && !alike(mark, shifted(2)) && !alike(null, mark));
  assert.equal(volumeGain(0), 0);
  assert.equal(volumeGain(1), 1);
});

test("rates are read for each millimetre, or percent, and point where the quantity grows", () => {
  assert.equal(rateText([2e9, -1e9], "Pa", 1e8), "+2.00 MPa in x, −1.00 MPa in y a mm (2.2 %)");
  assert.equal(rateText([0, 0], "Pa", 1), "does not change");
  assert.equal(rateText([2e9, -2.51e-9], "Pa", 1e8), "+2.00 MPa in x, 0 MPa in y a mm (2.0 %)");
  assert.equal(siText(-2.51e-15, "1", 3), "−2.51e−15");
  assert.equal(shareText(-2e10, 0.01, "Pa", 2e8), "−2.00 MPa (−1.0 %)");
  assert.equal(shareText(1e-6, 0.01, "Pa", 2e8), "does not change");
  assert.equal(arrowTurn([0, 2]), -90);
  assert.equal(arrowTurn([-1]), 180);
  assert.equal(arrowTurn([0, 0]), null);
});

test("lines of a script are events, and drags of many frames are one", () => {
  const events = eventsOf('{"format": "restshape-edits", "version": 1}\n{"t": 0, "do": "press", "on": "a"}\n{"t": 1, "do": "drag", "to": [0.1, 2]}\n{"t"');
  assert.deepEqual(events.map(eventLine), ["press · on a", "drag · to (0.1, 2)"]);
  assert.ok(continues(events[1]!, events[1]!) && !continues(events[0]!, events[1]!) && !continues(null, events[1]!));
  assert.ok(!continues({ do: "set", key: "a" }, { do: "set", key: "b" }));
});

test("every event of all applications has a form that asks for each of its keys by its kind", () => {
  const models = JSON.parse(readFileSync(process.env["SCRIPT_SCHEMA"]!, "utf-8")).$defs as Record<string, { properties: Record<string, object> }>;
  assert.ok(Object.keys(models).length > 20);
  for (const [name, model] of Object.entries(models)) {
    const fields = fieldsOf(model);
    assert.deepEqual(new Set(["do", "note", "t", "gesture", ...fields.map((field) => field.name)]), new Set(["do", "note", "t", "gesture", ...Object.keys(model.properties)]));
    for (const field of fields) {
      assert.notEqual(field.help, "", `${name}: ${field.name}`);
      assert.equal(field.kind === "any", field.name === "value", `${name}: ${field.name} is asked for as ${field.kind}`);
      if (["factor", "mass"].includes(field.name)) assert.ok(!exampleOf(field).includes("mm"), `${name}: ${field.name}, such as ${exampleOf(field)}`);
    }
  }
  const angles = Object.values(models).flatMap(fieldsOf).filter((field) => field.name === "by" && field.required);
  assert.ok(angles.length && angles.every((field) => exampleOf(field) === "30 deg"));
});

test("names of upright lines do not cover each other", () => {
  const x = [100, 102, 104, 106, 290], wide = [40, 40, 40, 40, 40];
  const places = placeNames(x, wide, 20, 300, 4);
  const boxes = places.map((place) => place && [place.left, place.left + 40, place.row] as const);
  boxes.forEach((one, i) => boxes.slice(i + 1).forEach((other) => {
    if (one && other && one[2] === other[2]) assert.ok(one[1] < other[0] || other[1] < one[0]);
  }));
  assert.ok(boxes.every((one) => one && one[0] >= 20 && one[1] <= 300));
  assert.deepEqual(placeNames([100, 101], [70, 70], 95, 180, 1), [{ left: 103, row: 0 }, null]);
});

test("how a quantity falls is said beside its arrow", () => {
  assert.equal(fallText("peak_stress", 2e9, "Pa", 2e8), "peak_stress falls by 2.00 MPa a mm (1.0 %)");
  assert.ok(fallsAtAll(2e9, 2e8) && !fallsAtAll(1e-3, 2e8) && !fallsAtAll(NaN, 1));
});

test("marks at nodes of the shape lie in their middles, in each frame of it", () => {
  const set: { name: string; points: number[]; moved: number[] | null }[] = [];
  const shape = { points: Float32Array.of(0, 0, 0, 2, 0, 0, 2, 4, 0), shifts: Float32Array.of(0, 0, 0, 0, 0, 1, 0, 2, 1) };
  const nothing = (): void => undefined, words: (WordToDraw[] | null)[] = [], said: ValueText = ({ name }) => `${name} ${words.length}`;
  const stage: Stage = {
    pick: () => Promise.resolve(null), where: () => null, shape: () => shape, setArrows: nothing, setWords: (_, now) => words.push(now),
    setLines: (name, lines) => { if (lines) set.push({ name, points: [...lines.points], moved: lines.moved && [...lines.moved] }); },
  };
  const arrays = { nodes: Uint32Array.of(0, 1, 1, 2) };
  const line: MarkMessage = { kind: "lines", name: "support", meaning: "support", starts: [0], words: [], nodes: { at: 0, type: "u4", shape: [2, 2] } };
  const read = (): Uint32Array => arrays.nodes;
  const first = taken([line], read, []);
  const group = new MarkGroup(stage, "marks");
  group.draw(byKind(first).drawn, said);
  assert.deepEqual(set.at(-1), { name: "marks: support", points: [1, 0, 0, 2, 2, 0], moved: [0, 0, 0.5, 0, 1, 1] });
  shape.points[0] = 1;
  group.follow(said);
  assert.deepEqual(set.at(-1)?.points, [1.5, 0, 0, 2, 2, 0]);
  assert.deepEqual(words, [null]);
  // So do values of quantities, whose texts change with the frame.
  const place: MarkMessage = { kind: "words", text: "2 N", at: [0, 0], meaning: "load" };
  group.draw(byKind(taken([{ kind: "value", name: "peak", unit: "Pa", node: 1 }, place], read, [])).drawn, said);
  const beside = { text: "peak 1", at: [2, 0, 0], meaning: "guide", moved: [0, 0, 1] };
  assert.deepEqual(words.at(-1), [{ text: "2 N", at: [0, 0], meaning: "load", moved: undefined }, beside]);
  shape.shifts[3] = 5;
  group.follow(said);
  assert.deepEqual(words.at(-1)?.at(-1), { ...beside, text: "peak 2", moved: [5, 0, 1] });
  group.draw([], said);
  assert.equal(words.at(-1), null);
  // A mark that stays is not said again.
  const second = taken([null, { kind: "words", text: "2 N", at: null, meaning: "guide" }], read, first);
  assert.equal(second[0], first[0]);
  assert.equal(byKind(second).drawn.length, 2);
  assert.equal(taken([null], read, []).length, 0);
});
