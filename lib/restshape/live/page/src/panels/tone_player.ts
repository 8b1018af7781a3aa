// Plays tones with the browser's synthesis; browsers let it begin after a gesture.

import type { ToneMark } from "./decoded_marks";
import { partials, volumeGain } from "./tone_parameters";

const ATTACK = 0.004;                                   // [s] in which a partial rises, so that it does not click
const FADE = 0.03;                                      // [s] in which the tone before is taken away
const SILENCE = 10_000;                                 // [ms] after the last tone, until the browser's sound is stopped: it takes time of the processor

export class TonePlayer {
  private context: AudioContext | null = null;
  private master: GainNode | null = null;
  private sounding: GainNode | null = null;
  private volume = 0.7;
  private wanted = false;
  private resting = false;                              // stopped in silence: the next tone lets it go on
  private silence: ReturnType<typeof setTimeout> | undefined;
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
  get ready(): boolean { return this.resting || this.context?.state === "running"; }

  setVolume(volume: number): void {
    this.volume = volume;
    if (this.master) this.master.gain.value = volumeGain(volume);
  }

  /** Plays a tone in place of the one that sounds. Gives whether it is heard. */
  play(tone: ToneMark): boolean {
    const { context, master } = this;
    if (!context || !master || !this.ready || this.muted) return false;
    if (this.resting) void context.resume();
    this.resting = false;
    this.stop();
    const now = context.currentTime;
    const bus = new GainNode(context);
    bus.connect(master);
    this.sounding = bus;
    const played = partials(tone);
    for (const { frequency, gain, decay, seconds } of played) {
      const envelope = new GainNode(context, { gain: 0 });
      envelope.gain.setValueAtTime(0, now);
      envelope.gain.linearRampToValueAtTime(gain, now + ATTACK);
      envelope.gain.setTargetAtTime(0, now + ATTACK, 1 / decay);
      const source = new OscillatorNode(context, { frequency });
      source.connect(envelope).connect(bus);
      source.start(now);
      source.stop(now + ATTACK + seconds);
    }
    this.restAfter(1_000 * Math.max(0, ...played.map(({ seconds }) => seconds)) + SILENCE);
    return true;
  }

  private stop(): void {
    if (!this.sounding || !this.context) return;
    const before = this.sounding, now = this.context.currentTime;
    before.gain.setTargetAtTime(0, now, FADE / 3);
    setTimeout(() => before.disconnect(), 2000 * FADE);
  }

  private restAfter(ms: number): void {
    clearTimeout(this.silence);
    this.silence = setTimeout(() => {
      if (this.context?.state !== "running") return;
      this.resting = true;
      void this.context.suspend();
    }, ms);
  }

  private async wake(): Promise<void> {
    if (this.resting) return;
    if (!this.context) {
      try { this.context = new AudioContext(); } catch { return; }
      this.master = new GainNode(this.context, { gain: volumeGain(this.volume) });
      this.master.connect(this.context.destination);
      this.restAfter(SILENCE);
    }
    if (this.context.state === "suspended") await this.context.resume().catch(() => undefined);
  }
}
