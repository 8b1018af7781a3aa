"""What the analyses of solids of large deformation share, at rest and in motion."""

import numpy as np

from restshape.algebra.linear import LinearSolver
from restshape.algebra.newton import Newton
from restshape.analysis.steady import ROUND_OFF, StaticAnalysis
from restshape.analysis.transient import TransientAnalysis
from restshape.physics.elasticity.plane_solid import PlaneSolid
from restshape.scene.model import Scene

COLD = 1e-4
"""A cold solve's tolerance over the scene's."""


def tangent_solver(analysis: StaticAnalysis | TransientAnalysis, prefix: str, scene: Scene) -> LinearSolver:
    """The solver for the steps of Newton's method, which outlives all frames.

    Args:
        analysis: its policy says what is reused, its plan whether the tangent is symmetric.
        prefix: of the solver's options in PETSc's database.
        scene: the tolerance.
    """
    return LinearSolver(
        analysis.comm,
        prefix,
        analysis.policy.solver,
        scene.solve.tolerance,
        analysis.calibration,
        analysis.stages,
        memory=scene.solve.factor_memory,
        symmetric=analysis.plan.solver.symmetric,
    )


def rounding(physics: PlaneSolid) -> float:
    """Forces [N] a metre of displacement below which a residual that steps do not lower any more is rounding."""
    return ROUND_OFF * physics.stiffest


def least_scale(physics: PlaneSolid, x: np.ndarray, tolerance: float) -> float:
    """Forces [N] that a residual at x (n, 2) [m] is measured against at least.

    0, but where supports move a body: it may bear no load, and what it bears may be rounding.
    """
    return rounding(physics) / tolerance * float(np.abs(x).max(initial=0.0)) if physics.displaced else 0.0


def inversion(physics: PlaneSolid, cells: np.ndarray) -> str:
    """What is wrong with a displacement that inverts these cells (k,); nothing where there are none."""
    if not len(cells):
        return ""
    x, y = physics.mesh.X[physics.mesh.cells[cells[0]]].mean(axis=0)
    where = f"{len(cells)} triangles turn inside out, one at ({x:.4g}, {y:.4g}) m"
    return f"{where} (St. Venant and Kirchhoff's law softens without bound in compression)"


def vanishing(physics: PlaneSolid, x: np.ndarray) -> str:
    """What is wrong with a displacement x (n, 2) [m] that stretches a sheet until the law leaves it no thickness."""
    cells = physics.vanished_cells(x)
    if not len(cells):
        return ""
    x0, y0 = physics.mesh.X[physics.mesh.cells[cells[0]]].mean(axis=0)
    where = f"{len(cells)} triangles are stretched to no thickness, one at ({x0:.4g}, {y0:.4g}) m"
    return f"{where} (St. Venant and Kirchhoff's law in plane stress holds for small strains)"


def rounding_note(left_over: float, tolerance: float) -> dict[str, str]:
    """What a frame's row tells besides where rounding leaves more of the load, or of the forces, than the tolerance."""
    return {"note": f"a tolerance of {tolerance:g} is out of reach of rounding"} if left_over > tolerance else {}


def free(made: list[Newton], kept: Newton | None) -> None:
    """Free all of a list but the one that is kept.

    A SNES and the functions that it calls hold each other: it goes when it is told to.
    """
    for newton in made:
        if newton is not kept:
            newton.destroy()
    made[:] = [kept] if kept else []
