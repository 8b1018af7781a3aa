// An amount that is reached by events of what is still missing: each waits for the answer to the one before.

import type { App } from "../app";
import type { ScriptEvent } from "../protocol";

const PATIENCE = 3_000; // ms after which an answer is no longer waited for

export class Steps {
  private wanted: number;
  private done: number;
  private trying: { id: number; to: number; since: number } | null = null;
  private readonly ends: (() => void)[];
  private readonly gesture: number;

  /** still: the amount to begin with. event: from the amount that is reached to the one that is wanted. */
  constructor(private readonly app: App, private readonly still: number, private readonly event: (from: number, to: number) => ScriptEvent) {
    this.wanted = this.done = still;
    this.gesture = app.gesture();
    this.ends = [
      app.on("drawn", (id) => this.answered(id, true)),
      app.on("done", ({ id }) => this.answered(id, true)),
      app.on("refused", ({ id }) => this.answered(id, false)),
    ];
  }

  to(amount: number): void {
    this.wanted = amount;
    this.next();
  }

  /** What is still missing is sent; no more is waited for. */
  end(): void {
    if (!this.trying) for (const stop of this.ends) stop();
    else setTimeout(() => this.end(), 50);
  }

  get moved(): boolean { return this.wanted !== this.still; }

  private next(): void {
    const late = this.trying && performance.now() - this.trying.since > PATIENCE;
    if ((this.trying && !late) || this.wanted === this.done) return;
    const id = this.app.act(this.event(this.done, this.wanted), false, this.gesture);
    this.trying = id ? { id, to: this.wanted, since: performance.now() } : null;
  }

  private answered(id: number, well: boolean): void {
    if (!this.trying || id < this.trying.id) return;
    if (well) this.done = this.trying.to;
    else this.wanted = this.done; // refused: the next move of the hand tries again
    this.trying = null;
    this.next();
  }
}
