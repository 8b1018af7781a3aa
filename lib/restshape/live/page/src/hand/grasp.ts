// Something in the hand: from the press to the release, as events of edit scripts.

import type { App } from "../app";
import type { ScriptEvent, ThingInfo } from "../protocol";
import type { Grip } from "./targets";
import { Turns } from "./turns";

const IN_SPACE = ["body", "support", "plank", "cloth"];

/** Whether a thing of a scene in space goes where the hand is, and not in the plane of the shape alone. */
export function goesInSpace(role: string | undefined): boolean { return role !== undefined && IN_SPACE.includes(role); }

/** Places of events: entities of the shape lie in their plane. */
export function coordinates(app: App, thing: ThingInfo | null, at: readonly number[]): number[] {
  const three = app.welcome?.dim === 3 && (!thing || goesInSpace(thing.role));
  return at.slice(0, three ? 3 : 2).map((value) => Number(value.toPrecision(9)));
}

export class Grasp {
  private pressed = 0;                               // number of the message that took hold
  private at: readonly number[];                     // where
  private ended = false;
  private last: string | null = null;
  private readonly turns = new Turns();
  readonly thing: ThingInfo;

  /** parameter: of a plank, which the hand changes in place of its place. */
  constructor(private readonly app: App, readonly grip: Grip, private readonly pull: boolean, readonly parameter: string | null) {
    this.thing = grip.target.thing;
    this.at = grip.at;
    app.tell("held", this.thing);
  }

  /** Moves it to a place [m], or changes its parameter by an amount. The first time is the press. */
  move(to: readonly number[] | number): void { this.turns.take(() => this.send(to)); }

  private send(to: readonly number[] | number): void {
    const drag: ScriptEvent = typeof to === "number"
      ? { do: "drag", by: Number(to.toPrecision(6)) } : { do: "drag", to: coordinates(this.app, this.thing, to) };
    const text = JSON.stringify(drag);
    if (text === this.last || this.ended || !this.press()) return;
    this.last = text;
    if (this.app.act(drag, true) && typeof to !== "number") this.at = to;
  }

  release(): void {
    if (this.ended) return;
    this.turns.flush();
    this.ended = true;
    if (this.pressed) letGo(this.app);
    this.app.tell("held", null);
  }

  private press(): boolean {
    if (this.pressed && !this.lost()) return true;
    const { thing, pull, parameter } = this;
    if (leftHeld(this.app)) letGo(this.app);
    const event: ScriptEvent = { do: pull ? "pull" : "press", on: thing.name };
    if (parameter) event["parameter"] = parameter;
    else event["at"] = this.grip.material ?? coordinates(this.app, thing, this.at);
    this.pressed = this.app.act(event);
    return this.pressed > 0;
  }

  /** Whether the simulation no longer holds it, as after it was started again. */
  private lost(): boolean {
    const header = this.app.frame?.header;
    return header !== undefined && header.held === null && header.id > this.pressed;
  }
}

/** Whether a pull takes hold of a thing: asked for, or all that it allows. */
export function pulls(thing: ThingInfo, asked: boolean): boolean {
  return thing.grabs.includes("pull") && (asked || !thing.grabs.includes("press"));
}

/** Whether a thing is an edge without anything between its ends that a pull could bend. */
export function unbending({ role, grabs }: ThingInfo): boolean { return role === "edge" && !grabs.includes("pull"); }

const releases = new WeakMap<App, number>();         // number of the last message that lets go

function letGo(app: App): void { releases.set(app, app.act({ do: "release" })); }

/** Whether the simulation still holds what a page held that was closed or loaded again in a drag. */
function leftHeld(app: App): boolean {
  const header = app.frame?.header;
  return Boolean(header?.held) && header!.id >= (releases.get(app) ?? 0);
}
