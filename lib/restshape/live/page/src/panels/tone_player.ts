// Plays tones with the browser's synthesis; browsers let it begin after a gesture.

import type { ToneMark } from "./decoded_marks";
import { partials, volumeGain } from "./tone_parameters";

const ATTACK = 0.004;                                   // [s] in which a partial rises, so that it does not click
const FADE = 0.03;                                      // [s] in which the tone before is taken away

export class TonePlayer {
  private context: AudioContext | null = null;
  private master: GainNode | null = null;
  private sounding: GainNode | null = null;
  private volume = 0.7;
  private wanted = false;
  muted = false;

  constructor() {
    const wake = () => { if (this.wanted) void this.wake(); };
    for (const gesture of ["pointerdown", "keydown"]) addEventListener(gesture, wake, { capture: true, passive: true });
  }

  /** There are tones: from now on a gesture lets them sound, or one that was made. Without any the browser keeps no sound running. */
  prepare(): void {
    if (this.wanted) return;
    this.wanted = true;
    if (navigator.userActivation?.hasBeenActive) void this.wake();
  }

  /** Whether the browser lets it sound. */
  get ready(): boolean { return this.context?.state === "running"; }

  setVolume(volume: number): void {
    this.volume = volume;
    if (this.master) this.master.gain.value = volumeGain(volume);
  }

  /** Plays a tone in place of the one that sounds. Gives whether it is heard. */
  play(tone: ToneMark): boolean {
    const { context, master } = this;
    if (!context || !master || context.state !== "running" || this.muted) return false;
    this.stop();
    const now = context.currentTime;
    const bus = new GainNode(context);
    bus.connect(master);
    this.sounding = bus;
    for (const { frequency, gain, decay, seconds } of partials(tone)) {
      const envelope = new GainNode(context, { gain: 0 });
      envelope.gain.setValueAtTime(0, now);
      envelope.gain.linearRampToValueAtTime(gain, now + ATTACK);
      envelope.gain.setTargetAtTime(0, now + ATTACK, 1 / decay);
      const source = new OscillatorNode(context, { frequency });
      source.connect(envelope).connect(bus);
      source.start(now);
      source.stop(now + ATTACK + seconds);
    }
    return true;
  }

  private stop(): void {
    if (!this.sounding || !this.context) return;
    const before = this.sounding, now = this.context.currentTime;
    before.gain.setTargetAtTime(0, now, FADE / 3);
    setTimeout(() => before.disconnect(), 2000 * FADE);
  }

  private async wake(): Promise<void> {
    if (!this.context) {
      try { this.context = new AudioContext(); } catch { return; }
      this.master = new GainNode(this.context, { gain: volumeGain(this.volume) });
      this.master.connect(this.context.destination);
    }
    if (this.context.state === "suspended") await this.context.resume().catch(() => undefined);
  }
}
