// What the page writes beside the picture, at most ten times a second: nobody reads faster, and each time the browser lays
// the page out and paints it.

const PACE = 100;                                       // [ms] between two turns
const ROOM = 6;                                         // [ms] of a turn in which drawings begin

export class Painter {
  private readonly short = new Set<() => void>();
  private readonly long = new Set<() => void>();
  private asked = false;
  private turned = -Infinity;

  /** A write that costs little, such as of texts. */
  soon(write: () => void): void {
    this.short.add(write);
    this.ask();
  }

  /** A drawing that costs more: where a turn has no room for all, the rest waits for the next one. */
  inTurn(drawing: () => void): void {
    this.long.add(drawing);
    this.ask();
  }

  /** Writes all at once, such as before somebody keeps what is seen. */
  now(): void { this.turn(Infinity); }

  private ask(): void {
    if (this.asked) return;
    this.asked = true;
    setTimeout(() => { this.asked = false; this.turn(ROOM); }, Math.max(this.turned + PACE - performance.now(), 0));
  }

  private turn(room: number): void {
    const begun = this.turned = performance.now();
    const writes = [...this.short];
    this.short.clear();
    for (const write of writes) write();
    for (const drawing of [...this.long]) {
      this.long.delete(drawing);
      drawing();
      if (performance.now() - begun > room) break;
    }
    if (this.long.size) this.ask();
  }
}
