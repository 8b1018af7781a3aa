"""Steady motions of a shape on ground that moves at one frequency, over many frequencies."""

from dataclasses import dataclass, replace

import numpy as np
from restshape_apps.vibration.stage import Structure

from restshape.analysis.modal.base_modes import BaseModes
from restshape.analysis.motion.harmonic import harmonic_response
from restshape.analysis.motion.modes_beside import present_modes

NEAR_RESONANCE = (-8.0, -4.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 4.0, 8.0)
"""Points about a resonance, in halves of its half-power bandwidth 2 z f: within it, and down to 1/8 of the peak."""
MOST_MODES = 64
"""So many modes at most have points of their own; the summit of a sweep is looked for in any case."""
APPROACHES = 3
"""Steps towards a summit: the first one is exact for one mode, the rest for modes that overlap."""


@dataclass(frozen=True, eq=False)
class Sweep:
    """Steady motions over frequencies.

    Args:
        frequencies: (m,) [Hz].
        acceleration: amplitude A of the ground [m/s^2].
        relative: complex amplitudes (m,) [m] by quantity, relative to the ground.
        transmissibility: (m,) by quantity: the amplitude in space over that of the ground.
        resolved: resonances up to this frequency [Hz] have points of their own; infinite where all of the range have.
    """

    frequencies: np.ndarray
    acceleration: float
    relative: dict[str, np.ndarray]
    transmissibility: dict[str, np.ndarray]
    resolved: float = np.inf


def sweep(shape: Structure, frequencies: np.ndarray, acceleration: float = 1.0) -> Sweep:
    """The steady motions of a shape.

    Args:
        shape: with the scene's damping.
        frequencies: (m,) positive [Hz].
        acceleration: amplitude of the ground [m/s^2].
    """
    stiffness, mass, damping = shape.analysis.matrices()
    load = -acceleration * shape.inertia()
    found = []
    for frequency in frequencies:
        omega = 2.0 * np.pi * frequency
        found.append(shape.looked(harmonic_response(stiffness, mass, damping, omega, load)))
    relative = {name: np.array([one[name] for one in found]) for name in shape.looks}
    ratios = shape.transmissibility(relative, frequencies, acceleration)
    return Sweep(np.asarray(frequencies), acceleration, relative, ratios)


def resonant_frequencies(shape: Structure, low: float, high: float, points: int) -> tuple[np.ndarray, float]:
    """Frequencies (m,) [Hz] from low to high: evenly spaced ones, and some within the bandwidth of each resonance.

    The second value is `Sweep.resolved`: that of the last of `MOST_MODES` modes where the range has more.

    A mode of frequency f and damping z resonates at f sqrt(1 - 2 z^2). One that is not damped has no finite amplitude
    there, one of z > 1/sqrt(2) no peak: neither has points of its own.

    Args:
        shape: with the scene's damping.
        low, high: positive [Hz].
        points: how many are evenly spaced, with low and high among them.
    """
    count = 8
    modes = present_modes(shape.analysis, count)
    while modes.frequencies[-1] < high and len(modes.omega) == count < MOST_MODES:
        count *= 2
        modes = present_modes(shape.analysis, count)
    beyond = len(modes.omega) == count and modes.frequencies[-1] < high
    frequencies = np.union1d(np.linspace(low, high, points), points_at_resonances(shape, modes, low, high))
    return frequencies, float(modes.frequencies[-1]) if beyond else np.inf


def points_at_resonances(shape: Structure, modes: BaseModes, low: float, high: float) -> np.ndarray:
    """The points (m,) [Hz] about the resonances of modes between two frequencies; see `resonant_frequencies`."""
    damping = modes.damping(shape.analysis.state.integration.damping)
    peaked = (damping > 0.0) & (damping < np.sqrt(0.5))
    f, z = modes.frequencies[peaked, None], damping[peaked, None]
    near = (f * np.sqrt(1.0 - 2.0 * z**2) + z * f * np.array(NEAR_RESONANCE)).ravel()
    return near[(near > low) & (near < high)]


def modal_sweep(
    shape: Structure, modes: BaseModes, low: float, high: float, points: int, acceleration: float = 1.0
) -> Sweep:
    """The steady motions of a shape by its lowest modes alone, without a solve.

    What higher modes add far below their resonances is left out: it is less than near the resonances of these.

    Args:
        shape: with the scene's damping; modes: of it.
        low, high: of the range [Hz], not negative; points: how many are evenly spaced, besides those at resonances; of
            a shape without damping there is none at a mode.
        acceleration: amplitude of the ground [m/s^2].
    """
    even = np.linspace(low, high, points + 1)[1:] if low == 0.0 else np.linspace(low, high, points)
    frequencies = np.union1d(even, points_at_resonances(shape, modes, low, high))
    if not shape.damped:
        # There it is infinite.
        frequencies = np.setdiff1d(frequencies, modes.frequencies)
    omega = 2.0 * np.pi * frequencies[:, None]
    twice = 2.0 * modes.damping(shape.analysis.state.integration.damping) * modes.omega
    answers = -acceleration * modes.participation / (modes.omega**2 - omega**2 + 1j * twice * omega)
    looked = [shape.looked(modes.shapes[:, k]) for k in range(len(modes.omega))]
    relative = {name: answers @ np.array([one[name].real for one in looked]) for name in shape.looks}
    return Sweep(frequencies, acceleration, relative, shape.transmissibility(relative, frequencies, acceleration))


def resonant_sweep(shape: Structure, low: float, high: float, points: int, acceleration: float = 1.0) -> Sweep:
    """The steady motions of a shape from low to high, with points at resonances and at the summit of each quantity.

    Args:
        shape, low, high, points: as of `resonant_frequencies`.
        acceleration: amplitude of the ground [m/s^2].
    """
    frequencies, resolved = resonant_frequencies(shape, low, high, points)
    found = sweep(shape, frequencies, acceleration)
    if shape.damped:
        for _ in range(APPROACHES):
            summits = {summit(found.frequencies, np.abs(values)) for values in found.relative.values()}
            new = np.setdiff1d(list(summits), found.frequencies)
            if len(new):
                found = joined(found, sweep(shape, new, acceleration))
    return replace(found, resolved=resolved)


def summit(frequencies: np.ndarray, amplitudes: np.ndarray) -> float:
    """The frequency [Hz] where an amplitude is largest, from its three points there.

    1 / |U|^2 of one mode is a parabola in the square of the frequency: its lowest point is exact.

    Args:
        frequencies: (m,) ascending [Hz].
        amplitudes: (m,) [m]; where the first or last is the largest, it is the summit.
    """
    k = int(np.argmax(amplitudes))
    if not 0 < k < len(frequencies) - 1:
        return float(frequencies[k])
    near = slice(k - 1, k + 2)
    squares = (frequencies[near] / frequencies[k]) ** 2 - 1.0
    (left, _, right), (down, _, up) = squares, (amplitudes[k] / amplitudes[near]) ** 2 - 1.0
    # Through (0, 0): y = a x^2 + b x, with a > 0 as both neighbours are above.
    a = (up / right - down / left) / (right - left)
    b = up / right - a * right
    lowest = -0.5 * b / a if a > 0.0 else 0.0
    return float(frequencies[k] * np.sqrt(1.0 + np.clip(lowest, left, right)))


def joined(one: Sweep, other: Sweep) -> Sweep:
    """Two sweeps under the same acceleration as one, by ascending frequency."""
    order = np.argsort(np.concatenate((one.frequencies, other.frequencies)), kind="stable")

    def both(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.concatenate((a, b))[order]

    relative = {name: both(values, other.relative[name]) for name, values in one.relative.items()}
    ratios = {name: both(values, other.transmissibility[name]) for name, values in one.transmissibility.items()}
    return Sweep(both(one.frequencies, other.frequencies), one.acceleration, relative, ratios)
