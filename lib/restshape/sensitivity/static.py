"""The design derivative of an answer at rest: how its displacement follows the hand."""

from typing import Protocol

import numpy as np

from restshape.errors import ReplayProblem
from restshape.physics.elasticity.design import design_force
from restshape.physics.elasticity.plane_solid import PlaneSolid

SLACK = 100.0
"""A derivative whose true residual is so many times what was asked for has been spoilt by rounding."""


class Statics(Protocol):
    """What a derivative needs of an analysis that has just been solved.

    Attributes:
        physics: the solid on its mesh.
        x: (n, 2) displacement [m].
    """

    physics: PlaneSolid
    x: np.ndarray

    def linear_solve(self, rhs: np.ndarray, tolerance: float) -> np.ndarray:
        """s (n, 2) with (dR/dx) s = rhs (n, 2) at free unknowns, 0 at held ones, by the kept preconditioner."""


def design_derivative(analysis: Statics, Psi: np.ndarray, tolerance: float) -> np.ndarray:
    """Derivatives s (2, n, 2) of the displacement along the two directions of the hand.

    (dR/dx) s_i = -(dR/dX) Psi_i, with the tangent of the answer and whatever factor there is.

    Args:
        analysis: solved on the mesh as it lies.
        Psi: (2, n, 2) node displacements a unit of each of the hand's coefficients.
        tolerance: of each solve, relative to its right side.

    Raises:
        ReplayProblem: the tangent is singular, or so nearly that rounding decides, or a value has no derivative.

    Source: docs/theory.md, "The design derivative"; (5.10) to (5.15) of the thesis.
    """
    s = np.zeros_like(Psi)
    for direction, motion in zip(s, Psi):
        if np.any(motion):
            force, held = design_force(analysis.physics, analysis.x, motion)
            direction[...] = _response(analysis, force, tolerance) + held
    return s


def _response(analysis: Statics, force: np.ndarray, tolerance: float) -> np.ndarray:
    """The displacement rates (n, 2) at free unknowns that make up for rates of forces (n, 2) [N]."""
    physics = analysis.physics
    rhs = -force
    rhs.ravel()[physics.constrained] = 0.0
    s = analysis.linear_solve(rhs, tolerance)
    left = tangent_product(physics, analysis.x, s) - rhs
    left.ravel()[physics.constrained] = 0.0
    error, scale = float(np.linalg.norm(left)), float(np.linalg.norm(rhs))
    if not error <= SLACK * tolerance * scale:
        raise ReplayProblem(
            "the tangent is nearly singular: no derivative with respect to the design "
            f"(its residual is {error / scale:.1e} of the right side)"
        )
    return s


def tangent_product(physics: PlaneSolid, x: np.ndarray, s: np.ndarray) -> np.ndarray:
    """The rates (n, 2) [N] of the forces on nodes when the displacement x (n, 2) [m] changes with s (n, 2)."""
    mesh, out = physics.mesh, np.zeros_like(x)
    still = np.zeros_like(mesh.X)
    physics.element.design(mesh.X, still, x, mesh.cells, physics.params, out, dx=s)
    for load in physics.followers:
        physics.pressure.design(mesh.X, still, x, load.facets, load.pressure_params, out, dx=s)
    return out
