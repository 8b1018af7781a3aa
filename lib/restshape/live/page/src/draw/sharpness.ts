// How sharp the picture is drawn while it moves: where the browser falls behind, as without a graphics card, in fewer pixels.

const STEPS = [1, 0.75, 0.5]; // of the canvas's full number of pixels a length
const LATE = 21; // ms from a request to its drawing; a display of 60 frames a second takes at most 17
const HEAVY = 8; // ms of the page's own in a drawing, half of its turn: a drawing that takes more counts as late
const LOOKED = 8; // drawings that decide together
const MANY = 3; // late ones of these: the picture takes fewer pixels
const REST = 180; // ms without a drawing after which the picture is at rest, and full
const FIRST = 120; // drawings in time after which more pixels are tried again; twice as many after each vain try

/** Decides by when drawings are asked for, when they happen, and how long they take. Times in ms. */
export class Sharpness {
  private step = 0;
  private moving = false;
  private asked = 0;
  private looked = 0;
  private late = 0;
  private inTime = 0;
  private patience = FIRST;
  private heavy = false;
  private timer: ReturnType<typeof setTimeout> | null = null;

  /** changed: is told that the picture must be drawn at another `share`. */
  constructor(private readonly changed: () => void) {}

  /** Of the full number of pixels a length, as it is now. */
  get share(): number { return this.moving ? STEPS[this.step]! : 1; }

  request(now: number): void { this.asked = now; }

  /** A drawing that was asked for begins; moving: since something goes on in the picture, which is not at rest. */
  begin(now: number, moving: boolean): void {
    const before = this.share;
    if (moving) this.take(this.heavy || now - this.asked > LATE);
    this.heavy = false;
    this.moving = moving || (this.moving && this.timer !== null);
    if (moving && this.step > 0) this.await();
    if (this.share !== before) this.changed();
  }

  /** A drawing has taken so long, before or after it has begun by `begin`. */
  took(ms: number): void { this.heavy ||= ms > HEAVY; }

  /** The picture is at rest: all pixels again. */
  settle(): void {
    if (this.timer !== null) clearTimeout(this.timer);
    this.timer = null;
    const before = this.share;
    this.moving = false;
    if (before !== 1) this.changed();
  }

  private await(): void {
    if (this.timer !== null) clearTimeout(this.timer);
    this.timer = setTimeout(() => this.settle(), REST);
  }

  private take(late: boolean): void {
    this.looked += 1;
    if (late) this.late += 1;
    this.inTime = late ? 0 : this.inTime + 1;
    if (this.late >= MANY && this.step + 1 < STEPS.length) this.go(1);
    else if (this.inTime >= this.patience && this.step > 0) {
      this.patience *= 2;
      this.go(-1);
    } else if (this.looked >= LOOKED) this.looked = this.late = 0;
  }

  private go(by: number): void {
    this.step += by;
    this.looked = this.late = this.inTime = 0;
  }
}
