"""A frame's system beside that of a cold solve."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from restshape.algebra.factors.gathering import GatheredSystem, matrix_difference
from restshape.analysis.analysis import Comparison

if TYPE_CHECKING:
    import scipy.sparse as sp


def compared(warm: GatheredSystem, cold: GatheredSystem, definite: bool = True, least: float = 0.0) -> Comparison:
    """How far a system is from a cold one: entries relative to the largest, solutions in the energy norm.

    Args:
        definite: matrices are positive definite; those that are not give no norm, and solutions are compared by the
            largest difference over the largest unknown.
        least: of the free part's energy norm, below which the norm of the whole is rounding: that counts instead.
    """
    entries = matrix_difference(warm.matrix, cold.matrix)
    if not definite:
        largest = float(np.abs(cold.solution).max(initial=0.0))
        difference = float(np.abs(warm.solution - cold.solution).max(initial=0.0))
        return Comparison(entries, difference / largest if largest else difference)
    return Comparison(entries, energy_distance(cold.matrix, warm.solution, cold.solution, warm.energy, least))


def compared_by_fields(warm: GatheredSystem, cold: GatheredSystem, fields: Sequence[tuple[int, float]]) -> Comparison:
    """How far a system is from a cold one: entries as in `compared`, solutions by the worst of its fields.

    Args:
        fields: of each in order its columns, and a difference of its values that is not small. The largest one counts
            over that, or over the range of its values: temperatures in kelvins would hide velocities.
    """
    worst, start, width = 0.0, 0, sum(columns for columns, _ in fields)
    for columns, size in fields:
        mine, other = (one.solution.reshape(-1, width)[:, start : start + columns] for one in (warm, cold))
        start += columns
        worst = max(worst, float(np.abs(mine - other).max()) / max(float(np.ptp(other)), size))
    return Comparison(matrix_difference(warm.matrix, cold.matrix), worst)


def energy_distance(
    matrix: sp.csr_matrix, x: np.ndarray, reference: np.ndarray, energy: float | None = None, least: float = 0.0
) -> float:
    """The energy norm of x - reference over that of reference, or over that of unknowns with a known energy.

    Of these over `least` times the norm of reference at least: prescribed values that are the same everywhere leave
    an energy of rounding alone.
    """

    def norm(v: np.ndarray) -> float:
        return float(np.sqrt(max(0.0, v @ (matrix @ v))))

    size = norm(reference)
    scale = size if energy is None else max(float(np.sqrt(2.0 * max(0.0, energy))), least * size)
    return norm(x - reference) / scale if scale else norm(x - reference)
