// The tone of the shape: played when it has changed, and when the shape is struck.

import type { App } from "../app";
import type { MarkMessage } from "../protocol";
import type { ToneMark } from "./decoded_marks";
import { button, ChangingText, element } from "./element";
import { digitsText } from "./si_text";
import type { Stage } from "./stage";
import { alike } from "./tone_parameters";
import { TonePlayer } from "./tone_player";

const MALLET = "mallet";                                // of the dot in the picture
const APART = 350;                                      // [ms] between tones at least, while the shape changes

export class Sound {
  readonly body = element("div", { hidden: true });
  private readonly player = new TonePlayer();
  private readonly text = new ChangingText();
  private tone: ToneMark | null = null;
  private played = -Infinity;
  private timer = 0;

  constructor(private readonly app: App, private readonly stage: Stage) {
    const volume = element("input", { type: "range", min: 0, max: 1, step: 0.01, value: 0.7, "aria-label": "volume" });
    volume.addEventListener("input", () => this.player.setVolume(Number(volume.value)));
    const mute = button("mute", "play no tones", () => {
      this.player.muted = !this.player.muted;
      mute.setAttribute("aria-pressed", String(this.player.muted));
    });
    mute.setAttribute("aria-pressed", "false");
    app.on("struck", ({ tone }) => this.hear(tone));
    this.body.append(element("h2", {}, "Sound"), element("p", {}, this.text.node),
      element("div", { class: "row" }, button("strike", "strike where the mallet is", () => this.strike()),
        button("strike at …", "click on the bar where the mallet strikes", () => void this.strikeAt()), mute),
      element("label", { class: "row" }, element("span", {}, "volume"), volume));
  }

  /** The tone of a blow sounds at once. */
  private hear(tone: MarkMessage): void {
    if (tone.kind !== "tone") return;
    this.text.set(toneText(tone));
    this.drawMallet(tone);
    this.play(tone);
  }

  /** Takes the tones of a frame. */
  show(tones: ToneMark[]): void {
    const tone = tones[0] ?? null;
    if (this.body.hidden === (tone !== null)) this.body.hidden = tone === null;
    if (!tone) { this.stage.setLines(MALLET, null); return; }
    this.player.prepare();
    const before = this.tone;
    this.tone = tone;
    this.text.set(toneText(tone));
    this.drawMallet(tone);
    if (before && !alike(before, tone)) this.playSoon();
  }

  /** Draws where the blow of a tone is. */
  private drawMallet({ at, moved: by }: ToneMark): void {
    const [x = 0, y = 0, z = 0] = at ?? [];
    const points = Float32Array.of(x, y, z), moved = by ? Float32Array.from(by) : null;
    this.stage.setLines(MALLET, at ? { points, starts: [0], meaning: "force", moved, words: ["mallet"] } : null);
  }

  private strike(): void { this.app.send({ type: "strike" }); }

  private async strikeAt(): Promise<void> {
    const at = await this.stage.pick("click on the bar where the mallet strikes");
    if (at) this.app.send({ type: "strike", at: at.slice(0, this.app.welcome?.dim ?? 2) });
  }

  private playSoon(): void {
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.play(), Math.max(0, this.played + APART - performance.now()));
  }

  private play(tone = this.tone): void {
    clearTimeout(this.timer);
    if (tone && this.player.play(tone)) this.played = performance.now();
  }
}

/** The name of a tone and its strongest partials. */
function toneText(tone: ToneMark): string {
  const first = tone.frequencies.slice(0, 4).map((frequency) => digitsText(frequency, 4)).join(", ");
  return `${tone.name ? `${tone.name}: ` : ""}${first} Hz`;
}
