// What the panels need of the drawing: places pressed on the canvas, and marks to draw by a name.

/** Points, moves and vectors have three numbers each; a line of one point is a dot. */
export interface LinesToDraw { points: Float32Array; starts: number[]; meaning: string; moved: Float32Array | null; words: string[]; }
export interface ArrowsToDraw {
  points: Float32Array; vectors: Float32Array; meaning: string; moved: Float32Array | null; tips: boolean[]; words: string[];
}
/** Places and displacements of the shape's points as it is drawn, three numbers each; none where it has no displacements. */
export interface DrawnShape { points: Float32Array; shifts: Float32Array; }
export interface WordToDraw { text: string; at: number[]; meaning: string; moved?: number[]; }

export interface Stage {
  /** The place [m] at which the canvas is pressed next; null: given up by Escape, or by another pick. what: is to be done. */
  pick(what: string): Promise<number[] | null>;
  /** Where a thing of a name is drawn: its place without displacements, and its displacement; null: it is not. */
  where(name: string): { at: number[]; moved: number[] } | null;
  /** The shape of the last frame; null: there is none. */
  shape(): DrawnShape | null;
  /** Draws lines, arrows or words in place of those of that name; null takes them away. */
  setLines(name: string, lines: LinesToDraw | null): void;
  setArrows(name: string, arrows: ArrowsToDraw | null): void;
  setWords(name: string, words: WordToDraw[] | null): void;
}

/** Lines, arrows and words of a message, with their arrays. nodes: in whose middle their points are, if any: the same number of each. */
export type DrawnMark =
  | ({ kind: "lines"; name: string; nodes?: Uint32Array } & LinesToDraw)
  | ({ kind: "arrows"; name: string; unit: string; nodes?: Uint32Array } & ArrowsToDraw)
  | { kind: "words"; text: string; at: number[] | null; meaning: string; moved?: number[] };

type AlongShape = Exclude<DrawnMark, { kind: "words" }>;

/** Puts the points of a mark into the middles of its nodes. */
export function place(mark: AlongShape, { points, shifts }: DrawnShape): void {
  const nodes = mark.nodes ?? new Uint32Array(0), each = (3 * nodes.length) / mark.points.length || 1;
  const moved = (mark.moved ??= new Float32Array(mark.points.length));
  for (let i = 0; i < mark.points.length; i += 3) {
    const first = (i / 3) * each;
    for (let k = 0; k < 3; k += 1) {
      let at = 0, by = 0;
      for (let j = first; j < first + each; j += 1) {
        at += points[3 * nodes[j]! + k] ?? 0;
        by += shifts[3 * nodes[j]! + k] ?? 0;
      }
      mark.points[i + k] = at / each;
      moved[i + k] = by / each;
    }
  }
}

/** Marks that come and go together: those that are no longer among them are taken away. */
export class MarkGroup {
  private shown = new Map<string, "lines" | "arrows">();
  private following: [string, AlongShape][] = [];

  constructor(private readonly stage: Stage, private readonly name: string) {}

  draw(marks: DrawnMark[]): void {
    const now = new Map<string, "lines" | "arrows">();
    this.following = [];
    const words: WordToDraw[] = [];
    marks.forEach((mark, index) => {
      if (mark.kind === "words") {
        if (mark.at) words.push({ text: mark.text, at: mark.at, meaning: mark.meaning, moved: mark.moved });
        return;
      }
      const name = now.has(this.full(mark.name)) ? this.full(`${mark.name} ${index}`) : this.full(mark.name);
      now.set(name, mark.kind);
      if (mark.nodes) this.following.push([name, mark]);
      else this.set(name, mark);
    });
    this.follow();
    for (const [name, kind] of this.shown) {
      // What is drawn now under the name has taken its place already, whatever its kind was.
      if (now.has(name)) continue;
      if (kind === "lines") this.stage.setLines(name, null);
      else this.stage.setArrows(name, null);
    }
    this.stage.setWords(this.full("words"), words.length ? words : null);
    this.shown = now;
  }

  /** Puts what follows the shape where that is drawn now. */
  follow(): void {
    const shape = this.following.length ? this.stage.shape() : null;
    for (const [name, mark] of this.following) {
      if (shape) place(mark, shape);
      this.set(name, mark);
    }
  }

  private set(name: string, mark: AlongShape): void {
    if (mark.kind === "lines") this.stage.setLines(name, mark);
    else this.stage.setArrows(name, mark);
  }

  private full(name: string): string { return `${this.name}: ${name}`; }
}
