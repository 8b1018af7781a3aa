// The drawing and the hand as panels see them.

import type { Scene } from "../draw/scene";
import type { Word } from "../draw/labels";
import type { ArrowsDrawn, LinesDrawn } from "../draw/marks";
import type { Beside } from "./beside";
import type { Tools } from "./tools";

export class PageStage {
  constructor(private readonly scene: Scene, private readonly tools: Tools, private readonly beside: Beside) {}

  /** The place [m] at which the canvas is pressed next; null: given up by Escape, or by another pick. */
  async pick(what: string): Promise<number[] | null> {
    this.beside.say(`press at ${what} in the picture; Escape gives up`);
    const at = await this.tools.pick();
    this.beside.say("");
    return at;
  }

  /** Draws lines, arrows or words in place of those of that name; null takes them away. */
  setLines(name: string, lines: LinesDrawn | null): void { this.scene.setLines(name, lines); }
  setArrows(name: string, arrows: ArrowsDrawn | null): void { this.scene.setArrows(name, arrows); }
  setWords(name: string, words: readonly Word[] | null): void { this.scene.setWords(name, words); }
}
