// Whether a frame is drawn as soon as it has come, before the display asks for it. Where frames come faster than they are
// shown, that is often in vain.

const OFTEN = 3; // drawings one after the other, all in vain, after which
const PAUSE = 20; // drawings are not made ahead

export class Ahead {
  private drawn = false;                             // since the display's last turn
  private overtaken = false;                         // another frame has come since
  private inVain = 0;                                // one after the other
  private pause = 0;

  /** A frame has come; whether it is to be drawn now. */
  wants(): boolean {
    this.overtaken ||= this.drawn;
    if (this.drawn || this.pause > 0) return false;
    this.drawn = true;
    return true;
  }

  /** The display asks for a drawing. */
  turn(): void {
    this.inVain = this.overtaken ? this.inVain + 1 : 0;
    if (this.inVain >= OFTEN) this.pause = PAUSE;
    else if (this.pause > 0) this.pause -= 1;
    if (this.pause === PAUSE) this.inVain = 0;
    this.drawn = this.overtaken = false;
  }
}
