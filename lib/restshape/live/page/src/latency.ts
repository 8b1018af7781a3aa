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
    if (this.ids[id % KEPT] === id) this.app.tell("latency", performance.now() - this.times[id % KEPT]!);
  }
}
