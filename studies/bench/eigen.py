"""The eigensolver in use beside SLEPc's, on the eigenproblems of the same frames."""

from collections.abc import Callable
from statistics import mean, median
from time import perf_counter
from typing import Any

import numpy as np
from petsc4py import PETSc
from restshape_studies.bench.eigensolvers import Frame, Rival, rivals
from restshape_studies.bench.job import Row

from restshape.algebra.eigenproblems.eigen import SPARE, EigenSolver
from restshape.algebra.eigenproblems.pencil import Deflation, Pencil
from restshape.algebra.stages import Stages
from restshape.analysis.modal.modal import ModalAnalysis
from restshape.errors import ReplayProblem, UserError
from restshape.interface.run import Run
from restshape.replay.request import Request
from restshape.scene.plan import plan

OURS = "restshape"
BELOW = -0.05
"""Shift of the positive definite factor, a share of the lowest eigenvalue."""


class Contest:
    """All solvers on one frame after the other.

    Args:
        request: of a scene whose analysis finds modes.

    Attributes:
        rows: of each solver: milliseconds, substitutions, largest true residual and error a frame.
        problems: frames in which a solver found nothing, which are not among its rows.
    """

    def __init__(self, request: Request) -> None:
        self.request, self.stages = request, Stages()
        self.rivals = rivals()
        names = [OURS, *(rival.name for rival in self.rivals)]
        self.rows: dict[str, list[Row]] = {name: [] for name in names}
        self.problems = dict.fromkeys(names, 0)
        self.turn = self.frames = 0
        self.unknowns = self.count = 0

    def begin(self, analysis: ModalAnalysis) -> None:
        """Start all solvers with the modes of a frame, which none of them is timed on."""
        solver = analysis.solver
        self.own = EigenSolver("auto", solver.tolerance, self.request.calibration, self.stages)
        self.near, self.definite = Pencil(self.stages), Pencil(self.stages)
        for rival in self.rivals:
            rival.history = [analysis.state.modes.vectors]
        self._take(analysis, True)
        self.own.restart(analysis.state.modes.vectors)
        self.own.solve(*self.system, analysis.state.count, True)
        self._refresh()

    def frame(self, analysis: ModalAnalysis) -> None:
        """Let all solvers find the modes of a frame, in turns."""
        self._take(analysis, False)
        self.frames += 1
        self.turn += 1
        self.unknowns, self.count = self.near.size, analysis.state.count
        tolerance = analysis.solver.tolerance
        start = perf_counter()
        found, report = self.own.solve(*self.system, analysis.state.count, False)
        self._note(OURS, 1e3 * (perf_counter() - start), report.iterations, found.residuals, analysis)
        shared = 0.0
        if report.refreshed:
            shared = 1e3 * self._refresh()
        deflation = Deflation(self.system[2], self.near)
        frame = Frame(self.near, self.definite, deflation, analysis.state.count, SPARE, tolerance)
        for k in range(len(self.rivals)):
            self._compete(self.rivals[(k + self.turn) % len(self.rivals)], frame, shared, analysis)

    def _compete(self, rival: Rival, frame: Frame, shared: float, analysis: ModalAnalysis) -> None:
        start = perf_counter()
        try:
            found = rival.solve(frame)
        except (ReplayProblem, PETSc.Error, np.linalg.LinAlgError):
            self.problems[rival.name] += 1
            rival.history = [analysis.state.modes.vectors]
            return
        ms = 1e3 * (perf_counter() - start)
        # Krylov-Schur makes its own factor; the others live on one that is made when ours is.
        ms += 0.0 if rival.kind == "krylovschur" else shared
        self._note(rival.name, ms, rival.substitutions, found.residuals, analysis, found.values)

    def _note(
        self,
        name: str,
        ms: float,
        substitutions: int,
        residuals: np.ndarray,
        analysis: ModalAnalysis,
        values: np.ndarray | None = None,
    ) -> None:
        wanted, error = analysis.state.count, 0.0
        if values is not None:
            error = float(np.max(np.abs(np.sqrt(values[:wanted] / analysis.state.modes.values[:wanted]) - 1.0)))
        row = {"ms": ms, "substitutions": substitutions, "residual": float(residuals[:wanted].max()), "error": error}
        self.rows[name].append(row)

    def _take(self, analysis: ModalAnalysis, new_system: bool) -> None:
        pencil = analysis.solver.pencil
        self.system = (pencil.stiffness, pencil.mass, analysis.state.body.free_rigid_motions())
        self.lowest = float(analysis.state.modes.values[0])
        for own in (self.near, self.definite):
            own.set_matrices(pencil.stiffness, pencil.mass, new_system)

    def _refresh(self) -> float:
        """Make the factors of the rivals; the seconds of one."""
        self.definite.factor(BELOW * self.lowest)
        start = perf_counter()
        self.near.factor(self.own.pencil.shift)
        return perf_counter() - start

    def record(self) -> Row:
        """What was found: a record a solver."""
        return {
            "frames": self.frames,
            "unknowns": self.unknowns,
            "modes": self.count,
            "solvers": {name: summary(rows, self.problems[name]) for name, rows in self.rows.items()},
        }


def summary(rows: list[Row], problems: int) -> Row:
    """The record of one solver."""
    averages: dict[str, Callable[[list[float]], float]] = {
        "ms": mean,
        "substitutions": mean,
        "residual": max,
        "error": max,
    }
    found: dict[str, Any] = {key: take([row[key] for row in rows]) if rows else None for key, take in averages.items()}
    return {**found, "p50": median(row["ms"] for row in rows) if rows else None, "problems": problems}


def measure(request: Request) -> Row:
    """The record of all solvers over the frames of a script that move nodes and keep the mesh.

    Args:
        request: of a scene whose analysis finds modes.

    Raises:
        UserError: it does not, or nothing is dragged.
    """
    if plan(request.scene, request.application).solver.equations != "eigenvalues":
        what = "the scene has no eigenproblem of frequencies alone"
        raise UserError(what, str(request.scene.path), "take a scene of metallophone")
    run = Run(request, summed=False)
    contest, size = Contest(request), None
    for row in run.rows():
        analysis = run.replay.analysis
        now = (id(analysis.space), analysis.unknowns, analysis.state.count)
        if row["refused"] or not row["level"]:
            continue
        if now != size:
            contest.begin(analysis)
            size = now
            continue
        contest.frame(analysis)
    if not contest.frames:
        raise UserError("the script drags nothing for two frames", str(request.scene.path), "--edits")
    return contest.record()
