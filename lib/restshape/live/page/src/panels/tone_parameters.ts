// How a tone of decaying partials is played: gains, lengths, and what is left out.

import type { ToneMark } from "./decoded_marks";

export interface Partial { frequency: number; gain: number; decay: number; seconds: number; }

const AUDIBLE = [20, 18_000] as const;                  // [Hz]
const QUIET = 1e-3;                                     // of the loudest partial: below it is not played, and a partial ends
const MOST = 24;                                        // partials
const LONGEST = 6;                                      // [s]
const LOUDEST = 0.5;                                    // sum of all gains at full volume, so that nothing clips

/** The partials that are heard, loudest first. `decay` [1/s] of amplitudes; `seconds` until each is a thousandth. */
export function partials(tone: Pick<ToneMark, "frequencies" | "decays" | "amplitudes">): Partial[] {
  const heard = tone.frequencies
    .map((frequency, index) => ({ frequency, gain: Math.abs(tone.amplitudes[index] ?? 0), decay: Math.max(tone.decays[index] ?? 1, 0) }))
    .filter(({ frequency, gain }) => frequency >= AUDIBLE[0] && frequency <= AUDIBLE[1] && Number.isFinite(gain));
  const loudest = Math.max(...heard.map(({ gain }) => gain), 0);
  const kept = heard.filter(({ gain }) => gain > QUIET * loudest).sort((one, other) => other.gain - one.gain).slice(0, MOST);
  const sum = kept.reduce((all, { gain }) => all + gain, 0);
  return kept.map(({ frequency, gain, decay }) => {
    const seconds = Math.min(LONGEST, decay > 0 ? Math.log(1 / QUIET) / decay : LONGEST);
    return { frequency, gain: (LOUDEST * gain) / sum, decay: Math.max(decay, Math.log(1 / QUIET) / LONGEST), seconds };
  });
}

/** Whether two tones sound alike: the same partials to a cent, and amplitudes to a hundredth. */
export function alike(one: ToneMark | null, other: ToneMark): boolean {
  if (!one || one.frequencies.length !== other.frequencies.length) return false;
  return one.frequencies.every((frequency, index) =>
    Math.abs(1200 * Math.log2(frequency / other.frequencies[index]!)) < 1
    && Math.abs((one.amplitudes[index] ?? 0) - (other.amplitudes[index] ?? 0)) < 0.01);
}

/** The gain of a volume between 0 and 1, such that equal steps sound equal: 40 dB over all, silence at 0. */
export function volumeGain(volume: number): number {
  return volume <= 0 ? 0 : 10 ** (2 * (Math.min(volume, 1) - 1));
}
