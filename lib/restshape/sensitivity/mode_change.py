"""How a mode of K phi = lambda M phi changes beyond the modes that are known."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from restshape.errors import ReplayProblem

if TYPE_CHECKING:
    from restshape.algebra.eigenproblems.pencil import Deflation, Pencil
    from restshape.arrays import Reals

RESTART, RESTARTS = 30, 4
"""Directions of one cycle of GMRES for the derivative of a mode, and cycles."""


class SolvedPencil(Protocol):
    """A solver of an eigenproblem, whose factor preconditions."""

    @property
    def pencil(self) -> Pencil: ...
    @property
    def deflation(self) -> Deflation: ...


def change_beyond(
    solver: SolvedPencil, modes: Reals, weighted: Reals, value: float, force: Reals, tolerance: float
) -> Reals:
    """The part v (n f,) of a mode's change that is orthogonal to the known modes, rigid motions in it included.

    Args:
        solver: of the eigenproblem.
        modes: (k, n f) the known ones; weighted: (k, n f) their products M phi; all vectors are whole on each rank.
        value: the mode's eigenvalue.
        force: (n f,) right side; what of it lies along the known modes is taken out.
        tolerance: of the residual, relative to the right side.

    Raises:
        ReplayProblem: the solve does not converge.
    """
    pencil, share = solver.pencil, solver.pencil.share
    rigid, rigid_weighted = share.whole(solver.deflation.rigid), share.whole(solver.deflation.weighted)

    def clean(v: Reals) -> Reals:
        row = v - (weighted @ v) @ modes
        return row - (rigid_weighted @ row) @ rigid if len(rigid) else row

    def clean_force(r: Reals) -> Reals:
        row = r - (modes @ r) @ weighted
        return row - (rigid @ row) @ rigid_weighted if len(rigid) else row

    def product(v: Reals) -> Reals:
        row, out = share.own(np.ascontiguousarray(clean(v))[None]), np.empty((2, share.count))
        pencil.apply(pencil.stiffness, row, out[:1])
        pencil.apply(pencil.mass, row, out[1:])
        return clean_force(share.whole((out[0] - value * out[1])[None])[0])

    def precondition(r: Reals) -> Reals:
        return clean(share.whole(pencil.solve(share.own(np.ascontiguousarray(clean_force(r))[None])))[0])

    right = clean_force(force)
    # In z the iteration is that of A P z = right: its residual is the true one.
    # Few frames ask for derivatives, and this takes 0.07 s to load.
    from scipy.sparse.linalg import LinearOperator, gmres

    system = LinearOperator(2 * (right.size,), matvec=lambda z: product(precondition(z)), dtype=right.dtype)
    z, failed = gmres(system, right, rtol=tolerance, atol=0.0, restart=RESTART, maxiter=RESTARTS)
    part = precondition(z)
    if failed:
        error, norm = np.linalg.norm(product(part) - right), np.linalg.norm(right)
        if not error <= 100.0 * tolerance * norm:
            raise ReplayProblem(f"no derivative of a mode: its residual is {error / norm:.1e} of the right side")
    # Along rigid motions the system is -lambda times the identity.
    return part - (rigid @ force / value) @ rigid if len(rigid) else part
