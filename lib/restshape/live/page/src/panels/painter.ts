// What the page writes beside the picture, at most ten times a second: nobody reads faster, and each time the browser lays
// the page out and paints it. Drawings come one by one between the display's turns, so that no frame waits for all of them.

const PACE = 100;                                       // [ms] between two writings, and two drawings of the same
const STEP = 16;                                        // [ms] between two drawings

export class Painter {
  private readonly writes = new Set<() => void>();
  private readonly drawings = new Set<() => void>();
  private readonly drawn = new WeakMap<() => void, number>();
  private written = -Infinity;
  private stepped = -Infinity;
  private timer: ReturnType<typeof setTimeout> | null = null;

  /** A write that costs little, such as of texts: all that wait are done together. */
  soon(write: () => void): void {
    this.writes.add(write);
    this.ask();
  }

  /** A drawing that costs more: each has its own turn. */
  inTurn(drawing: () => void): void {
    this.drawings.add(drawing);
    this.ask();
  }

  /** Writes and draws all at once, such as before somebody keeps what is seen. */
  now(): void {
    this.write();
    for (const drawing of [...this.drawings]) this.draw(drawing);
  }

  private ask(): void {
    if (this.timer !== null) return;
    const drawing = this.next(), due = Math.min(
      this.writes.size ? this.written + PACE : Infinity,
      drawing ? Math.max((this.drawn.get(drawing) ?? -Infinity) + PACE, this.stepped + STEP) : Infinity,
    );
    if (due < Infinity) this.timer = setTimeout(() => this.step(), Math.max(due - performance.now(), 0));
  }

  private step(): void {
    this.timer = null;
    const now = performance.now(), drawing = this.next();
    if (this.writes.size && now >= this.written + PACE) this.write();
    else if (drawing) this.draw(drawing);
    this.stepped = now;
    this.ask();
  }

  /** The drawing that was made the longest time ago. */
  private next(): (() => void) | null {
    let found: (() => void) | null = null, least = Infinity;
    for (const drawing of this.drawings) {
      const at = this.drawn.get(drawing) ?? -Infinity;
      if (!found || at < least) [found, least] = [drawing, at];
    }
    return found;
  }

  private write(): void {
    this.written = performance.now();
    const writes = [...this.writes];
    this.writes.clear();
    for (const write of writes) write();
  }

  private draw(drawing: () => void): void {
    this.drawings.delete(drawing);
    this.drawn.set(drawing, performance.now());
    drawing();
  }
}
