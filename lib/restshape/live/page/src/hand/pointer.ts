// Mouse, pen and touch on the canvas: to the hand where there is something to hold, to the camera elsewhere.

import { Vector3 } from "three";

import type { App } from "../app";
import type { Scene } from "../draw/scene";
import { Beside } from "./beside";
import { goesInSpace, Grasp, pulls, unbending } from "./grasp";
import { Highlight } from "./highlight";
import { placeOnWay, type Way } from "./ways";
import { Targets, titleOf, type Grip } from "./targets";
import { pixelsOf } from "./pixels";
import type { Tools } from "./tools";

const REACH = { mouse: 10, pen: 14, touch: 24 };
const STILL = 3; // pixels within which a press is a click
const TURN = 0.008; // radians of a turn a pixel

export class Pointer {
  readonly targets: Targets;
  readonly selected: Highlight;
  readonly hover: Highlight;
  way: Way = "screen";
  parameter: string | null = null;                   // of a plank, which is held in place of the plank
  private grasp: Grasp | null = null;
  private finger: PointerEvent | null = null;        // that holds
  private handed = false;                            // events that are passed on to the camera
  private start = { x: 0, y: 0 };
  private offset: [number, number, number] = [0, 0, 0];
  private moved = false;

  constructor(
    private readonly app: App, private readonly scene: Scene, private readonly tools: Tools, readonly beside: Beside,
  ) {
    this.targets = new Targets(scene);
    this.selected = new Highlight(scene, "accent", 3, 0.18);
    this.hover = new Highlight(scene, "lit", 3.5, 0.3);
    const { canvas } = scene;
    canvas.addEventListener("pointerdown", (event) => this.down(event), { capture: true });
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"] as const) canvas.addEventListener(end, (event) => this.up(event));
    canvas.addEventListener("pointerleave", () => { if (!this.grasp) this.hover.show(null, null); });
    canvas.addEventListener("dblclick", (event) => this.twice(event));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    app.on("frame", () => this.refresh());
    app.on("selected", () => this.refresh());
  }

  /** What is under the pointer and may be held. */
  under(event: MouseEvent): Grip | null {
    const { x, y } = pixelsOf(this.scene, event);
    const type = event instanceof PointerEvent ? event.pointerType : "mouse";
    const reach = REACH[type as keyof typeof REACH] ?? REACH.mouse;
    return this.targets.at(this.app.things, x, y, reach, () => true);
  }

  private down(event: PointerEvent): void {
    if (this.handed) return;
    this.scene.canvas.focus({ preventScroll: true, focusVisible: false } as FocusOptions);
    const { controls } = this.scene.view;
    if (this.finger) return this.second(event);
    controls.enabled = true;
    if (event.pointerType === "touch" && !event.isPrimary) return; // the first finger moves the picture already
    if (event.button !== 0 || this.app.tool === "look" || event.ctrlKey || event.metaKey) return;
    this.start = pixelsOf(this.scene, event);
    this.moved = false;
    const taken = this.tools.down(event) || this.hold(event);
    if (!taken) return;
    controls.enabled = false;
    this.finger = event;
    this.scene.canvas.setPointerCapture(event.pointerId);
    event.preventDefault();
  }

  private hold(event: PointerEvent): boolean {
    const grip = this.under(event);
    if (!grip) {
      this.app.tell("selected", null);
      return false;
    }
    const { thing } = grip.target;
    this.app.tell("selected", thing);
    if (this.app.role !== "hand") {
      this.beside.moveTo(this.start.x, this.start.y);
      this.beside.show("another page has the hand");
      return false;
    }
    const pull = this.app.tool === "pull" || event.altKey;
    if (pull && unbending(thing)) {
      this.beside.moveTo(this.start.x, this.start.y);
      this.beside.refuse(0, `${thing.name} is straight and cannot be pulled`, "make it an arc with Arc, or insert a vertex (double click)");
      return true;
    }
    const parameter = this.parameter && thing.parameters?.includes(this.parameter) ? this.parameter : null;
    this.grasp = new Grasp(this.app, grip, pulls(thing, pull), parameter);
    this.hover.show(grip.target, grip.dot);
    const at = this.place(this.start.x, this.start.y, grip.at);
    this.offset = at ? [grip.at[0] - at[0], grip.at[1] - at[1], grip.at[2] - at[2]] : [0, 0, 0];
    return true;
  }

  private move(event: PointerEvent): void {
    if (this.handed && !this.finger) return;
    if (this.finger && event.pointerId !== this.finger.pointerId) return;
    const { x, y } = pixelsOf(this.scene, event);
    this.beside.moveTo(x, y);
    if (!this.finger) {
      if (event.buttons === 0 && event.pointerType !== "touch") this.look(event);
      return;
    }
    const far = Math.hypot(x - this.start.x, y - this.start.y);
    if (!this.moved && far < STILL) return;
    this.moved = true;
    if (this.tools.move(event) || !this.grasp) return;
    const { grip, parameter } = this.grasp;
    if (parameter) {
      this.grasp.move(this.amount(parameter, x, y, grip));
      return;
    }
    const at = this.place(x, y, grip.at);
    if (at) this.grasp.move([at[0] + this.offset[0], at[1] + this.offset[1], at[2] + this.offset[2]]);
  }

  private up(event: PointerEvent): void {
    if (this.finger?.pointerId !== event.pointerId) return;
    this.finger = null;
    this.tools.up(event);
    this.release();
    this.scene.view.controls.enabled = true;
  }

  release(): void {
    this.grasp?.release();
    this.grasp = null;
    this.tools.cancel();
    if (this.finger) this.scene.canvas.releasePointerCapture(this.finger.pointerId);
    this.finger = null;
  }

  /** A second finger while one holds: both move the picture. */
  private second(event: PointerEvent): void {
    const first = this.finger;
    if (!first || event.pointerType !== "touch") return;
    this.release();
    this.scene.view.controls.enabled = true;
    this.handed = true;
    const { canvas } = this.scene;
    const { pointerId, clientX, clientY } = first;
    canvas.dispatchEvent(new PointerEvent("pointerdown", { pointerId, clientX, clientY, pointerType: "touch", bubbles: true }));
    this.handed = false;
  }

  private twice(event: MouseEvent): void {
    const grip = this.under(event);
    if (grip) this.tools.insert(grip);
    else this.scene.fit();
  }

  private look(event: PointerEvent): void {
    const grip = this.app.tool === "look" ? null : this.under(event);
    this.hover.show(grip?.target ?? null, grip?.dot ?? null);
    const { canvas } = this.scene;
    const cursor = this.tools.cursor ?? (grip ? "grab" : "default");
    const title = grip ? titleOf(grip.target.thing) : "";
    if (canvas.style.cursor !== cursor) canvas.style.cursor = cursor;
    if (canvas.title !== title) canvas.title = title;
  }

  /** The place that a pixel means for a hand that holds something at `from`. */
  private place(x: number, y: number, from: readonly [number, number, number]): [number, number, number] | null {
    const { view } = this.scene;
    const { origin, direction } = view.ray(x, y);
    const seen = view.camera.getWorldDirection(new Vector3());
    const flat = view.dim === 2 || !goesInSpace(this.grasp?.thing.role);
    return placeOnWay(
      flat ? "xy" : this.way, from, [origin.x, origin.y, origin.z], [direction.x, direction.y, direction.z], [seen.x, seen.y, seen.z],
    );
  }

  /** By how much a parameter of a plank goes: to the right is more, up too. */
  private amount(parameter: string, x: number, y: number, grip: Grip): number {
    const pixels = x - this.start.x - (y - this.start.y);
    return parameter.startsWith("turn") ? pixels * TURN : pixels * this.scene.view.pixel(new Vector3(...grip.at));
  }

  private refresh(): void {
    const { selected, things } = this.app;
    this.targets.chosen = selected;
    this.selected.show(selected && this.targets.find(things, selected.name), null);
    const { lit } = this.hover;
    if (lit) this.hover.show(this.targets.find(things, lit.name), this.hover.dot);
  }
}
