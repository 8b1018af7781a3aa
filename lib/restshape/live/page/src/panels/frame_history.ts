// Values of each frame of the edit, for the plots.

/** Numbers by frame: of frames that were not seen there is none (NaN). */
export class Series {
  private values = new Float64Array(64).fill(NaN);
  private used = 0;

  get length(): number { return this.used; }

  /** The values up to the last frame, without a copy. */
  get all(): Float64Array { return this.values.subarray(0, this.used); }

  set(frame: number, value: number): void {
    while (frame >= this.values.length) {
      const grown = new Float64Array(2 * this.values.length).fill(NaN);
      grown.set(this.values);
      this.values = grown;
    }
    this.values[frame] = value;
    this.used = Math.max(this.used, frame + 1);
  }

  /** Forgets frames from this one on. */
  cut(frame: number): void {
    if (frame >= this.used) return;
    this.values.fill(NaN, frame, this.used);
    this.used = frame;
  }
}

/** Series by name, all cut and begun anew together. A page that is slower than the frames does not see all of them. */
export class FrameHistory {
  private readonly byName = new Map<string, Series>();
  private readonly seen = new Series();
  private x = new Float64Array(64);
  private y = new Float64Array(64);
  last = -1;

  /** The frames that were seen and their values, valid until the next call. */
  points(name: string): { x: Float64Array; y: Float64Array } {
    const seen = this.seen.all, values = this.series(name).all;
    if (this.x.length < seen.length) [this.x, this.y] = [new Float64Array(2 * seen.length), new Float64Array(2 * seen.length)];
    let count = 0;
    for (let frame = 0; frame < seen.length; frame += 1) {
      if (seen[frame] !== 1) continue;
      this.x[count] = frame;
      this.y[count] = frame < values.length ? values[frame]! : NaN;
      count += 1;
    }
    return { x: this.x.subarray(0, count), y: this.y.subarray(0, count) };
  }

  series(name: string): Series {
    let found = this.byName.get(name);
    if (!found) this.byName.set(name, found = new Series());
    return found;
  }

  /** Takes a frame in. `kept`: later frames stay known, as where a recorded script is scrubbed. */
  add(frame: number, values: Iterable<[string, number]>, kept: boolean): void {
    if (!kept && frame <= this.last) this.cut(frame);
    this.seen.set(frame, 1);
    for (const [name, value] of values) this.series(name).set(frame, value);
    this.last = kept ? Math.max(this.last, frame) : frame;
  }

  cut(frame: number): void {
    for (const one of [this.seen, ...this.byName.values()]) one.cut(frame);
    this.last = Math.min(this.last, frame - 1);
  }

  clear(): void {
    this.byName.clear();
    this.seen.cut(0);
    this.last = -1;
  }
}
