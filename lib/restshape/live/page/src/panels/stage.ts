// What the panels need of the drawing: places pressed on the canvas, and marks to draw by a name.

/** Points, moves and vectors have three numbers each; a line of one point is a dot. */
export interface LinesToDraw { points: Float32Array; starts: number[]; meaning: string; moved: Float32Array | null; words: string[]; }
export interface ArrowsToDraw {
  points: Float32Array; vectors: Float32Array; meaning: string; moved: Float32Array | null; tips: boolean[]; words: string[];
}
export interface WordToDraw { text: string; at: number[]; meaning: string; moved?: number[]; }

export interface Stage {
  /** The place [m] at which the canvas is pressed next; null: given up by Escape, or by another pick. what: is to be done. */
  pick(what: string): Promise<number[] | null>;
  /** Where a thing of a name is drawn: its place without displacements, and its displacement; null: it is not. */
  where(name: string): { at: number[]; moved: number[] } | null;
  /** Draws lines, arrows or words in place of those of that name; null takes them away. */
  setLines(name: string, lines: LinesToDraw | null): void;
  setArrows(name: string, arrows: ArrowsToDraw | null): void;
  setWords(name: string, words: WordToDraw[] | null): void;
}

/** Lines, arrows and words of a message, with their arrays. */
export type DrawnMark =
  | ({ kind: "lines"; name: string } & LinesToDraw)
  | ({ kind: "arrows"; name: string; unit: string } & ArrowsToDraw)
  | { kind: "words"; text: string; at: number[] | null; meaning: string; moved?: number[] };

/** Marks that come and go together: those that are no longer among them are taken away. */
export class MarkGroup {
  private shown = new Map<string, "lines" | "arrows">();

  constructor(private readonly stage: Stage, private readonly name: string) {}

  draw(marks: DrawnMark[]): void {
    const now = new Map<string, "lines" | "arrows">();
    const words: WordToDraw[] = [];
    marks.forEach((mark, index) => {
      if (mark.kind === "words") {
        if (mark.at) words.push({ text: mark.text, at: mark.at, meaning: mark.meaning, moved: mark.moved });
        return;
      }
      const name = now.has(this.full(mark.name)) ? this.full(`${mark.name} ${index}`) : this.full(mark.name);
      now.set(name, mark.kind);
      if (mark.kind === "lines") this.stage.setLines(name, mark);
      else this.stage.setArrows(name, mark);
    });
    for (const [name, kind] of this.shown) {
      // What is drawn now under the name has taken its place already, whatever its kind was.
      if (now.has(name)) continue;
      if (kind === "lines") this.stage.setLines(name, null);
      else this.stage.setArrows(name, null);
    }
    this.stage.setWords(this.full("words"), words.length ? words : null);
    this.shown = now;
  }

  private full(name: string): string { return `${this.name}: ${name}`; }
}
