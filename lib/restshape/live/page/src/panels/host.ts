// What the panels need of the page: the one way between them and the drawing, the hand and the socket.

import type { FrameMessage, FromPage, FromServer, MarkMessage } from "../protocol";

/** What the page sends, but for its number. */
export type Outgoing = FromPage extends infer One ? (One extends FromPage ? Omit<One, "id"> : never) : never;

type OfServer<Type extends FromServer["type"]> = Extract<FromServer, { type: Type }>;
export type Welcome = OfServer<"welcome">;

/** What is said to the panels, by name. */
export interface Happenings {
  welcome: Welcome;
  known: OfServer<"known">;
  frame: FrameMessage;
  done: OfServer<"done">;
  refused: OfServer<"refused">;
  rates: OfServer<"rates">;
  busy: OfServer<"busy">;
  player: OfServer<"player">;
  role: OfServer<"role">;
  saved: OfServer<"saved">;
  lost: OfServer<"lost">;
  note: OfServer<"note">;
  /** A name is selected, by a press without a drag, by keys, or in a panel; null: nothing is. */
  selected: string | null;
  /** A message went out under this number. */
  sent: { id: number; message: Outgoing };
  /** The socket is there, or gone. */
  connected: boolean;
  /** What is drawn has been changed, by a panel or by keys. */
  view: View;
}

/** How the picture is drawn. */
export interface View {
  colours: string;                 // name of a colour map
  deformation: number;             // factor of displacements as they are drawn; 1 is true to scale
  wireframe: boolean;
  marks: boolean;
}

/** Lines, arrows and words as they are drawn: `MarkMessage` with its arrays. Points and vectors have three numbers each. */
export type DrawnMark =
  | { kind: "lines"; name: string; meaning: string; starts: number[]; words: string[]; points: Float32Array; moved: Float32Array | null }
  | { kind: "arrows"; name: string; meaning: string; unit: string; words: string[]; points: Float32Array; vectors: Float32Array }
  | { kind: "words"; text: string; at: number[] | null; meaning: string };

export interface Host {
  /** Sends a message and gives its number; 0 where there is no socket. */
  send(message: Outgoing): number;
  hear<Name extends keyof Happenings>(name: Name, then: (what: Happenings[Name]) => void): void;
  /** Names of the colour maps. */
  readonly colourMaps: readonly string[];
  view: View;
  setView(change: Partial<View>): void;
  /** Selects a name, as a press on it does; null: nothing. */
  select(name: string | null): void;
  /** The place [m] at which the canvas is pressed next; null: given up by Escape. */
  pick(what: string): Promise<number[] | null>;
  /** Draws marks besides those of the frame, in place of those drawn under the same name before; empty: none. */
  draw(name: string, marks: DrawnMark[]): void;
  /** The marks of a message with their arrays; what has no lines, arrows or words is left out. */
  drawn(marks: MarkMessage[]): DrawnMark[];
  /** The picture as PNG, as a download. */
  picture(): void;
}
