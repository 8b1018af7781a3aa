"""The frame loop: edit, shape, mesh, operators, solve, observe, record."""

from collections.abc import Callable, Iterator
from time import perf_counter
from typing import Any

import numpy as np
from petsc4py import PETSc

from restshape.algebra.gather import bury
from restshape.algebra.linear import LinearReport
from restshape.algebra.stages import NAMES, Stages
from restshape.analysis.frame import Frame
from restshape.application import Application
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.importer import read_mesh
from restshape.mesh.mesh import Mesh
from restshape.mesh.moving import Advance, MovingMesh
from restshape.policy import Policy
from restshape.replay.recorder import Recorder
from restshape.scene.model import Scene
from restshape.scene.plan import plan
from restshape.scene.script import Script
from restshape.shape.outline import Outline
from restshape.shape.session import EditFrame, EditSession

NATIVE = ("relocate", "map", "flip", "mesh", "pattern", "values", "factor", "krylov", "observe")


class Replay:
    """Replays an edit script against a scene.

    Args:
        scene: what the user wrote.
        script: its edits.
        application: of the scene.
        policy: what is reused from frame to frame.
        comm: PETSc communicator; all ranks run the same edits on the same mesh and share the algebra.
        calibration: seconds a unit of counted work; no clock decides anything.
        recorder: takes each frame, on rank 0; None records nothing.
    """

    def __init__(
        self,
        scene: Scene,
        script: Script,
        application: Application,
        policy: Policy,
        comm: PETSc.Comm,
        calibration: Calibration,
        recorder: Recorder | None = None,
    ) -> None:
        self.policy, self.comm, self.recorder = policy, comm, recorder
        self.stages = Stages()
        imported, outline = self._imported(scene)
        self.session = EditSession(scene, script, outline=outline)
        self.analysis = application.make_analysis()(
            scene, plan(scene, application), comm, policy, calibration, self.stages
        )
        self.moving = MovingMesh(
            self.session.outline,
            scene.mesh,
            ranks=comm.size,
            regenerate=policy.regenerate,
            broadcast=self._from_first_rank if comm.size > 1 else None,
            relocation=policy.relocation,
            criterion=policy.criterion,
            flip_everywhere=policy.flip_everywhere,
            imported=imported,
        )
        self.recorded_topology: tuple[int, int] | None = None
        self.solved = False
        self.row: dict[str, Any] = {}

    def frames(self) -> Iterator[dict[str, Any]]:
        """The row of each frame, as soon as it is computed and handed to the recorder.

        Raises:
            UserError: the scene cannot be simulated, or the recording cannot be written.
        """
        edits = self.session.frames()
        while True:
            self.stages.reset()
            start = perf_counter()
            edit = next(edits, None)
            if edit is None:
                return
            edited = perf_counter()
            row = self._frame(edit)
            end = perf_counter()
            self._times(row, start, edited, end)
            self._record(edit, row, end)
            yield row

    def _frame(self, edit: EditFrame) -> dict[str, Any]:
        """Compute one frame; one with a problem is recorded as refused, and all goes on from the last solution."""
        refused = edit.refused or ""
        solved, self.solved = self.solved, False
        try:
            advance = self.moving.advance(edit)
            mesh, hand = self.moving.mesh, (edit.gesture, tuple(edit.c))
            # Flips of a frame that failed are not known any more.
            changed = advance.changed_cells if solved else np.arange(len(mesh.cells), dtype=np.int32)
            report = self.analysis.solve(Frame(mesh, changed, advance.old_mesh, edit.scene, hand))
            self.solved = True
        except (ReplayProblem, UserError) as problem:
            if edit.index == 0 and isinstance(problem, UserError):
                raise edit.scene.located(problem) from None
            if edit.index == 0:
                raise UserError(
                    str(problem), str(edit.scene.path), "mend the scene: its first shape has no solution"
                ) from problem
            refused = str(problem).replace("\n  try:", "; try:")
            self.moving.take_back()
            if edit.change != "none":
                self.session.take_back()
            advance, report = Advance.nothing(), LinearReport(0, False, self.row["age"], self.row["preconditioner"])
        with self.stages("observe"):
            quantities = self.analysis.observe()
        for stage, seconds in advance.stages.items():
            self.stages.seconds[stage] += seconds
        self.row = {
            "index": edit.index,
            "t": edit.t,
            "line": edit.line,
            "do": edit.do,
            "level": advance.level,
            "flips": advance.flips,
            "min_quality": advance.min_quality,
            "age": report.age,
            "refreshed": int(report.refreshed),
            "iterations": report.iterations,
            "preconditioner": report.preconditioner,
            "unknowns": self.analysis.unknowns,
            "elements": len(self.analysis.mesh.cells),
            "refused": refused,
        }
        self.row.update({f"q_{name}": value for name, value in quantities.items()})
        return self.row

    def _times(self, row: dict[str, Any], start: float, edited: float, end: float) -> None:
        """Add the milliseconds of the frame; `ms_python` is what no compiled stage took."""
        seconds = self.stages.seconds
        row["ms"] = (end - start) * 1e3
        row["ms_edit"] = (edited - start) * 1e3
        for name in NAMES:
            row[f"ms_{name}"] = seconds[name] * 1e3
        row["ms_python"] = row["ms"] - sum(seconds[name] for name in NATIVE) * 1e3

    def _record(self, edit: EditFrame, row: dict[str, Any], end: float) -> None:
        """Hand the frame to the recorder; the true residual is measured here, off the frame's time."""
        row["residual"] = self.analysis.residual()
        mesh = self.analysis.mesh
        if self.recorder:
            version = (id(mesh), mesh.topology)
            if version != self.recorded_topology:
                self.recorder.topology(mesh.cells)
                self.recorded_topology = version
            row["ms_record"] = (perf_counter() - end) * 1e3
            self.recorder.frame(
                edit.t, mesh.X, {"displacement": self.analysis.x}, {"von_mises": self.analysis.von_mises()}, row
            )
        row["ms_record"] = (perf_counter() - end) * 1e3
        if row["level"] > 1 or edit.change not in ("none", "move"):
            bury(self.comm)

    def _imported(self, scene: Scene) -> tuple[Mesh | None, Outline | None]:
        """The mesh that the scene imports, if it does, and the outline of its boundary."""
        if scene.mesh.file is None:
            return None, None
        return read_mesh(scene.folder / scene.mesh.file, scene.mesh.unit, ranks=self.comm.size)

    def _from_first_rank(self, make: Callable[[], Any]) -> Any:
        """What `make` gives on rank 0, on every rank; its problem, if it has one, is raised on every rank."""
        comm = self.comm.tompi4py()
        outcome = None
        if comm.rank == 0:
            try:
                outcome = (make(), None)
            except (ReplayProblem, UserError) as problem:
                outcome = (None, problem)
        result, problem = comm.bcast(outcome)
        if problem is not None:
            raise problem
        return result
