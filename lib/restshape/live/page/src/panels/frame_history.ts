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

/** Series by name, all cut and begun anew together. */
export class FrameHistory {
  private readonly byName = new Map<string, Series>();
  last = -1;

  series(name: string): Series {
    let found = this.byName.get(name);
    if (!found) this.byName.set(name, found = new Series());
    return found;
  }

  /** Takes a frame in. `kept`: later frames stay known, as where a recorded script is scrubbed. */
  add(frame: number, values: Iterable<[string, number]>, kept: boolean): void {
    if (!kept && frame <= this.last) this.cut(frame);
    for (const [name, value] of values) this.series(name).set(frame, value);
    this.last = kept ? Math.max(this.last, frame) : frame;
  }

  cut(frame: number): void {
    for (const one of this.byName.values()) one.cut(frame);
    this.last = Math.min(this.last, frame - 1);
  }

  clear(): void {
    this.byName.clear();
    this.last = -1;
  }
}

let counted = new Float64Array(0);

/** 0, 1, 2, ... as many as asked for, without a new array each time. */
export function counting(many: number): Float64Array {
  if (counted.length < many) counted = new Float64Array(Math.max(1024, 2 * many)).map((_, index) => index);
  return counted.subarray(0, many);
}
