"""How well an outline determines numbers: intervals from the Jacobian and the misfit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from restshape_apps.couture.fitting.fit import Step
from restshape_apps.couture.fitting.outline_distance import MEASURED

LEVEL = 0.95
LOOSE = np.log(10.0)
"""Half width of an interval beyond which the outline does not determine a number."""
SINGULAR = 1e-4
"""Least over largest singular value of scaled derivatives below which it does not separate numbers."""


@dataclass(frozen=True, eq=False)
class Confidence:
    """Intervals of numbers.

    Args:
        low, high: (k,) ends of the intervals [SI].
        independent: number of independent places on the outline.
        correlation: the largest between two of the numbers; 0 of one.
        loose: (k,) whether the outline does not determine it.
    """

    low: np.ndarray
    high: np.ndarray
    independent: float
    correlation: float
    loose: np.ndarray


def confidence(step: Step, J: np.ndarray, points: int) -> Confidence:
    """Intervals (95 %) of the numbers of a step, linearised at it.

    sigma^2 (J^T J)^-1 with the misfit as sigma. Neighbours along the outline are off alike where drape and model
    differ: the number of independent places is theirs over the correlation length of the distances.

    Args:
        step: the best; J: as of `Fit`; points: of the measured outline.

    Source: G. A. F. Seber, C. J. Wild, Nonlinear regression, 1989, chapters 2 and 6.
    """
    from scipy.special import stdtrit

    values, count = step.drape.values, J.shape[1]
    independent = min(points, MEASURED / correlation_length(step.distances.values[:MEASURED]))
    freedom = max(independent - count - 3.0, 1.0)
    sizes = np.linalg.norm(J, axis=0)
    scaled = J / sizes
    singular = np.linalg.svd(scaled, compute_uv=False)
    apart = singular[-1] > SINGULAR * singular[0]
    inverse = np.linalg.pinv(scaled.T @ scaled)
    spread = step.misfit * np.sqrt(np.diag(inverse) / freedom) / sizes
    half = float(stdtrit(freedom, 0.5 + 0.5 * LEVEL)) * spread if apart else np.full(count, np.inf)
    with np.errstate(over="ignore"):
        ends = np.sort(np.stack([values * np.exp(-half), values * np.exp(half)]), axis=0)
    root = np.sqrt(np.diag(inverse))
    correlations = inverse / np.outer(root, root) - np.eye(count)
    return Confidence(*ends, independent, float(np.abs(correlations).max()), half > LOOSE)


def correlation_length(values: np.ndarray) -> float:
    """1 and twice the sum of the correlations of neighbours around a circle (m,), until they end."""
    centred = values - values.mean()
    power = np.abs(np.fft.rfft(centred)) ** 2
    found = np.fft.irfft(power, len(values))[: len(values) // 2]
    if found[0] <= 0.0:
        return 1.0
    found = found[1:] / found[0]
    ends = np.flatnonzero(found < 0.05)
    return float(1.0 + 2.0 * found[: ends[0] if len(ends) else len(found)].sum())
