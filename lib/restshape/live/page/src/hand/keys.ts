// The hand by keys: Tab goes through what can be held, Enter takes hold, arrows move, Escape lets go.

import { Vector3 } from "three";

import type { App } from "../app";
import type { Scene } from "../draw/scene";
import { goesInSpace, Grasp, pulls, unbending } from "./grasp";
import type { Pointer } from "./pointer";
import { titleOf, type Target } from "./targets";
import type { Tools } from "./tools";
import type { Turning } from "./turning";

const STEP = 0.005; // of the scene's size
const ARROWS: Record<string, [number, number, number]> = {
  ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowDown: [0, -1, 0], ArrowUp: [0, 1, 0], PageUp: [0, 0, 1], PageDown: [0, 0, -1],
};

export class Keys {
  private at: [number, number, number] = [0, 0, 0];
  private by = 0;
  private fresh = true;                              // focus has just come: Tab begins with the first thing
  private grasp: Grasp | null = null;

  constructor(
    private readonly app: App, private readonly scene: Scene, private readonly pointer: Pointer, private readonly tools: Tools,
    private readonly turning: Turning,
  ) {
    scene.canvas.addEventListener("keydown", (event) => { if (this.key(event)) event.preventDefault(); });
    scene.canvas.addEventListener("blur", () => this.leave());
    addEventListener("keydown", (event) => { if (event.key === "Escape") this.escape(); });
  }

  private key(event: KeyboardEvent): boolean {
    if (event.ctrlKey || event.metaKey) return false;
    const arrow = ARROWS[event.key];
    if (arrow) return this.arrow(arrow, event);
    switch (event.key) {
      case "Tab": return this.next(event.shiftKey ? -1 : 1);
      case "Enter": case " ": return this.take(event.altKey);
      case "Delete": case "Backspace": return this.tools.remove();
      case "+": case "=": this.scene.view.zoom(1.2); return true;
      case "-": this.scene.view.zoom(1 / 1.2); return true;
      case "f": case "Home": this.scene.fit(); return true;
      case "i": return this.insert();
      case "h": return this.turning.focus();
      default: return false;
    }
  }

  /** The next thing that can be held; beyond the last one focus leaves the picture. */
  private next(step: number): boolean {
    this.release();
    const all = this.pointer.targets.list(this.app.things);
    const { selected } = this.app;
    const now = this.fresh ? -1 : all.findIndex(({ thing }) => thing.name === selected?.name && thing.role === selected.role);
    const then = now < 0 ? (step > 0 ? 0 : all.length - 1) : now + step;
    const target = all[then];
    if (!target) return false;
    this.fresh = false;
    this.app.tell("selected", target.thing);
    this.pointer.beside.say(`${titleOf(target.thing)}, ${then + 1} of ${all.length}: Enter takes hold`);
    return true;
  }

  private take(pull: boolean): boolean {
    if (this.grasp) {
      this.release();
      return true;
    }
    const target = this.chosen();
    if (!target || this.app.role !== "hand") return false;
    const asked = pull || this.app.tool === "pull";
    if (asked && unbending(target.thing)) {
      this.pointer.beside.refuse(0, `${target.thing.name} is straight and cannot be pulled`, "insert a vertex (I), or make it an arc in the panel Events");
      return true;
    }
    const grip = this.pointer.targets.grip(target);
    this.at = [...grip.at];
    this.by = 0;
    const { parameter } = this.pointer;
    const held = parameter && target.thing.parameters?.includes(parameter) ? parameter : null;
    this.grasp = new Grasp(this.app, grip, pulls(target.thing, asked), held);
    this.pointer.hover.show(target, grip.dot);
    this.pointer.beside.say(`${target.thing.name} is in the hand: arrows move it, Escape lets go`);
    return true;
  }

  private arrow(arrow: [number, number, number], event: KeyboardEvent): boolean {
    const times = (event.shiftKey ? 10 : 1) * (event.altKey ? 0.1 : 1);
    if (!this.grasp) {
      this.scene.view.move(-30 * times * arrow[0], 30 * times * arrow[1]);
      return true;
    }
    const step = STEP * this.scene.size * times;
    if (this.grasp.parameter) {
      this.by += (arrow[0] + arrow[1] + arrow[2]) * (this.grasp.parameter.startsWith("turn") ? 0.02 * times : step);
      this.grasp.move(this.by);
      return true;
    }
    const axes = this.axes();
    arrow.forEach((share, i) => { for (let k = 0; k < 3; k += 1) this.at[k] = this.at[k]! + share * step * axes[i]![k]!; });
    this.grasp.move(this.at);
    const { x, y } = this.scene.view.toScreen(...this.at, new Vector3());
    this.pointer.beside.moveTo(x, y);
    return true;
  }

  /** Directions of the arrow keys: in space the axes nearest to the right of the picture, to its depth, and up. */
  private axes(): [number, number, number][] {
    const flat = this.scene.view.dim === 2 || !goesInSpace(this.grasp!.thing.role);
    if (flat) return [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    const right = new Vector3().setFromMatrixColumn(this.scene.view.camera.matrix, 0);
    const sidewise = Math.abs(right.x) >= Math.abs(right.y);
    const sign = Math.sign(sidewise ? right.x : right.y) || 1;
    return sidewise ? [[sign, 0, 0], [0, sign, 0], [0, 0, 1]] : [[0, sign, 0], [-sign, 0, 0], [0, 0, 1]];
  }

  private insert(): boolean {
    const target = this.chosen();
    if (target) this.tools.insert(this.pointer.targets.grip(target));
    return Boolean(target);
  }

  private chosen(): Target | null {
    const { selected, things } = this.app;
    return selected && this.pointer.targets.find(things, selected.name);
  }

  private release(): void {
    if (!this.grasp) return;
    this.pointer.beside.say(`${this.grasp.thing.name} is let go`);
    this.grasp.release();
    this.grasp = null;
    this.pointer.hover.show(null, null);
  }

  private leave(): void {
    this.release();
    this.fresh = true;
  }

  private escape(): void {
    this.release();
    this.pointer.release();
    this.pointer.beside.hide();
  }
}
