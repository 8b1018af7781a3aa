"""What a replay has spent on linear solves: counts of PETSc's events, by the prices of the calibration."""

from collections.abc import Mapping

from restshape.algebra.linear import LinearSolver

SYMBOLIC = ("MatCholFctrSym", "MatICCFactorSym", "MatLUFactorSym", "MatILUFactorSym")
NUMERIC = ("MatCholFctrNum", "MatLUFactorNum")
"""Events of factors: analyses of their patterns, and their numbers. (PETSc logs numbers of ICC and ILU as these.)"""
EVENTS = (*SYMBOLIC, *NUMERIC, "PCApply", "MatMult")
"""All that is counted."""


def counted_seconds(events: Mapping[str, int], iterations: int, solver: LinearSolver) -> float:
    """Seconds by the calibration of what was counted while a solver had the preconditioner that it has.

    Args:
        events: counts of `EVENTS`.
        iterations: of the Krylov method, for their work on vectors.
        solver: has made a preconditioner.
    """
    if not solver.kept.ready:
        return 0.0
    price = solver.kept.price()
    factors = sum(events[name] for name in NUMERIC) * price.refresh
    analyses = sum(events[name] for name in SYMBOLIC) * (price.setup - price.refresh)
    passes = events["MatMult"] * price.product + iterations * price.vectors
    # Preconditioners of parts, or of grids, apply those of the parts, which are events of their own.
    each = 2 if solver.ksp.getType() == "bcgs" else 1
    applied = each * iterations if solver.kept.nested else events["PCApply"]
    return factors + analyses + applied * price.apply + passes
