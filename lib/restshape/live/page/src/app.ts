// The state of the session, and what has happened in it: the page's parts know this, and not each other.

import type { Asked } from "./connection";
import type { ArrayPlace, FrameMessage, FromServer, ScriptEvent, ThingInfo } from "./protocol";

export type Welcome = Extract<FromServer, { type: "welcome" }>;
export type Refusal = Extract<FromServer, { type: "refused" }>;
export type Rates = Extract<FromServer, { type: "rates" }>;
export type Player = Extract<FromServer, { type: "player" }>;
export type Known = Extract<FromServer, { type: "known" }>;
export type Busy = Extract<FromServer, { type: "busy" }>;
export type Written = Extract<FromServer, { type: "written" }>;
export type Struck = Extract<FromServer, { type: "struck" }>;
export type Saved = Extract<FromServer, { type: "saved" }>;
export type Lost = Extract<FromServer, { type: "lost" }>;

/** Arrays of a message, as views into it. */
export type Numbers = Float32Array | Uint32Array | Uint8Array;
export interface Frame { header: FrameMessage; read(place: ArrayPlace): Numbers; }

export type Tool = "hold" | "pull" | "hole" | "arc" | "look";
export type Link = "connecting" | "open" | "lost" | "elsewhere" | "ended";

/** What happens, and what is told of it. */
export interface Happenings {
  welcome: Welcome;
  known: Known;
  frame: Frame;
  done: { id: number };
  refused: Refusal;
  declined: Refusal;               // of what was asked by the way: nobody needs to read it
  rates: Rates;
  busy: Busy;
  player: Player;
  role: "hand" | "looker";
  saved: Saved;
  struck: Struck;
  written: Written;
  lost: Lost;
  note: string;
  link: Link;
  selected: ThingInfo | null;      // what was held last, or chosen by keyboard or list
  held: ThingInfo | null;          // what is in the hand
  tool: Tool;
  look: Look;
  scaled: number;                  // displacements are drawn so many times as large from now on
  drawn: number;                   // id of the last message that the picture answers
  latency: number;                 // ms from the message to the drawn frame that answers it
}

/** How frames are drawn. */
export interface Look {
  colours: string;                 // a colour map's name; "auto": the field's own; "none"
  scale: number;                   // of displacements; the page chooses it where autoScale is set
  autoScale: boolean;
  wireframe: boolean;
  rest: boolean;                   // the outline before deformation
  handles: boolean;                // what can be held
  range: [number, number] | null;  // of colours; null: of the frame
}

type Listener<K extends keyof Happenings> = (what: Happenings[K]) => void;

export class App {
  welcome: Welcome | null = null;
  things: ThingInfo[] = [];
  frame: Frame | null = null;
  role: "hand" | "looker" = "looker";
  link: Link = "connecting";
  player: Player | null = null;
  selected: ThingInfo | null = null;
  held: ThingInfo | null = null;
  tool: Tool = "hold";
  look: Look = { colours: "auto", scale: 1, autoScale: true, wireframe: true, rest: true, handles: true, range: null };

  private gestures = 1_000 * Date.now();               // so that numbers grow from page to page
  private readonly byTheWay = new Set<number>();
  private readonly listeners = new Map<keyof Happenings, Set<(what: never) => void>>();

  /** Sends a message; gives its id, or 0 where there is no connection. */
  readonly send: (asked: Asked) => number;

  constructor(send: (asked: Asked) => number) { this.send = send; }

  /** Calls `heard` at each; gives what ends that. */
  on<K extends keyof Happenings>(what: K, heard: Listener<K>): () => void {
    const all = this.listeners.get(what) ?? new Set();
    this.listeners.set(what, all.add(heard as (what: never) => void));
    return () => { all.delete(heard as (what: never) => void); };
  }

  /** Notes what has happened in the state, then tells who listens. */
  tell<K extends keyof Happenings>(what: K, how: Happenings[K]): void {
    this.note(what, how);
    for (const heard of this.listeners.get(what) ?? []) (heard as Listener<K>)(how);
  }

  /** Sends an event of edit scripts. latest: it replaces an earlier one of its kind that waits. gesture: of which it is a part. */
  act(event: ScriptEvent, latest = false, gesture = 0): number {
    return this.send({ type: "event", event, latest, gesture });
  }

  /** The number of a new gesture: what `act` sends with it is undone at once. */
  gesture(): number { return (this.gestures += 1); }

  /** What the server says as text. */
  hear(message: FromServer): void {
    switch (message.type) {
      case "role": this.tell("role", message.role); break;
      case "note": this.tell("note", message.message); break;
      case "welcome": this.tell("welcome", message); break;
      case "known": this.tell("known", message); break;
      case "done": this.tell("done", message); break;
      case "refused": this.tell(this.byTheWay.delete(message.id) ? "declined" : "refused", message); break;
      case "rates": this.tell("rates", message); break;
      case "busy": this.tell("busy", message); break;
      case "player": this.tell("player", message); break;
      case "struck": this.tell("struck", message); break;
      case "saved": this.tell("saved", message); break;
      case "written": this.tell("written", message); break;
      case "lost": this.tell("lost", message); break;
      default:
    }
  }

  /** Asks for something that may be refused without a word to the user. */
  wonder(asked: Asked): number {
    const id = this.send(asked);
    this.byTheWay.add(id);
    return id;
  }

  changeLook(change: Partial<Look>): void { this.tell("look", { ...this.look, ...change }); }

  private note<K extends keyof Happenings>(what: K, how: Happenings[K]): void {
    switch (what) {
      case "welcome": this.begin(how as Welcome); break;
      case "known": this.learn(how as Known); break;
      case "frame": this.frame = how as Frame; break;
      case "role": this.role = how as "hand" | "looker"; break;
      case "link": this.link = how as Link; break;
      case "player": this.player = how as Player; break;
      case "selected": this.selected = how as ThingInfo | null; break;
      case "held": this.held = how as ThingInfo | null; break;
      case "tool": this.tool = how as Tool; break;
      case "look": this.look = how as Look; break;
      default:
    }
  }

  private begin(welcome: Welcome): void {
    this.welcome = welcome;
    this.things = welcome.things;
    this.role = welcome.role;
    this.frame = null;
  }

  private learn(known: Known): void {
    if (this.welcome) {
      if (known.numbers) this.welcome.numbers = known.numbers;
      if (known.quantities) this.welcome.quantities = known.quantities;
      if (known.things) this.welcome.things = known.things;
      if (known.events) this.welcome.events = known.events;
    }
    if (known.things) this.things = known.things;
  }
}

/** Why a frame shows the answer of before; empty: it does not. */
export function refusedWords({ columns, missed }: FrameMessage): string {
  const why = missed ?? columns["refused"];
  return typeof why === "string" ? why : "";
}
