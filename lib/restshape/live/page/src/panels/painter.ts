// What the panels write, at most once in a frame of the display: all that is short, and one of the longer drawings.

export class Painter {
  private readonly short = new Set<() => void>();
  private readonly long = new Set<() => void>();
  private asked = false;
  /** [ms] that the last turn took, and the longest one. */
  last = 0;
  longest = 0;

  /** A write that costs little, such as of texts. */
  soon(write: () => void): void {
    this.short.add(write);
    this.ask();
  }

  /** A drawing that costs more: one of them is made in each frame of the display, in turn. */
  inTurn(drawing: () => void): void {
    this.long.add(drawing);
    this.ask();
  }

  private ask(): void {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => this.turn());
  }

  private turn(): void {
    this.asked = false;
    const begun = performance.now();
    const writes = [...this.short];
    this.short.clear();
    for (const write of writes) write();
    const [drawing] = this.long;
    if (drawing) {
      this.long.delete(drawing);
      drawing();
    }
    this.last = performance.now() - begun;
    this.longest = Math.max(this.longest, this.last);
    if (this.long.size) this.ask();
  }
}
