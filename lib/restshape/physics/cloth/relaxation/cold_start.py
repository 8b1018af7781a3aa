"""Cold starts of cloth, which falls from its initial placement with all of its stiffness."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from restshape.algebra.nonlinear.descent import MEMORY
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.relaxation.beginning import beginning
from restshape.physics.cloth.relaxation.close_seams import close_seams
from restshape.physics.cloth.relaxation.come_back import come_back
from restshape.physics.cloth.relaxation.equilibrium import NEAR, ROUGH, EquilibriumSolver
from restshape.physics.cloth.relaxation.finer_start import finer_places
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.relaxation.saddle_escape import SaddleEscape
from restshape.physics.cloth.scene import ClothArguments, cloth_problem
from restshape.physics.cloth.sheet.fabric import Fabric
from restshape.physics.cloth.sheet.parameters import HINGE_STIFFNESS

log = logging.getLogger("restshape.physics")

SOFT = (0.01, 0.05)
"""Parts of the membrane's stiffness with which cloth that is scattered gets rid of its crumples."""
SOFT_ROUNDS, STIFF_ROUNDS = 4, 30
"""Tangents of a descent with a soft membrane, and with all of its stiffness."""
FALLS, SHORT_ROUNDS = 4, 2
"""Falls, where a descent of few tangents leads from one onto a saddle, or off one, instead of to an equilibrium."""
FEWEST = 60
"""Nodes of a mesh that cloth may fall on: on fewer it finds no folds, and past a body no way back."""


class ColdStart:
    """Finds positions near an equilibrium from the initial placement.

    Cloth falls with all of its stiffness: no body is let by an opening that is smaller, and friction remembers nothing
    that the cloth could not have done. Only cloth that starts scattered at random, and touches nothing, is soft first.

    Args:
        solver: of the equilibria wanted.
        levels: nested meshes that it falls on at most, from coarse to fine.
        arguments: what a problem on one of the meshes is made from.
        make_solver: of a problem, and a prefix of options in PETSc's database.
        scattered: the nodes start at random places.

    Source: docs/theory/cloth.md.
    """

    def __init__(
        self,
        solver: EquilibriumSolver,
        levels: int,
        arguments: Callable[[Mesh], ClothArguments],
        make_solver: Callable[[ClothProblem, str], EquilibriumSolver],
        scattered: bool = False,
    ) -> None:
        self.solver, self.arguments, self.make_solver = solver, arguments, make_solver
        problem = solver.problem
        self.hierarchy = problem.mesh.hierarchy
        meshes = self.hierarchy.meshes if self.hierarchy else [problem.mesh]
        wanted = min(levels, sum(len(mesh.X) >= FEWEST for mesh in meshes) or 1)
        self.meshes, self.skipped = meshes[-wanted:], len(meshes) - wanted
        # Morley's triangles have four times as many unknowns as hinges.
        self.replaced = problem.morley is not None
        self.softened = scattered and problem.contact is None

    def find(self, most: int, report: ConvergenceReport) -> np.ndarray:
        """Positions (n, 3) near an equilibrium, in so many steps at most."""
        places = np.empty((0, 3))
        for level, mesh in enumerate(self.meshes):
            last = level == len(self.meshes) - 1
            solver = self.solver if last and not self.replaced else self._stand_in(mesh)
            log.info("Cold start: mesh of %d nodes", len(mesh.X))
            try:
                if level:
                    step = self.hierarchy.steps[self.skipped + level - 1]
                    x = solver.problem.flat(finer_places(solver.problem, step, places))
                    solver.problem.begin(x)
                else:
                    x = self._begun(solver, mesh, most, report)
                    close_seams(solver, x, most, report)
                if level == 0 and self.softened:
                    soften(solver, x, most, report)
                self._fall(solver, x, ROUGH, most, report)
                if not last:
                    solver.converge(x, most, report)
                places = solver.problem.corners(x)
            finally:
                if solver is not self.solver:
                    solver.destroy()
        return self.solver.problem.flat(places) if self.replaced else x

    def _begun(self, solver: EquilibriumSolver, mesh: Mesh, most: int, report: ConvergenceReport) -> np.ndarray:
        """Positions (n, 3) from which the cloth falls, outside of bodies, which may have come to it."""
        arguments = self.arguments(mesh)
        begun = beginning(solver.problem, arguments)
        solver.problem.begin(begun.x)
        if begun.retreat is not None:
            come_back(solver, begun.x, arguments.forms, begun.retreat, most, report)
        return begun.x

    def go_on(self, x: np.ndarray, most: int, report: ConvergenceReport) -> None:
        """Fall from positions x (n, 3), which are changed, such as those beside a saddle.

        It is the cloth itself that falls: where it has a saddle, hinges may have an equilibrium that is stable.
        """
        # Beside an unstable equilibrium forces are small, and grow at first.
        self._fall(self.solver, x, min(ROUGH, 0.1 * self.solver.residual_norm(x)), most, report)

    def _fall(
        self, solver: EquilibriumSolver, x: np.ndarray, goal: float, most: int, report: ConvergenceReport
    ) -> None:
        """Let cloth fall from x (n, 3), which is changed, off saddles of the energy too.

        The cloth that is wanted takes on the friction.
        """
        saddle = SaddleEscape(solver)
        for again in range(FALLS):
            solver.fall(x, goal, most, report)
            if report.falls:
                break
            if solver.descend(x, NEAR, min(most, SHORT_ROUNDS * MEMORY), report):
                if again == FALLS - 1 or saddle.is_stable(x) or not saddle.escape(x):
                    break
                log.info("Fall from a saddle along the lowest mode")
                # Beside it forces are small, and grow at first.
                goal = min(ROUGH, 0.1 * solver.residual_norm(x))
            elif report.residual <= ROUGH or again == FALLS - 1:
                solver.descend(x, NEAR, min(most, STIFF_ROUNDS * MEMORY), report)
                break
        if solver is not self.solver and solver.problem.mesh is self.solver.problem.mesh:
            hand_on_friction(solver.problem, self.solver.problem)

    def _stand_in(self, mesh: Mesh) -> EquilibriumSolver:
        """What falls on a mesh in place of the cloth itself."""
        arguments = self.arguments(mesh)
        problem = cloth_problem(mesh, replace(arguments, fabric=hinged(arguments.fabric)))
        return self.make_solver(problem, f"drape_fall{len(mesh.X)}_")


def hand_on_friction(before: ClothProblem, after: ClothProblem) -> None:
    """Let other elements on the same mesh remember what friction has done."""
    if before.contact:
        after.contact.history = before.contact.history
    if before.self_contact:
        after.self_contact.history = before.self_contact.history


def hinged(fabric: Fabric) -> Fabric:
    """The fabric with hinges in place of Morley's triangles."""
    return replace(fabric, kind="hinge", hinge_factor=HINGE_STIFFNESS["plate"]) if fabric.kind == "morley" else fabric


def soften(solver: EquilibriumSolver, x: np.ndarray, most: int, report: ConvergenceReport) -> None:
    """Positions x (n, 3), which are changed, without the crumples of a random start, by a membrane that is soft."""
    for part in SOFT:
        log.info("Cold start from scattered places: membrane stiffness times %g", part)
        solver.problem.soften(part)
        if part == SOFT[0]:
            solver.fall(x, ROUGH, most, report)
        solver.descend(x, ROUGH, min(most, SOFT_ROUNDS * MEMORY), report)
    solver.problem.soften(1.0)
