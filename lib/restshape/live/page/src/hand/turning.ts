// Two handles beside what is selected: one turns it, one scales it; by pointer, or by arrow keys where they have the focus.

import { Vector3 } from "three";

import type { App } from "../app";
import type { Box } from "../draw/labels";
import type { Scene } from "../draw/scene";
import { Steps } from "./steps";
import { drawnAt, middle, numbersOf, type Target } from "./targets";
import type { Tools } from "./tools";

const ROLES = ["edge", "hole", "group", "region", "panel", "body"];
const BY_KEY = { rotate: Math.PI / 36, scale: 1.05 };

type Kind = "rotate" | "scale";

export class Turning {
  private readonly buttons: Record<Kind, HTMLButtonElement>;
  private target: Target | null = null;
  private steps: Steps | null = null;
  private readonly work = new Vector3();
  private middle = { x: 0, y: 0 };
  private start = { x: 0, y: 0 };

  constructor(private readonly app: App, private readonly scene: Scene, private readonly tools: Tools, private readonly find: (name: string) => Target | null) {
    this.buttons = { rotate: this.make("rotate", "⟳"), scale: this.make("scale", "⤡") };
    app.on("selected", () => this.choose());
    app.on("frame", () => this.choose());
    scene.onDraw.push(() => this.place());
  }

  /** Gives the focus to the first of the handles that are there. */
  focus(): boolean {
    const button = Object.values(this.buttons).find(({ hidden }) => !hidden);
    button?.focus();
    return Boolean(button);
  }

  private make(kind: Kind, text: string): HTMLButtonElement {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "grip";
    button.textContent = text;
    button.hidden = true;
    button.addEventListener("pointerdown", (event) => this.down(kind, event));
    button.addEventListener("pointermove", (event) => this.move(kind, event));
    for (const end of ["pointerup", "pointercancel"] as const) button.addEventListener(end, () => this.up());
    button.addEventListener("keydown", (event) => this.key(kind, event));
    document.getElementById("grips")!.append(button);
    return button;
  }

  private choose(): void {
    const { selected, held } = this.app;
    this.target = selected && !held && ROLES.includes(selected.role) ? this.find(selected.name) : null;
    for (const kind of ["rotate", "scale"] as const) {
      const button = this.buttons[kind];
      const hidden = !this.target || !this.tools.may(kind), title = `${kind} ${selected?.name ?? ""}`;
      if (button.hidden !== hidden) button.hidden = hidden;
      if (button.title === title) continue;
      button.title = title;
      button.setAttribute("aria-label", `${title}: drag, or arrow keys`);
    }
    if (!this.target) this.scene.labels.covered = [];
    this.scene.request();
  }

  private place(): void {
    if (!this.target || this.steps) return;
    const covered: Box[] = [];
    const box = this.box(this.target);
    const { clientWidth, clientHeight } = this.scene.canvas;
    const spots = { rotate: [(box.left + box.right) / 2, box.top - 30], scale: [box.right + 22, box.bottom + 22] };
    for (const kind of ["rotate", "scale"] as const) {
      const [x, y] = spots[kind] as [number, number];
      const left = Math.min(Math.max(x - 15, 2), clientWidth - 34);
      const top = Math.min(Math.max(y - 15, 2), clientHeight - 34);
      this.buttons[kind].style.transform = `translate(${left}px, ${top}px)`;
      if (!this.buttons[kind].hidden) covered.push([left, top, left + 30, top + 30]);
    }
    this.scene.labels.covered = covered;
  }

  private box(target: Target): { left: number; right: number; top: number; bottom: number } {
    const box = { left: Infinity, right: -Infinity, top: Infinity, bottom: -Infinity };
    for (const i of numbersOf(target)) {
      const { x, y } = this.scene.view.toScreen(...drawnAt(target.shown, i, this.scene.shared.scale.value), this.work);
      box.left = Math.min(box.left, x);
      box.right = Math.max(box.right, x);
      box.top = Math.min(box.top, y);
      box.bottom = Math.max(box.bottom, y);
    }
    return box;
  }

  private down(kind: Kind, event: PointerEvent): void {
    if (!this.target) return;
    this.buttons[kind].setPointerCapture(event.pointerId);
    const { x, y } = this.scene.view.toScreen(...middle(this.target), this.work);
    const { left, top } = this.scene.canvas.getBoundingClientRect();
    this.middle = { x: x + left, y: y + top };
    this.start = { x: event.clientX - this.middle.x, y: event.clientY - this.middle.y };
    this.steps = this.begin(kind, this.target.thing.name);
  }

  private begin(kind: Kind, on: string): Steps {
    const short = (value: number): number => Number(value.toPrecision(6));
    return kind === "rotate"
      ? new Steps(this.app, 0, (from, to) => ({ do: "rotate", on, by: short(to - from) }))
      : new Steps(this.app, 1, (from, to) => ({ do: "scale", on, factor: short(to / from) }));
  }

  private move(kind: Kind, event: PointerEvent): void {
    if (!this.steps || !event.buttons) return;
    const x = event.clientX - this.middle.x;
    const y = event.clientY - this.middle.y;
    if (kind === "scale") this.steps.to(Math.max(Math.hypot(x, y) / Math.max(Math.hypot(this.start.x, this.start.y), 1), 0.05));
    else this.steps.to(turn(this.start, { x, y }));
    this.buttons[kind].style.transform = `translate(${x + this.middle.x - this.left() - 15}px, ${y + this.middle.y - this.top() - 15}px)`;
  }

  private up(): void {
    this.steps?.end();
    this.steps = null;
    this.scene.request();
  }

  private key(kind: Kind, event: KeyboardEvent): void {
    if (event.key === "Escape") this.scene.canvas.focus();
    const sign = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
    if (!sign || !this.target) return;
    event.preventDefault();
    const on = this.target.thing.name;
    if (kind === "rotate") this.app.act({ do: "rotate", on, by: -sign * BY_KEY.rotate });
    else this.app.act({ do: "scale", on, factor: BY_KEY.scale ** sign });
  }

  private left(): number { return this.scene.canvas.getBoundingClientRect().left; }
  private top(): number { return this.scene.canvas.getBoundingClientRect().top; }
}

/** The angle from one arm to another [rad], counterclockwise on a screen whose y goes down; within half a turn. */
export function turn(from: { x: number; y: number }, to: { x: number; y: number }): number {
  return -Math.atan2(from.x * to.y - from.y * to.x, from.x * to.x + from.y * to.y);
}
