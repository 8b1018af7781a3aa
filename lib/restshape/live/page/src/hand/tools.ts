// What the hand does besides holding: it cuts holes, makes edges arcs, inserts, deletes and smooths.

import type { App } from "../app";
import type { Scene } from "../draw/scene";
import { siText } from "../panels/si_text";
import { coordinates } from "./grasp";
import type { Beside } from "./beside";
import { newName } from "./names";
import { pixelsOf } from "./pixels";
import type { Grip, Targets } from "./targets";

const PIECES = 48; // of the circle that shows a hole

export class Tools {
  cursor: string | null = null;
  targets: Targets | null = null;
  private center: [number, number, number] | null = null;
  private radius = 0;
  private arc: Grip | null = null;
  private gesture = 0;
  private asked: { then: (at: number[] | null) => void } | null = null;

  constructor(private readonly app: App, private readonly scene: Scene, private readonly beside: Beside) {
    app.on("tool", (tool) => { this.cursor = tool === "hole" ? "crosshair" : tool === "look" ? "move" : null; });
  }

  /** The place that is pressed next; null where that is given up. */
  pick(): Promise<number[] | null> {
    this.asked?.then(null);
    this.cursor = "crosshair";
    return new Promise((then) => { this.asked = { then }; });
  }

  /** Whether a press is taken by a tool. */
  down(event: PointerEvent): boolean {
    if (this.asked) {
      const { x, y } = pixelsOf(this.scene, event);
      const { targets, app, scene: { view } } = this;
      const vertex = targets?.at(app.things, x, y, 8, ({ role }) => role === "vertex");
      const at = vertex?.at ?? targets?.onSurface(x, y) ?? (view.dim === 3 ? targets?.at(app.things, x, y, 8, () => true)?.at : null);
      this.answer([...(at ?? this.ground(event))].slice(0, view.dim));
      return true;
    }
    if (this.app.role !== "hand") return false;
    if (this.app.tool === "hole") {
      this.center = this.ground(event);
      this.radius = 0;
      return true;
    }
    if (this.app.tool !== "arc") return false;
    const { x, y } = pixelsOf(this.scene, event);
    this.arc = this.targets?.at(this.app.things, x, y, 24, ({ role }) => role === "edge") ?? null;
    this.gesture = this.app.gesture();
    if (this.arc) this.app.tell("selected", this.arc.target.thing);
    return this.arc !== null;
  }

  move(event: PointerEvent): boolean {
    if (this.center) {
      const at = this.ground(event);
      this.radius = Math.hypot(at[0] - this.center[0], at[1] - this.center[1]);
      this.preview();
      this.say(`radius ${siText(this.radius, "m")}`, event);
      return true;
    }
    if (!this.arc) return false;
    const { thing } = this.arc.target;
    this.app.act({ do: "arc", on: thing.name, through: coordinates(this.app, thing, this.ground(event)) }, true, this.gesture);
    return true;
  }

  up(_event: PointerEvent): void {
    if (this.center && this.radius > 0.002 * this.scene.size) {
      const [x, y] = this.center;
      const round = (value: number): number => Number(value.toPrecision(6));
      const name = newName("hole_", this.taken());
      this.app.act({ do: "hole", name, center: [round(x), round(y)], radius: round(this.radius) });
    }
    this.end();
  }

  cancel(): void {
    this.answer(null);
    this.end();
  }

  /** A new vertex where an edge is held. */
  insert({ target, at }: Grip): boolean {
    if (target.thing.role !== "edge" || !this.may("insert")) return false;
    this.app.act({ do: "insert", on: target.thing.name, name: newName("vertex_", this.taken()), at: coordinates(this.app, target.thing, at) });
    return true;
  }

  /** Deletes what is selected. */
  remove(): boolean {
    const { selected } = this.app;
    if (!selected || !this.may("delete")) return false;
    this.app.act({ do: "delete", on: selected.name });
    return true;
  }

  smooth(): void {
    const { selected } = this.app;
    if (selected && this.may("smooth")) this.app.act({ do: "smooth", on: selected.name, strength: 0.5 });
  }

  /** Whether the session has an event, and the hand. */
  may(event: string): boolean { return this.app.role === "hand" && event in (this.app.welcome?.events ?? {}); }

  private answer(at: number[] | null): void {
    this.asked?.then(at);
    this.asked = null;
    this.cursor = null;
  }

  private end(): void {
    if (this.center) this.scene.setLines("tool", null);
    this.center = null;
    this.arc = null;
  }

  private say(text: string, event: PointerEvent): void {
    const { x, y } = pixelsOf(this.scene, event);
    this.beside.moveTo(x, y);
    this.beside.show(text);
  }

  private ground(event: PointerEvent): [number, number, number] {
    const { x, y } = pixelsOf(this.scene, event);
    return this.targets?.inPlane(x, y, 0) ?? [0, 0, 0];
  }

  private taken(): Set<string> { return new Set(this.app.things.map(({ name }) => name)); }

  private preview(): void {
    const points = new Float32Array(3 * (PIECES + 1));
    for (let i = 0; i <= PIECES; i += 1) {
      const angle = (2 * Math.PI * i) / PIECES;
      points.set([this.center![0] + this.radius * Math.cos(angle), this.center![1] + this.radius * Math.sin(angle), 0], 3 * i);
    }
    this.scene.setLines("tool", { points, starts: [0], meaning: "lit" });
  }
}
