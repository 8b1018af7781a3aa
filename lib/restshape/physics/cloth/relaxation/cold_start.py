"""Cold starts of cloth, which falls from its initial placement: stiffness continuation over coarse and fine meshes."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from restshape.algebra.descent import MEMORY
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.fabric import Fabric
from restshape.physics.cloth.parameters import HINGE_STIFFNESS
from restshape.physics.cloth.relaxation.equilibrium import ROUGH, EquilibriumSolver
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.scene import ClothArguments, cloth_problem

log = logging.getLogger("restshape.physics")

SOFT = (0.01, 0.05)
"""Parts of the membrane's stiffness that cloth falls with at first: soft cloth finds its folds in large steps."""
ROUNDS, LAST_ROUNDS = 4, 2
"""Tangents of a descent with a soft membrane, on coarse meshes and on the finest one."""
STIFF_ROUNDS = 30
"""Tangents of a descent of hinges in place of Morley's triangles, with all of the membrane's stiffness."""
FEWEST = 60
"""Nodes of a mesh that cloth may fall on: on fewer it finds no folds, and past a body no way back."""


class ColdStart:
    """Finds positions near an equilibrium from the initial placement, on the meshes that a mesh is nested in.

    Args:
        solver: of the equilibria wanted.
        levels: of meshes at most.
        arguments: what a problem on one of the meshes is made from.
        make_solver: of a problem, and a prefix of options in PETSc's database.
    """

    def __init__(
        self,
        solver: EquilibriumSolver,
        levels: int,
        arguments: Callable[[Mesh], ClothArguments],
        make_solver: Callable[[ClothProblem, str], EquilibriumSolver],
    ) -> None:
        self.solver, self.arguments, self.make_solver = solver, arguments, make_solver
        problem = solver.problem
        self.hierarchy = problem.mesh.hierarchy
        meshes = self.hierarchy.meshes if self.hierarchy else [problem.mesh]
        wanted = min(levels, sum(len(mesh.X) >= FEWEST for mesh in meshes) or 1)
        self.meshes, self.skipped = meshes[-wanted:], len(meshes) - wanted
        # Morley's triangles have four times as many unknowns as hinges.
        self.replaced = problem.morley is not None

    def find(self, most: int, report: ConvergenceReport) -> np.ndarray:
        """Positions (n, 3) near an equilibrium, in so many steps at most."""
        problem = self.solver.problem
        replaced = self.meshes if self.replaced else self.meshes[:-1]
        own = [self._replacement(mesh, level) for level, mesh in enumerate(replaced)]
        solvers = own if self.replaced else [*own, self.solver]

        def prolong(level: int, x: np.ndarray) -> np.ndarray:
            corners = self.hierarchy.prolong(self.skipped + level, solvers[level].problem.corners(x))
            x = solvers[level + 1].problem.flat(corners)
            solvers[level + 1].problem.begin(x)
            return x

        start = solvers[0].problem.flat(self.arguments(self.meshes[0]).start)
        solvers[0].problem.begin(start)
        try:
            x = stiffen(solvers, prolong, start, most, report, self.replaced)
            return problem.flat(solvers[-1].problem.corners(x)) if self.replaced else x
        finally:
            for solver in own:
                solver.destroy()

    def _replacement(self, mesh: Mesh, level: int) -> EquilibriumSolver:
        """What falls on a mesh of the hierarchy in place of the cloth itself."""
        arguments = self.arguments(mesh)
        problem = cloth_problem(mesh, replace(arguments, fabric=hinged(arguments.fabric)))
        return self.make_solver(problem, f"drape_level{level}_")


def hinged(fabric: Fabric) -> Fabric:
    """The fabric with hinges in place of Morley's triangles."""
    return replace(fabric, kind="hinge", hinge_factor=HINGE_STIFFNESS["plate"]) if fabric.kind == "morley" else fabric


def stiffen(
    solvers: Sequence[EquilibriumSolver],
    prolong: Callable[[int, np.ndarray], np.ndarray],
    x: np.ndarray,
    most: int,
    report: ConvergenceReport,
    stiff: bool,
) -> np.ndarray:
    """Positions on the finest mesh, near an equilibrium, from a start x (n, 3) on the coarsest one.

    Args:
        solvers: from the coarsest mesh to the finest.
        prolong: takes positions on the mesh of a level to the next one.
        most: steps in all.
        stiff: the last of the solvers stands in for another one: it descends with all of its stiffness too.
    """
    last = len(solvers) - 1
    for level, solver in enumerate(solvers):
        # Stiff triangles of a coarse mesh would not let the cloth fold.
        for part in SOFT if level == 0 else SOFT[-1:]:
            solver.problem.soften(part)
            nodes = len(solver.problem.mesh.X)
            log.info("Cold start: mesh of %d nodes, membrane stiffness times %g", nodes, part)
            if level == 0 and part == SOFT[0]:
                solver.damp(x, ROUGH, report)
            rounds = ROUNDS if level < last else LAST_ROUNDS
            solver.descend(x, ROUGH, min(most, rounds * MEMORY), report)
        if level < last:
            x = prolong(level, x)
    solver.problem.soften(1.0)
    if stiff:
        solver.descend(x, ROUGH, min(most, STIFF_ROUNDS * MEMORY), report)
    return x


def restart_soft(solver: EquilibriumSolver, x: np.ndarray, most: int, report: ConvergenceReport) -> None:
    """Soft for a while, from positions x (n, 3), which are changed, that a stiff membrane leaves in small steps."""
    for part in SOFT:
        log.info("Stiffness continuation from a saddle: membrane stiffness times %g", part)
        solver.problem.soften(part)
        # Beside an unstable equilibrium forces are small, and grow at first.
        solver.damp(x, min(ROUGH, 0.1 * solver.residual_norm(x)), report)
        solver.descend(x, ROUGH, min(most, ROUNDS * MEMORY), report)
    solver.problem.soften(1.0)
