// One place of the hand for each turn of the display: of two answers within a turn nobody would see the first.

const LONGEST = 50; // ms without a turn, as where the page is not shown, after which none is waited for

export class Turns {
  private done = -Infinity;                          // when something was done last
  private free = true;                               // nothing was done since the display's last turn
  private waiting: (() => void) | null = null;

  /** Does something at once; after something else in the same turn it waits for the next one, and only the last that waits is done. */
  take(act: () => void): void {
    if (this.free || performance.now() - this.done > LONGEST) this.go(act);
    else this.waiting = act;
  }

  /** Does what waits. */
  flush(): void {
    if (this.waiting) this.go(this.waiting);
  }

  private go(act: () => void): void {
    this.waiting = null;
    this.free = false;
    this.done = performance.now();
    act();
    requestAnimationFrame(() => this.turn());
  }

  private turn(): void {
    this.free = true;
    this.flush();
  }
}
