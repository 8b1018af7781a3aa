"""Motions of oscillators on ground whose acceleration is linear between samples, and the spectrum of their peaks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

STEPS_A_PERIOD = 24
"""Least steps in a period of an oscillator: between two of them its motion is taken for a cubic."""
FREE_PERIODS = 20
"""Of the slowest oscillator: for so long sums of motions are followed after a record, where they might grow."""
STEPS_AT_ONCE = 240
"""Of free motion."""
NEWTON_STEPS = 3
"""To where the cubic turns, from where its velocity would if it were linear."""


@dataclass(frozen=True, eq=False)
class ResponseSpectrum:
    """Largest motions of oscillators on moving ground.

    Args:
        frequencies: (m,) of the oscillators without damping [Hz].
        damping: (m,) shares of critical damping.
        displacement: (m,) largest displacement relative to the ground [m].
    """

    frequencies: np.ndarray
    damping: np.ndarray
    displacement: np.ndarray

    @property
    def periods(self) -> np.ndarray:
        """Periods (m,) [s]."""
        return 1.0 / self.frequencies

    @property
    def pseudo_velocity(self) -> np.ndarray:
        """w S_d (m,) [m/s]."""
        return 2.0 * np.pi * self.frequencies * self.displacement

    @property
    def pseudo_acceleration(self) -> np.ndarray:
        """w^2 S_d (m,) [m/s^2]: without damping the largest acceleration in space."""
        return (2.0 * np.pi * self.frequencies) ** 2 * self.displacement


def response_spectrum(
    times: np.ndarray, accelerations: np.ndarray, frequencies: np.ndarray, damping: float | np.ndarray
) -> ResponseSpectrum:
    """The spectrum of a record: peaks during it, those between its samples too, and those after its end.

    u'' + 2 z w u' + w^2 u = -a(t) from rest, exact for accelerations that are linear between samples.

    Args:
        times: (n,) rising [s].
        accelerations: (n,) of the ground [m/s^2]; 0 before and after.
        frequencies: (m,) [Hz], positive.
        damping: share of critical damping, one or (m,), at least 0 and below 1.

    Raises:
        ValueError: the numbers are not of this kind.

    Source: N. C. Nigam and P. C. Jennings, Bull. Seism. Soc. Am. 59 (1969) 909.
    """
    nothing = np.zeros((np.size(frequencies), 0))
    return spectrum_and_sums(times, accelerations, frequencies, damping, nothing)[0]


def spectrum_and_sums(
    times: np.ndarray,
    accelerations: np.ndarray,
    frequencies: np.ndarray,
    damping: float | np.ndarray,
    factors: np.ndarray,
) -> tuple[ResponseSpectrum, np.ndarray]:
    """The spectrum of a record, and the largest sizes (q,) [m] of sums of the same oscillators' displacements.

    Both hold during the record, between its samples, and after its end. Sums that end up above what they were before
    are followed for some `FREE_PERIODS` periods of the slowest oscillator after it.

    Args:
        times, accelerations, frequencies, damping: as of `response_spectrum`.
        factors: (m, q) of each oscillator in each sum.

    Raises:
        ValueError: the numbers are not of this kind.
    """
    omega, ratio = _oscillators(frequencies, damping)
    t, a = _subdivided(times, accelerations, 2.0 * np.pi / (STEPS_A_PERIOD * omega.max()))
    motion = _motion(t, a, omega, ratio)
    before, u, v = next(motion)
    looked, rates = _with_sums(u, factors), _with_sums(v, factors)
    peak = np.zeros(len(looked))
    for time, u, v in motion:
        next_looked, next_rates = _with_sums(u, factors), _with_sums(v, factors)
        peak = np.maximum(peak, _turn(looked, rates, next_looked, next_rates, time - before))
        peak = np.maximum(peak, np.abs(next_looked))
        before, looked, rates = time, next_looked, next_rates
    single, sums = peak[: len(omega)], peak[len(omega) :]
    single = np.maximum(single, _free_peak(u, v, omega, ratio))
    return ResponseSpectrum(omega / (2.0 * np.pi), ratio, single), _free_sums(u, v, omega, ratio, factors, sums)


def _oscillators(frequencies: np.ndarray, damping: float | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angular frequencies (m,) [rad/s] and damping (m,), if they make sense."""
    omega = 2.0 * np.pi * np.atleast_1d(np.asarray(frequencies, dtype=float))
    ratio = np.broadcast_to(np.asarray(damping, dtype=float), omega.shape)
    if not (len(omega) and np.all((omega > 0.0) & np.isfinite(omega)) and np.all((ratio >= 0.0) & (ratio < 1.0))):
        raise ValueError("frequencies are positive, and damping is at least 0 and below 1")
    return omega, ratio


def _subdivided(times: np.ndarray, accelerations: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """The same record with more samples, none farther from the next than a step [s]."""
    parts = np.maximum(1, np.ceil(np.diff(times) / step * (1.0 - 1e-12)).astype(int))
    begins = np.repeat(np.arange(len(parts)), parts)
    share = (np.arange(len(begins)) - np.repeat(np.cumsum(parts) - parts, parts)) / parts[begins]
    fine = np.append(times[begins] + share * np.diff(times)[begins], times[-1])
    return fine, np.interp(fine, times, accelerations)


def _with_sums(values: np.ndarray, factors: np.ndarray) -> np.ndarray:
    """Values (m,) of oscillators, followed by their sums (q,)."""
    return np.concatenate([values, values @ factors])


def _motion(
    times: np.ndarray, accelerations: np.ndarray, omega: np.ndarray, ratio: np.ndarray
) -> Iterator[tuple[float, np.ndarray, np.ndarray]]:
    """Each time with displacements (m,) and velocities (m,) there, from rest at the first one.

    Over a step (u, v) and the ground's acceleration with its change obey a linear equation: its exponential is exact.
    """
    state = np.zeros((len(omega), 4))
    yield float(times[0]), state[:, 0].copy(), state[:, 1].copy()
    transitions: dict[float, np.ndarray] = {}
    for begin, end, first, last in zip(times, times[1:], accelerations, accelerations[1:]):
        # Steps that are the same but for rounding share one exponential.
        step = float(f"{end - begin:.9e}")
        if step not in transitions:
            transitions[step] = _transition(step, omega, ratio)
        state[:, 2], state[:, 3] = first, last - first
        state[:, :2] = np.einsum("mij,mj->mi", transitions[step], state)
        yield float(end), state[:, 0].copy(), state[:, 1].copy()


def _transition(step: float, omega: np.ndarray, ratio: np.ndarray) -> np.ndarray:
    """What a step makes (m, 2, 4) of u, v, the acceleration at its begin, and its change over the step."""
    rates = np.zeros((len(omega), 4, 4))
    rates[:, 0, 1] = 1.0
    rates[:, 1, 0], rates[:, 1, 1], rates[:, 1, 2] = -(omega**2), -2.0 * ratio * omega, -1.0
    rates[:, 2, 3] = 1.0 / step
    return np.asarray(expm(step * rates)[:, :2])


def _turn(u: np.ndarray, v: np.ndarray, next_u: np.ndarray, next_v: np.ndarray, step: float) -> np.ndarray:
    """The largest |u| where velocities change their sign within a step, 0 where they do not; of any shape."""
    turns = v * next_v < 0.0
    if not turns.any():
        return np.zeros_like(u)
    v, next_v, u, next_u = v[turns], next_v[turns], u[turns], next_u[turns]
    slope = (next_u - u) / step
    square, linear = 3.0 * (v + next_v - 2.0 * slope), 6.0 * slope - 4.0 * v - 2.0 * next_v
    s = v / (v - next_v)
    for _ in range(NEWTON_STEPS):
        rate = linear + 2.0 * square * s
        s = np.clip(s - np.divide(v + s * (linear + s * square), rate, out=np.zeros_like(s), where=rate != 0.0), 0, 1)
    found = np.zeros(turns.shape)
    found[turns] = np.abs(u + step * s * (v + s * (linear / 2.0 + s * square / 3.0)))
    return found


def _free_peak(u: np.ndarray, v: np.ndarray, omega: np.ndarray, ratio: np.ndarray) -> np.ndarray:
    """The largest |u| (m,) of the free motions that begin at u, v, when they first come to rest."""
    damped = omega * np.sqrt(1.0 - ratio**2)
    sine = (v + ratio * omega * u) / damped
    size, angle = np.hypot(u, sine), np.arctan2(sine, u)
    # u = size exp(-z w t) cos(w_d t - angle), which rests where tan(w_d t - angle) = -z w / w_d.
    phase = np.mod(angle - np.arcsin(ratio), np.pi)
    return size * np.exp(-ratio * omega * phase / damped) * np.abs(np.cos(phase - angle))


def _free_sums(
    u: np.ndarray, v: np.ndarray, omega: np.ndarray, ratio: np.ndarray, factors: np.ndarray, known: np.ndarray
) -> np.ndarray:
    """The largest sizes (q,) of sums of the free motions that begin at u, v; at least those known (q,).

    Each motion is the real part of c exp((-z w + i w_d) t), of which |c| exp(-z w t) is a bound.
    """
    damped = omega * np.sqrt(1.0 - ratio**2)
    rate, motion = -ratio * omega + 1j * damped, u - 1j * (v + ratio * omega * u) / damped
    step = 2.0 * np.pi / (STEPS_A_PERIOD * omega.max())
    within = np.exp(rate * step * np.arange(STEPS_AT_ONCE + 1)[:, None])
    for _ in range(int(np.ceil(FREE_PERIODS * 2.0 * np.pi / (omega.min() * step * STEPS_AT_ONCE)))):
        if np.all(np.abs(motion) @ np.abs(factors) <= known):
            break
        moved = within * motion
        looked, rates = moved.real @ factors, (rate * moved).real @ factors
        turns = _turn(looked[:-1], rates[:-1], looked[1:], rates[1:], step)
        known = np.maximum(known, np.maximum(turns, np.abs(looked[1:])).max(axis=0))
        motion = moved[-1]
    return known
