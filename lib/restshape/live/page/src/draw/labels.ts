// Words beside places: elements over the canvas, which move with the picture and do not cover each other.

import { Vector3 } from "three";

import type { Painter } from "../panels/painter";
import type { View } from "./view";

/** moved: displacement of the place, where it goes with the deformation that is drawn. */
export interface Word { text: string; at: ArrayLike<number>; meaning: string; moved?: ArrayLike<number> | null; }
/** text: that it will have at the painter's next turn; said: that it has. place: where it is, as the style has it. spot: beside its place. */
interface Shown extends Size {
  element: HTMLSpanElement; at: Vector3; moved: Vector3; text: string; said: string; meaning: string; place: string; free: boolean; spot: number;
}
/** Of words, with padding. */
interface Size { width: number; height: number; }

const BESIDE = 9; // pixels from the place
const LINE = 15; // pixels of a line
const PADDING = { width: 8, height: 2 };
const MANY = 9; // words, which would hide the shape if each had a place somewhere
/** Where a word may be beside its place: to the right or left, above or below. */
const SPOTS = [{ right: true, above: true }, { right: false, above: true }, { right: true, above: false }, { right: false, above: false }];

/** Left, top, right, bottom. */
export type Box = [number, number, number, number];

export class Labels {
  covered: Box[] = [];                               // where no word is, since something else lies there
  private room = Infinity;                           // width of the picture
  private readonly sets = new Map<string, Shown[]>();
  private readonly foremost = new Set<string>();     // names of words that have their places before those of lines and arrows
  private readonly work = new Vector3();

  /** resized: is told that words have another size, and so perhaps another place. */
  constructor(private readonly over: HTMLElement, private readonly painter: Painter, private readonly resized: () => void) {}

  /** Words under a name, in place of those before; none: takes them away. False: there were none, and there are none. */
  set(name: string, words: readonly Word[], foremost = false): boolean {
    if (foremost) this.foremost.add(name);
    const shown = this.sets.get(name) ?? [], any = shown.length + words.length > 0;
    while (shown.length > words.length) shown.pop()!.element.remove();
    while (shown.length < words.length) shown.push(this.make());
    words.forEach((word, i) => this.write(shown[i]!, word));
    if (words.length) this.sets.set(name, shown);
    else this.sets.delete(name);
    return any;
  }

  /** Moves all words to where their places are seen. scale: of displacements; handles: which they cover only where there is no other place. */
  place(view: View, width: number, height: number, scale: number, handles: readonly Box[]): void {
    if (width !== this.room) this.foldAll(width);
    const taken: Box[] = [...this.covered], spots = this.count > MANY ? 1 : SPOTS.length;
    for (const shown of this.inOrder()) {
      for (const one of shown) {
        const { x, y, z } = view.toScreen(
          one.at.x + scale * one.moved.x, one.at.y + scale * one.moved.y, one.at.z + scale * one.moved.z, this.work,
        );
        const seen = z < 1 && x > -20 && y > -20 && x < width + 20 && y < height + 20;
        const box = seen ? roomFor(one, x, y, { width, height, taken, handles, spots }) : null;
        const free = box !== null, [left, top] = box ?? [0, 0];
        if (free) taken.push(box);
        if (one.free !== free) one.element.style.visibility = free ? "visible" : "hidden";
        one.free = free;
        const place = placeOf(left, top, devicePixelRatio || 1);
        if (free && one.place !== place) one.element.style.transform = one.place = place;
      }
    }
  }

  private *inOrder(): Iterable<Shown[]> {
    for (const first of [true, false]) for (const [name, shown] of this.sets) if (this.foremost.has(name) === first) yield shown;
  }

  private get count(): number {
    let count = 0;
    for (const shown of this.sets.values()) count += shown.length;
    return count;
  }

  private make(): Shown {
    const element = document.createElement("span");
    this.over.append(element);
    return { element, at: new Vector3(), moved: new Vector3(), width: 0, height: 0, text: "", said: "", meaning: "", place: "", free: true, spot: 0 };
  }

  /** Places change with each frame; texts that change with it are written as often as they can be read. */
  private write(shown: Shown, { text, at, meaning, moved }: Word): void {
    shown.at.set(at[0] ?? 0, at[1] ?? 0, at[2] ?? 0);
    shown.moved.set(moved?.[0] ?? 0, moved?.[1] ?? 0, moved?.[2] ?? 0);
    if (shown.meaning !== meaning) shown.element.style.color = `var(--${meaning}, var(--guide))`;
    shown.meaning = meaning;
    shown.text = text;
    if (shown.said === "") say(shown, this.room);
    else if (shown.said !== text) this.painter.soon(this.sayAll);
  }

  private readonly sayAll = (): void => {
    let resized = false;
    for (const shown of this.sets.values()) {
      for (const one of shown) {
        const { width, height } = one;
        say(one, this.room);
        resized ||= one.width !== width || one.height !== height;
      }
    }
    if (resized) this.resized();
  };

  /** The picture is as wide as that now. */
  private foldAll(room: number): void {
    this.room = room;
    for (const shown of this.sets.values()) for (const one of shown) write(one, room);
  }
}

function say(shown: Shown, room: number): void {
  if (shown.said === shown.text) return;
  shown.said = shown.text;
  write(shown, room);
}

function write(shown: Shown, room: number): void {
  const lines = folded(shown.said, room - PADDING.width, widthOf), text = lines.join("\n");
  if (shown.element.textContent !== text) shown.element.textContent = text;
  shown.width = Math.max(...lines.map(widthOf)) + PADDING.width;
  shown.height = lines.length * LINE + PADDING.height;
}

/** Words in lines of at most that width, as far as single words are no wider. */
export function folded(text: string, room: number, widthOf: (text: string) => number): string[] {
  if (widthOf(text) <= room) return [text];
  const lines: string[] = [];
  let line = "";
  for (const word of text.split(" ")) {
    const longer = line ? `${line} ${word}` : word;
    if (line && widthOf(longer) > room) {
      lines.push(line);
      line = word;
    } else line = longer;
  }
  return [...lines, line];
}

/** taken: where no word may be, handles: nor should be; spots: that may be tried, those of `SPOTS` from the first. */
export interface Around { width: number; height: number; taken: readonly Box[]; handles: readonly Box[]; spots: number; }

/** Where a word covers no other one and no handle, else no other one: where it was, if that is still so. null: nowhere beside its place. */
export function roomFor(one: Size & { spot: number }, x: number, y: number, around: Around): Box | null {
  const { width, height, taken, handles, spots } = around;
  const before = Math.min(one.spot, spots - 1);
  for (const avoided of handles.length ? [[...taken, ...handles], taken] : [taken]) {
    for (let tried = 0; tried <= spots; tried += 1) {
      const spot = tried === 0 ? before : tried - 1, { right, above } = SPOTS[spot]!;
      const box = boxAt(one, x, y, width, height, right, above);
      if (avoided.some((other) => meet(box, other))) continue;
      one.spot = spot;
      return box;
    }
  }
  one.spot = 0;
  return null;
}

/** A place as the style has it, at whole pixels of a display with so many of them a pixel of the page: less than one is no move to see. */
export function placeOf(left: number, top: number, ratio: number): string {
  const [x, y] = [left, top].map((one) => Math.round(one * ratio) / ratio);
  return `translate(${x}px, ${y}px)`;
}

function boxAt(one: Size, x: number, y: number, width: number, height: number, right: boolean, above: boolean): Box {
  const after = x + BESIDE, before = x - BESIDE - one.width;
  const fitting = [after + one.width <= width ? after : null, before >= 0 ? before : null];
  // Words that are wider than both sides begin or end where the picture does.
  const squeezed = right ? Math.max(before, Math.min(0, after)) : Math.max(0, width - one.width);
  const left = (right ? fitting : fitting.reverse()).find((one) => one !== null) ?? squeezed;
  const top = Math.min(Math.max(above ? y - one.height - 4 : y + 4, 0), height - one.height);
  return [left, top, left + one.width, top + one.height];
}

let pen: CanvasRenderingContext2D | null = null;

/** Width of a word without having the browser lay the page out. */
function widthOf(text: string): number {
  if (!pen) {
    pen = document.createElement("canvas").getContext("2d");
    if (pen) pen.font = `12px ${getComputedStyle(document.body).fontFamily}`;
  }
  return pen?.measureText(text).width ?? 7 * text.length;
}

function meet(a: Box, b: Box): boolean {
  return a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
}
