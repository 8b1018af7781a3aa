// What the page and the server say to each other: docs/live-protocol.md has it in words.

/** An event of edit scripts; places in metres. */
export interface ScriptEvent { do: string; [key: string]: unknown; }

/** From the page. `id` counts its messages; answers and frames name it. `shown`: frames that were taken since its message before. */
export type FromPage = { shown?: number } & (
  | { type: "event"; id: number; event: ScriptEvent; latest?: boolean; gesture?: number } // latest: replaces one that waits; gesture: undone with those of the same number
  | { type: "show"; id: number; field?: string; predict?: "none" | "linear" | "gmls"; marks?: boolean }
  | { type: "rates"; id: number; of: string }                             // sensitivity before the press
  | { type: "strike"; id: number; at?: number[] }
  | { type: "play"; id: number; speed?: number }
  | { type: "pause"; id: number }
  | { type: "seek"; id: number; frame: number }
  | { type: "take"; id: number }                                          // the hand takes a played script over
  | { type: "run"; id: number; on: boolean }                              // what goes on in time does so by itself
  | { type: "record"; id: number; on: boolean }
  | { type: "save"; id: number }
  | { type: "cancel"; id: number }
  | { type: "restart"; id: number }
  | { type: "hand"; id: number }                                          // a looker asks for the hand; answered by "role", or "refused"
  | { type: "shown"; id: number });                                       // frames have been taken; says the connection itself

export interface FieldInfo { name: string; label: string; unit: string; signed: boolean; fromZero: boolean; }
export interface NumberInfo {                                              // a slider, or a number to type
  key: string; value: number; text: string; unit: string; low?: number; high?: number; parameter: boolean; whole?: boolean;
}
export interface QuantityInfo { name: string; unit: string; limitLow?: number; limitHigh?: number; }
export interface ThingInfo {                                               // what can be taken hold of
  name: string; role: "vertex" | "edge" | "control" | "hole" | "group" | "body" | "support" | "plank" | "region" | "panel" | "cloth";
  grabs: ("press" | "pull")[]; part: string;                               // part that draws it
  parameters?: string[];                                                   // of a plank: "move x", "turn y", ...
  lines?: string[];                                                        // names of the lines, or dots, that draw it; else its own
  triangles?: [number, number][];                                          // runs of the part's that draw it: the first, how many; else all
}

/** From the server as text. */
export type FromServer =
  | { type: "welcome"; scene: string; app: string; dim: 2 | 3; role: "hand" | "looker"; trueScale: boolean; goals: boolean;
      goesOn?: boolean;
      fields: FieldInfo[]; field: string; numbers: NumberInfo[]; quantities: QuantityInfo[]; things: ThingInfo[];
      events: Record<string, object>;                                      // by name the JSON schema of each event, or nothing: it comes after the first frame
      script: string; player: boolean; frames: number; predicts: string[]; predict: string; out: string; recordable: boolean }
  | { type: "known"; numbers?: NumberInfo[]; things?: ThingInfo[]; quantities?: QuantityInfo[]; events?: Record<string, object> } // what has changed, or comes later
  | { type: "done"; id: number }
  | { type: "refused"; id: number; message: string; place: string; todo: string }
  | { type: "rates"; id: number; of: string; rates: Record<string, number[]>; units: Record<string, string> }
  | { type: "busy"; seconds: number; what: string; shows?: boolean }     // shows: frames of it come meanwhile
  | { type: "player"; playing: boolean; frame: number; frames: number }
  | { type: "role"; role: "hand" | "looker" }
  | { type: "struck"; id: number; tone: MarkMessage }                     // a tone, which is heard
  | { type: "saved"; id: number; path: string; events: number; options?: string } // options: a replay needs them
  | { type: "written"; id: number; lines: string; count: number } // what the script has gained, its events now
  | { type: "lost"; message: string; restarting: boolean }
  | { type: "note"; message: string };

/** Where an array of a binary message begins, in bytes after the header; little-endian. Points of two numbers have z = 0. */
export interface ArrayPlace { at: number; type: "f4" | "u2" | "u4" | "u1"; shape: number[]; }

/**
 * A part of the picture. Arrays that have not changed since the last frame are left out, and stay as they were; one of no
 * elements is there no more.
 * "surface": `points` (n, d) f4, `displacement` (n, d) f4, `cells` (m, 3) u2 or u4, `value` (n) f4 or `valueInCells` (m, 3) f4,
 * `border` (k, 2) of indices: the edges that are drawn as the shape's. "lines": `points`, `starts` (l). "dots": `points`.
 */
export interface Part {
  name: string; kind: "surface" | "lines" | "dots"; role: "shape" | "outline" | "body" | "plank" | "support" | "load" | "goal";
  field?: string; range?: [number, number];                                // of the field in this frame
  element?: 2 | 4;                                                         // triangles of an element: all first ones, all second ones, ...
  shift?: [number, number, number];                                        // to be added to each displacement; without those, to each point
  mode?: number;                                                           // whose shape, of any size, is drawn as the displacement
  names?: string[];                                                        // of each line or dot
  arrays: Record<string, ArrayPlace>; gone?: boolean;
}

/** Where points of a mark are: places with their displacements, or (m, k) points of the shape, in whose middle each of them is in every frame. */
export interface PointPlaces { points?: ArrayPlace; moved?: ArrayPlace; nodes?: ArrayPlace; }

export type MarkMessage =
  | ({ kind: "lines"; name: string; meaning: string; starts: number[]; words: string[] } & PointPlaces)
  | ({ kind: "arrows"; name: string; meaning: string; unit: string; words: string[]; vectors: ArrayPlace;
      tips: boolean[] } & PointPlaces)                                     // tips: of each arrow, whether it ends at its point; empty: none
  | { kind: "words"; text: string; at: number[] | null; meaning: string; moved?: number[] }
  | { kind: "value"; name: string; unit: string; node: number }            // of a quantity in each frame, beside a point of the shape
  | { kind: "offer"; name: string; text: string; events: ScriptEvent[]; slide: ScriptEvent | null; slid: string; lines: MarkMessage[] }
  | { kind: "chart"; name: string; xLabel: string; yLabel: string; curves: { name: string; x: number[]; y: number[] }[];
      at: Record<string, number>; logarithmic: boolean }
  | { kind: "tone"; name: string; frequencies: number[]; decays: number[]; amplitudes: number[];
      at?: number[] | null; moved?: number[] | null };                     // the place that is struck, and its displacement

/** The header of a binary message: u4 its length in bytes, the JSON (padded so that arrays begin at a multiple of 8), arrays. */
export interface FrameMessage {
  type: "frame"; number: number; id: number;                               // id: of the last message that it answers
  columns: Record<string, number | string>;                                // level, ms, iterations, estimate, refused, note, predicted, q_...
  errors: Record<string, number | null>;                                   // of quantities, where they are estimated; null: infinite
  limits: Record<string, "holds" | "uncertain" | "fails">;
  runs?: boolean;                                                          // time goes on by itself
  records?: boolean;                                                       // frames are recorded
  missed?: string;                                                         // why the press was refused that this frame lets go of
  held: { on: string; at: number[] } | null;
  parts: Part[];
  marks?: (MarkMessage | null)[];                                          // null: as the one in this place before; left out: all as before
}
