// How long it takes from a message to the picture that answers it.

import type { App } from "./app";

const KEPT = 512;

export class Latency {
  private readonly ids = new Float64Array(KEPT);
  private readonly times = new Float64Array(KEPT);

  constructor(private readonly app: App) {
    app.on("drawn", (id) => this.answered(id));
  }

  sent(id: number): number {
    this.ids[id % KEPT] = id;
    this.times[id % KEPT] = performance.now();
    return id;
  }

  private answered(id: number): void {
    if (this.ids[id % KEPT] !== id) return;
    const ms = performance.now() - this.times[id % KEPT]!;
    this.app.tell("latency", ms);
    // For who measures the page from outside, such as `restshape bench live`.
    document.dispatchEvent(new CustomEvent("restshape-drawn", { detail: { id, ms } }));
  }
}
