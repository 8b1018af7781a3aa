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
  | { kind: "words"; text: string; at: number[] | null; meaning: string; moved?: number[] }
  | ValueMark;

/** A quantity whose value is written beside a point of the shape. */
export interface ValueMark { kind: "value"; name: string; unit: string; node: number; }
/** What is written of a value. */
export type ValueText = (mark: ValueMark) => string;

type AlongShape = Extract<DrawnMark, { kind: "lines" | "arrows" }>;

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

/** The words of a value where its point is. */
function wordAt(mark: ValueMark, { points, shifts }: DrawnShape, text: ValueText): WordToDraw {
  const from = 3 * mark.node, to = from + 3;
  return { text: text(mark), at: [...points.subarray(from, to)], meaning: "guide", moved: [...shifts.subarray(from, to)] };
}

/** Marks that come and go together: those that are no longer among them are taken away. */
export class MarkGroup {
  private shown = new Map<string, "lines" | "arrows">();
  private following: [string, AlongShape][] = [];
  private words: WordToDraw[] = [];
  private values: ValueMark[] = [];

  constructor(private readonly stage: Stage, private readonly name: string) {}

  /** text: of values; where there are none it is not asked for. */
  draw(marks: DrawnMark[], text: ValueText = ({ name }) => name): void {
    const now = new Map<string, "lines" | "arrows">();
    this.following = [];
    this.words = [];
    this.values = [];
    marks.forEach((mark, index) => {
      if (mark.kind === "words") {
        if (mark.at) this.words.push({ text: mark.text, at: mark.at, meaning: mark.meaning, moved: mark.moved });
        return;
      }
      if (mark.kind === "value") {
        this.values.push(mark);
        return;
      }
      const name = now.has(this.full(mark.name)) ? this.full(`${mark.name} ${index}`) : this.full(mark.name);
      now.set(name, mark.kind);
      if (mark.nodes) this.following.push([name, mark]);
      else this.set(name, mark);
    });
    this.follow(text);
    if (!this.values.length) this.stage.setWords(this.full("words"), this.words.length ? this.words : null);
    for (const [name, kind] of this.shown) {
      // What is drawn now under the name has taken its place already, whatever its kind was.
      if (now.has(name)) continue;
      if (kind === "lines") this.stage.setLines(name, null);
      else this.stage.setArrows(name, null);
    }
    this.shown = now;
  }

  /** Puts what follows the shape where that is drawn now. */
  follow(text: ValueText): void {
    const shape = this.following.length || this.values.length ? this.stage.shape() : null;
    for (const [name, mark] of this.following) {
      if (shape) place(mark, shape);
      this.set(name, mark);
    }
    if (!this.values.length) return;
    const beside = shape ? this.values.map((mark) => wordAt(mark, shape, text)) : [], words = [...this.words, ...beside];
    this.stage.setWords(this.full("words"), words.length ? words : null);
  }

  private set(name: string, mark: AlongShape): void {
    if (mark.kind === "lines") this.stage.setLines(name, mark);
    else this.stage.setArrows(name, mark);
  }

  private full(name: string): string { return `${this.name}: ${name}`; }
}
