"""The tone of a whole drag: it glides with the frequencies of the frames, and its phase never jumps."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from restshape_apps.metallophone.sounding.damping import damping_of
from restshape_apps.metallophone.sounding.mallet import excitation, pole
from restshape_apps.metallophone.sounding.place import struck_place
from restshape_apps.metallophone.sounding.wav import RATE, normalised

from restshape.analysis.modal.modal import ModalAnalysis
from restshape.errors import UserError
from restshape.shape.script_session import FRAME_TIME

REST = 0.05
"""Time [s] between frames beyond which the hand rests: tones stay, but for the time of one frame before the next."""
EDGE = 5e-3
"""Time [s] over which a sine sets in and dies away: no sound begins with a jump."""


@dataclass(frozen=True, eq=False)
class ModesAt:
    """The modes of a frame, as they are heard.

    Args:
        t: edit time [s].
        ids: (k,) of the modes; frequencies: (k,) [Hz], ascending.
        deflections: (k,) where they are struck, each of unit modal mass; damping: (k,) shares of critical damping.
    """

    t: float
    ids: np.ndarray
    frequencies: np.ndarray
    deflections: np.ndarray
    damping: np.ndarray


def modes_at(analysis: ModalAnalysis, t: float, at: Sequence[float] | None, damping: float | None) -> ModesAt:
    """The modes of a frame at its edit time; arguments as of `place.struck_place` and `damping.damping_of`.

    Raises:
        UserError: the place is off the plate in this frame.
    """
    try:
        _, deflections = struck_place(analysis, at)
    except UserError as error:
        raise UserError(f"at the edit time {t:g} s {error.what}", error.where, error.do) from error
    shares = damping_of(analysis, damping).shares
    return ModesAt(t, analysis.state.ids.copy(), analysis.frequencies.copy(), deflections, shares)


def in_order(frames: Iterable[ModesAt], begin: float, end: float) -> list[ModesAt]:
    """Frames by their edit time, of several at one time the last, with more of them where tones stay as they are.

    Tones of frames that follow each other glide. Before the first and after the last frame, and while the hand rests,
    they stay.

    Args:
        frames: those that have modes.
        begin, end: of the edits [s].

    Raises:
        UserError: no frame has modes, or the edits have no duration.
    """
    by_time = {frame.t: frame for frame in frames}
    if not by_time:
        raise UserError("no frame of the edits has modes", "--drag", "add an event analyse to the script")
    if not begin < end:
        what = "the edits have no duration, so that their tone has none"
        raise UserError(what, "--drag", "name a script whose events have different times, or leave --drag out")
    known = [by_time[t] for t in sorted(by_time)]
    ends = {begin: known[0], end: known[-1]}
    by_time |= {t: replace(frame, t=t) for t, frame in ends.items() if t not in by_time}
    found = [by_time[t] for t in sorted(by_time)]
    rests = [(one, next_one.t - FRAME_TIME) for one, next_one in pairwise(found) if next_one.t - one.t > REST]
    return sorted([*found, *(replace(one, t=until) for one, until in rests)], key=lambda frame: frame.t)


def sine(frames: Sequence[ModesAt], rate: int = RATE) -> np.ndarray:
    """The first tone (n,) of frames in order, as a sine of constant loudness and the length of their edit time."""
    times = np.array([frame.t for frame in frames])
    glide = Glide(times, np.array([frame.frequencies[0] for frame in frames]), np.zeros(len(times)))
    t = _sample_times(times, rate)
    edge = np.minimum(1.0, np.minimum(t - times[0], times[-1] - t) / EDGE)
    return normalised(edge * np.imag(np.exp(glide(t))))


def blows(frames: Sequence[ModesAt], every: float, contact: float, rate: int = RATE) -> np.ndarray:
    """The sound (n,), its largest size 1, of a plate that is struck again and again while it is edited.

    A mode that rings goes on through the frames, with the frequency that it has there, and the next blow adds to it.
    What was struck as one mode stays one, by its id, through crossings. A mode that is no longer among those that the
    scene asks for dies away until the next frame; one that comes later sounds from the next blow on.

    Args:
        frames: in order.
        every: time [s] from blow to blow, the first at the beginning; contact: time [s] for which the mallet touches.
        rate: samples a second.
    """
    times = np.array([frame.t for frame in frames])
    t = _sample_times(times, rate)
    struck_at = np.arange(times[0], times[-1], every)
    sound = np.zeros(len(t))
    for voice in voices(frames):
        part = slice(*np.searchsorted(t, [voice.begin, voice.end]))
        sound[part] += voice.heard(t[part], struck_at, contact, rate)
    return normalised(sound)


class Glide:
    """The exponent of a mode whose frequency glides from frame to frame, its logarithm linear in time.

    Args:
        times: (m,) of frames [s], ascending; frequencies: (m,) [Hz]; damping: (m,) shares of critical damping, each
            until the next frame.
    """

    def __init__(self, times: np.ndarray, frequencies: np.ndarray, damping: np.ndarray) -> None:
        self.times, self.frequencies, self.damping = times, frequencies, damping
        self._rates = np.diff(np.log(frequencies)) / np.diff(times)
        turns = self._turns(np.arange(len(times) - 1), np.diff(times))
        self._reached = np.concatenate([[0.0], np.cumsum(turns * (1j - damping[:-1]))])

    def __call__(self, t: np.ndarray) -> np.ndarray:
        """The exponents (n,) at times (n,), 0 at the first frame: the imaginary part is the phase [rad], exact."""
        k = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self._rates) - 1)
        return self._reached[k] + self._turns(k, t - self.times[k]) * (1j - self.damping[k])

    def frequency(self, t: np.ndarray) -> np.ndarray:
        """The frequencies (n,) [Hz] at times (n,)."""
        return np.exp(np.interp(t, self.times, np.log(self.frequencies)))

    def _turns(self, k: np.ndarray, since: np.ndarray) -> np.ndarray:
        """The angles [rad] by which the phase has gone on at times `since` frames k."""
        rise = self._rates[k] * since
        mean = np.where(np.abs(rise) < 1e-9, 1.0 + 0.5 * rise, np.expm1(rise) / np.where(rise == 0.0, 1.0, rise))
        return 2.0 * np.pi * self.frequencies[k] * mean * since


@dataclass(frozen=True, eq=False)
class Voice:
    """A mode through the frames in which the scene has it.

    Args:
        glide: of its frequency; deflections: (m,) where it is struck in those frames.
        begin: time of its first frame [s]; last: of its last; end: of the next frame, by which it has died away.
    """

    glide: Glide
    deflections: np.ndarray
    begin: float
    last: float
    end: float

    def heard(self, t: np.ndarray, struck_at: np.ndarray, contact: float, rate: int) -> np.ndarray:
        """What is heard (n,) of it at times (n,) when it is struck at times (b,)."""
        own = struck_at[(struck_at >= self.begin) & (struck_at < self.end)]
        deflection = np.interp(t, self.glide.times, self.deflections)
        frequency = self.glide.frequency(t)
        # The next blow begins where the last has left the mode.
        rung, before, amplitude = np.zeros(len(t), dtype=complex), None, 0j
        bounds = np.searchsorted(t, [*own, np.inf])
        for at, first, last in zip(own, bounds, bounds[1:]):
            start = self.glide(np.array([at]))[0]
            amplitude = 0j if before is None else amplitude * np.exp(start - before)
            push = np.interp(at, self.glide.times, self.deflections)
            s = pole(self.glide.frequency(np.array([at]))[0], np.interp(at, self.glide.times, self.glide.damping))
            given = push * excitation(s, contact, t[first:last] - at)
            rung[first:last] = (amplitude + given) * np.exp(self.glide(t[first:last]) - start)
            amplitude, before = amplitude + push * excitation(s, contact, np.array([contact]))[0], start
        fades = 1.0 if self.end == self.last else np.clip((self.end - t) / (self.end - self.last), 0.0, 1.0)
        return np.where(frequency < 0.5 * rate, fades * frequency * deflection * np.imag(rung), 0.0)


def voices(frames: Sequence[ModesAt]) -> Iterator[Voice]:
    """Each mode of frames in order, from where it comes to where it goes."""
    times = [frame.t for frame in frames]
    for mode in sorted({int(id_) for frame in frames for id_ in frame.ids}):
        ranks = [next(iter(np.flatnonzero(frame.ids == mode)), None) for frame in frames]
        for first, after in _runs([rank is not None for rank in ranks]):
            numbers = np.array(
                [
                    (frame.t, frame.frequencies[rank], frame.deflections[rank], frame.damping[rank])
                    for frame, rank in zip(frames[first:after], ranks[first:after])
                ]
            )
            end = times[min(after, len(times) - 1)]
            if len(numbers) == 1:
                # In one frame alone: it keeps its frequency until the next.
                numbers = np.concatenate([numbers, numbers])
                numbers[1, 0] = end if end > times[first] else times[first] + 1.0 / RATE
            t, frequency, deflection, damping = numbers.T
            yield Voice(Glide(t, frequency, damping), deflection, times[first], times[after - 1], end)


def _runs(there: Sequence[bool]) -> Iterator[tuple[int, int]]:
    """Indices of the first of each row of trues, and of what comes after it."""
    first = None
    for k, one in enumerate([*there, False]):
        if one and first is None:
            first = k
        elif not one and first is not None:
            yield first, k
            first = None


def _sample_times(times: np.ndarray, rate: int) -> np.ndarray:
    """The times (n,) [s] of samples from the first frame to the last, which has none of its own."""
    return times[0] + np.arange(round((times[-1] - times[0]) * rate)) / rate
