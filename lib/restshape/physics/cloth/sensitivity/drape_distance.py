"""About how far predicted cloth is from its drape: two steps of Newton's method, and what more of them would add."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from petsc4py import PETSc

from restshape.analysis.correction import KeptOperation, RowOperation, conjugate_steps
from restshape.physics.cloth.relaxation.equilibrium import EquilibriumSolver

Accuracy = tuple[int, float]
"""Steps of conjugate gradients that together gain less than a share of the squared energy at the end, and the share."""
USUAL: Accuracy = (2, 1e-2)
"""The distance is known to about a tenth."""
MOST = 0.75
"""Of a step beside the one before: steps that shrink less are taken to shrink so."""


def stabilised_step(
    solver: EquilibriumSolver,
    x: np.ndarray,
    tensions: np.ndarray | None,
    accuracy: Accuracy,
    on_step: Callable[[], None] = lambda: None,
) -> np.ndarray:
    """A Newton step (n, 3) from x (n, 3), by conjugate gradients on the kept factor.

    Args:
        solver: of the cloth.
        x: unknowns, prescribed ones as they are given.
        tensions: (ne, 3) of the tangent [N/m]; None: those there.
        accuracy: of conjugate gradients.
        on_step: called where the factor is applied.
    """
    equations, rest = solver.equations, np.empty_like(x)
    solver.problem.residual(x, rest)
    matrix: PETSc.Mat = equations.mixed_tangent(x, tensions, True)
    kept = KeptOperation(solver.linear, equations.rows)

    def precondition(r: np.ndarray) -> np.ndarray:
        on_step()
        return kept(r)

    product = RowOperation(matrix.mult, equations.rows, solver.comm)
    delay, enough = accuracy
    return conjugate_steps(product, precondition, -rest.ravel(), delay=delay, enough=enough).reshape(x.shape)


def missing_way(
    solver: EquilibriumSolver, x: np.ndarray, tensions: np.ndarray, accuracy: tuple[Accuracy, Accuracy]
) -> np.ndarray:
    """About what predicted unknowns x (n, 3) lack to be the drape (n, 3).

    Cloth that a linear map has turned is stretched, and the tension of that would make the tangent much too stiff:
    steps have the tension of the last drape. Each of them shrinks by about the same share, by which two tell the sum of
    all.

    Args:
        tensions: (ne, 3) of the last drape [N/m].
        accuracy: of the first and of the second step; others as of `stabilised_step`.

    Source: docs/theory/design-derivative.md.
    """
    first = stabilised_step(solver, x, tensions, accuracy[0])
    size = float(np.linalg.norm(first))
    if not (np.isfinite(size) and size):
        return first
    both = first + stabilised_step(solver, x + first, tensions, accuracy[1])
    whole = float(np.linalg.norm(both))
    if not np.isfinite(whole):
        return first
    shrinks = min(max(whole / size - 1.0, 0.0), MOST)
    return both * (size / (1.0 - shrinks) / whole) if whole else first
