// Which edits were one gesture of the hand: undo and redo take all of them, as many events as there are.

export type Back = "undo" | "redo";

const MOST = 100;                                      // steps that a session takes back at most

export class EditSteps {
  private past: number[] = [];                         // the gesture of each step; 0: of none
  private future: number[] = [];
  private readonly gestures = new Map<number, number>(); // of messages that are not answered
  private readonly backs = new Map<number, Back>();    // undos and redos that are not answered

  /** A message has gone, whose event is part of a gesture; 0: it is all of one. */
  sent(id: number, gesture: number): void { if (id && gesture) this.gestures.set(id, gesture); }
  sentBack(id: number, back: Back): void { if (id) this.backs.set(id, back); }

  /** Whether edits of a gesture are not answered, so that nobody knows how many steps it has. */
  get waits(): boolean { return this.gestures.size > 0; }

  /** An event is written down; steps: by how many more, or fewer, undo can take back. */
  written(id: number, steps: number, redone: boolean): void {
    const gesture = this.gestures.get(id) ?? 0;
    this.answered(id);
    if (steps < 0) this.future.push(this.past.pop() ?? 0);
    else if (steps > 0 && redone) this.past.push(this.future.pop() ?? 0);
    else if (steps > 0) {
      this.past = [...this.past, gesture].slice(-MOST);
      this.future = [];
    }
  }

  /** A message is answered, and those before it, which it may have replaced. */
  answered(id: number): void {
    for (const all of [this.gestures, this.backs]) for (const one of [...all.keys()]) if (one <= id) all.delete(one);
  }

  /** No answer comes any more. */
  forget(): void { this.answered(Infinity); }

  /** How many events take the last gesture back, or do it again, once those on their way have come. */
  count(back: Back): number {
    const past = [...this.past], future = [...this.future];
    for (const one of this.backs.values()) {
      if (one === "undo") future.push(past.pop() ?? 0);
      else past.push(future.pop() ?? 0);
    }
    const from = back === "undo" ? past : future;
    const gesture = from.at(-1) ?? 0;
    let count = 1;
    while (gesture && from.at(-1 - count) === gesture) count += 1;
    return count;
  }
}
