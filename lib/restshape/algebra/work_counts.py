"""What an analysis has spent since it began, in seconds of the calibration: counted work, never a clock."""

from __future__ import annotations

from typing import TYPE_CHECKING

from restshape.algebra.reuse.prices import ROW

if TYPE_CHECKING:
    from restshape.algebra.eigenproblems.pencil import Pencil
    from restshape.algebra.linear import LinearSolver
    from restshape.calibration import Calibration


def pass_seconds(nonzeros: float, known: Calibration) -> float:
    """Seconds of one pass over all elements whose matrix has so many nonzeros, by those of first-order triangles."""
    return known.element * nonzeros / ROW


def linear_counts(solver: LinearSolver) -> tuple[int, ...]:
    """Matrices, iterations and factors of a linear solver so far."""
    counts = solver.counts
    return counts.matrices, counts.iterations, counts.factors


def linear_seconds(solver: LinearSolver, before: tuple[int, ...], known: Calibration) -> float:
    """Seconds of the solves since there were these `linear_counts`, at the present prices; 0 without a factor."""
    if not solver.kept.ready:
        return 0.0
    price, size = solver.kept.price(), solver.kept.size
    matrices, iterations, factors = (now - then for now, then in zip(linear_counts(solver), before))
    return matrices * pass_seconds(size.nonzeros, known) + iterations * price.iteration + factors * price.refresh


def pencil_counts(pencil: Pencil) -> tuple[int, ...]:
    """Factors and substitutions of a pencil so far."""
    return pencil.factorisations, pencil.substitutions


def pencil_seconds(pencil: Pencil, before: tuple[int, ...], known: Calibration) -> float:
    """Seconds of the work since there were these `pencil_counts`, at the present prices; 0 without a factor."""
    if not pencil.ready:
        return 0.0
    factors, substitutions = (now - then for now, then in zip(pencil_counts(pencil), before))
    work = (pencil.size, pencil.entries, pencil.nonzeros or 3.0 * pencil.entries)
    return factors * known.refresh_seconds(*work) + substitutions * known.iteration_seconds(*work)
