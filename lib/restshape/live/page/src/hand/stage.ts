// The drawing and the hand as panels see them.

import type { Scene } from "../draw/scene";
import type { Word } from "../draw/labels";
import type { ArrowsDrawn, LinesDrawn } from "../draw/marks";
import type { App } from "../app";
import type { Beside } from "./beside";
import { anchorOf, type Targets } from "./targets";
import type { Tools } from "./tools";

export class PageStage {
  constructor(
    private readonly app: App, private readonly scene: Scene, private readonly tools: Tools, private readonly beside: Beside,
    private readonly targets: Targets,
  ) {}

  /** Where a thing of a name is drawn: its place without displacements, and its displacement; null: it is not. */
  where(name: string): { at: number[]; moved: number[] } | null {
    const target = this.targets.find(this.app.things, name);
    return target && anchorOf(target);
  }

  /** The shape of the last frame; null: there is none. */
  shape(): { points: Float32Array; shifts: Float32Array } | null { return this.scene.parts.shape() ?? null; }

  /** The place [m] at which the canvas is pressed next; null: given up by Escape, or by another pick. */
  async pick(what: string): Promise<number[] | null> {
    this.beside.say(`${what}; Escape gives up`);
    const at = await this.tools.pick();
    this.beside.say("");
    return at;
  }

  /** Draws lines, arrows or words in place of those of that name; null takes them away. */
  setLines(name: string, lines: LinesDrawn | null): void { this.scene.setLines(name, lines); }
  setArrows(name: string, arrows: ArrowsDrawn | null): void { this.scene.setArrows(name, arrows); }
  setWords(name: string, words: readonly Word[] | null): void { this.scene.setWords(name, words); }
}
