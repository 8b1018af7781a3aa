"""Solvers of the linear systems of implicit steps side by side: iterations and milliseconds at three tolerances."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.nonlinear.kinetic_damping import KineticDamping
from restshape.algebra.preconditioner import order_factor
from restshape.arrays import Reals
from restshape.mesh.nested import Refined
from restshape.physics.cloth.relaxation.relaxation_equations import ClothEquations

TOLERANCES = (1e-2, 1e-4, 1e-6)
SHIFT = 0.05
"""Part of the diagonal that ILU(0) adds: with less it meets blocks that are not positive definite."""
EVERY = 8
"""Steps between the systems that are looked at, over which a stale factor ages."""

SetUp = Callable[[PETSc.KSP, PETSc.Mat], None]


def interpolation(step: Refined) -> PETSc.Mat:
    """From positions of the nodes of a coarse mesh to those of the finer one."""
    n, half = len(step.parents), np.repeat(np.arange(3), 2)
    rows = (3 * np.arange(n)[:, None] + half).ravel()
    columns = (3 * step.parents[:, [0, 1, 0, 1, 0, 1]] + half).ravel()
    found = PETSc.Mat().createAIJ((3 * n, 3 * len(step.corner_number)), nnz=6, comm=PETSc.COMM_SELF)
    for row, column in zip(rows.tolist(), columns.tolist()):
        found.setValue(row, column, 0.5, addv=PETSc.InsertMode.ADD_VALUES)
    found.assemble()
    return found


@dataclass
class Method:
    """A solver of steps.

    Args:
        row: in the table.
        blocks: it takes the matrix in blocks of nodes.
        options: of its KSP; set_up: what options cannot say.
        keeps: the first factor serves all systems.
        shift: part of the diagonal that the preconditioner's matrix has more.
    """

    row: str
    blocks: bool
    options: dict[str, object]
    set_up: SetUp = lambda ksp, mat: None
    keeps: bool = False
    shift: float = 0.0
    ksps: dict[float, PETSc.KSP] = field(default_factory=dict)
    iterations: dict[float, list[int]] = field(default_factory=dict)
    times: dict[float, list[float]] = field(default_factory=dict)

    def solve(self, matrix: PETSc.Mat, right: PETSc.Vec, tolerance: float) -> None:
        """Take down a solve from no guess, with all that a new matrix needs."""
        way = right.duplicate()
        way.set(0.0)
        if tolerance not in self.ksps:
            self.ksps[tolerance] = self._made(matrix, tolerance)
        ksp = self.ksps[tolerance]
        begun = perf_counter()
        ksp.setOperators(matrix, self._shifted(matrix) if self.shift else matrix)
        ksp.solve(right, way)
        spent = perf_counter() - begun
        if self.keeps:
            ksp.getPC().setReusePreconditioner(True)
        if ksp.getConvergedReason() < 0:
            raise ArithmeticError(f"{self.row} does not solve a step: {ksp.getConvergedReason()}")
        self.iterations.setdefault(tolerance, []).append(ksp.getIterationNumber())
        self.times.setdefault(tolerance, []).append(1e3 * spent)
        way.destroy()

    def _shifted(self, matrix: PETSc.Mat) -> PETSc.Mat:
        found, diagonal = matrix.duplicate(copy=True), matrix.getDiagonal()
        diagonal.scale(self.shift)
        found.setDiagonal(diagonal, addv=PETSc.InsertMode.ADD_VALUES)
        return found

    def _made(self, matrix: PETSc.Mat, tolerance: float) -> PETSc.KSP:
        prefix = f"step_solvers_{id(self):x}_{tolerance:g}_"
        ksp = PETSc.KSP().create(PETSc.COMM_SELF)
        ksp.setOptionsPrefix(prefix)
        ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
        ksp.setTolerances(rtol=tolerance, max_it=5000)
        options = PETSc.Options(prefix)
        for key, value in self.options.items():
            options.setValue(key, value)
        self.set_up(ksp, matrix)
        ksp.setFromOptions()
        return ksp


def methods(steps: Sequence[Refined]) -> list[Method]:
    """What is compared; with nested meshes multigrid on them too."""

    def complete(ksp: PETSc.KSP, mat: PETSc.Mat) -> None:
        ksp.getPC().setType("cholesky")
        order_factor(ksp.getPC())

    def multigrid(ksp: PETSc.KSP, mat: PETSc.Mat) -> None:
        pc = ksp.getPC()
        pc.setType("mg")
        pc.setMGLevels(len(steps) + 1)
        for level, step in enumerate(steps):
            pc.setMGInterpolation(level + 1, interpolation(step))

    _kernels.register_node_relaxation()
    cg, sweeps = {"ksp_type": "cg"}, {"mg_levels_ksp_type": "richardson", "mg_levels_pc_type": "sor"}
    found = [
        Method("SSOR in blocks, one reading of the matrix", True, {"ksp_type": _kernels.node_ssor, "pc_type": "none"}),
        Method("SSOR in blocks", True, cg | {"pc_type": "sor"}),
        Method(f"ILU(0) in blocks, diagonal {SHIFT:.0%} larger", True, cg | {"pc_type": "ilu"}, shift=SHIFT),
        Method("stale complete factor", False, cg, complete, keeps=True),
        Method("fresh complete factor", False, {"ksp_type": "preonly", "ksp_norm_type": "none"}, complete),
    ]
    if steps:
        mg = cg | sweeps | {"pc_mg_galerkin": "both", "mg_levels_ksp_max_it": 1, "mg_coarse_pc_type": "cholesky"}
        found.append(Method(f"multigrid on {len(steps) + 1} nested meshes", False, mg, multigrid))
    return found


class Compared:
    """Takes the place of the solver of a motion, and lets other methods solve some of its systems too.

    Args:
        moving: the motion, from now on with this solver.
        equations: of it.
        found: methods.
        warm: steps before the first system that is looked at.
    """

    def __init__(self, moving: KineticDamping, equations: ClothEquations, found: Sequence[Method], warm: int) -> None:
        self.own, self.equations, self.methods, self.left = moving.linear, equations, found, warm
        self.blocks, self.x = True, np.zeros(0)
        self.inertia = 1.0 / moving.steps.time_step**2
        moving.linear = self

    def __getattr__(self, name: str) -> Any:
        return getattr(self.own, name)

    def note(self, x: Reals, norm: float) -> bool:
        """Take in where the cloth is, as `KineticDamping.on_step`."""
        self.x = x.copy()
        return False

    def solve(self, matrix: PETSc.Mat, right: Reals) -> Reals | None:
        """As of `StepSolver`."""
        if self.left == 0:
            self.left = EVERY
            rows = self.equations.step_matrix(self.x, self.inertia, False)
            row = PETSc.Vec().createWithArray(right.ravel().copy(), comm=PETSc.COMM_SELF)
            for method in self.methods:
                for tolerance in TOLERANCES:
                    method.solve(matrix if method.blocks else rows, row, tolerance)
        self.left -= 1
        return self.own.solve(matrix, right)


def table(found: Sequence[Method]) -> list[tuple[str, float, float, float]]:
    """Row, tolerance, mean iterations and median milliseconds of each method at each tolerance."""
    return [
        (one.row, tolerance, float(np.mean(one.iterations[tolerance])), median(one.times[tolerance]))
        for one in found
        for tolerance in TOLERANCES
    ]
