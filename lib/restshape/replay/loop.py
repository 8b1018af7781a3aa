"""The frame loop: edit, shape, mesh, operators, solve, observe, record."""

# More than 15 modules: the loop joins all parts of a frame.

from collections.abc import Callable, Iterator, Sequence
from logging import INFO
from time import perf_counter

from petsc4py import PETSc

from restshape.algebra.factors.gathering import clean_up
from restshape.algebra.nonlinear.newton_convergence import INDEFINITE
from restshape.algebra.stages import NAMES, Stages
from restshape.analysis.row_values import RowValues, whole
from restshape.errors import ReplayProblem, UserError
from restshape.memory import give_back
from restshape.mesh.advance import MeshUpdate
from restshape.replay.frame_errors import FrameErrors
from restshape.replay.frame_log import log, log_frame, log_refused
from restshape.replay.frame_rows import FrameRows
from restshape.replay.frame_solver import FrameSolver
from restshape.replay.petsc_options import of_solvers
from restshape.replay.rank_agreement import refuse_unlike
from restshape.replay.recording.recorder import Recorder
from restshape.replay.replay_parts import replay_parts
from restshape.replay.request import Request
from restshape.shape.protocol import Session
from restshape.shape.script_frame import ScriptFrame

STAGE_COLUMNS = tuple((name, f"ms_{name}") for name in NAMES)
NATIVE = ("relocate", "map", "flip", "mesh", "pattern", "values", "factor", "krylov", "observe")
AT_BUCKLING = "lower the loads, or add one across them, a thousandth as large, that says to which side it buckles"
"""What to do where an equilibrium is unstable."""


class Replay:
    """Replays an edit script against a scene.

    Args:
        request: what is to be replayed; PETSc's options are the caller's to set.
        comm: PETSc communicator; all ranks run the same edits on the same mesh and share the algebra.
        recorder: takes each frame, on rank 0; None records nothing.

    Attributes:
        row: of the last frame.
        on_answer: called when a frame has its answer, before what is measured beside it.

    Raises:
        UserError: no valid first shape, what is to be predicted cannot be, or ranks have been given unlike scenes.
    """

    def __init__(self, request: Request, comm: PETSc.Comm, recorder: Recorder | None = None) -> None:
        refuse_unlike(request, comm)
        self.policy, self.comm, self.recorder = request.policy, comm, recorder
        self._petsc = request.petsc
        self.stages = Stages()
        parts = replay_parts(request, comm, self.stages)
        self.session, self.moving, self.analysis, self.prediction = parts
        self.solver = FrameSolver(parts, request.policy)
        self.rows = FrameRows(self.solver, request.scene)
        self.errors = FrameErrors(request, comm, self.stages, parts)
        self.recorded_topology: tuple[int, int] | None = None
        self.row: RowValues = {}
        self.on_answer: Callable[[], None] | None = None

    def follow(self, session: Session, request: Request) -> None:
        """Goes on with another session, whose first frame says what changes from the last one of this session.

        Raises:
            UserError: errors of quantities cannot be estimated.
        """
        self.session = session
        self.rows = FrameRows(self.solver, request.scene)
        self.errors.follow(session, request)

    def frames(self) -> Iterator[RowValues]:
        """The row of each frame, as soon as it is computed and handed to the recorder.

        Raises:
            UserError: the scene cannot be simulated, or the recording cannot be written.
        """
        return self.answers(self.session.frames())

    def answers(self, edits: Iterator[ScriptFrame]) -> Iterator[RowValues]:
        """The row of each of these frames of the session, likewise: of a script, or of events as they are done."""
        while True:
            self.stages.reset()
            start = perf_counter()
            edit = next(edits, None)
            if edit is None:
                return
            edited = perf_counter()
            if self.prediction is not None:
                idle = self._idle(edit)
                start, edited = start + idle, edited + idle
            row = self._frame(edit)
            end = perf_counter()
            self._times(row, start, edited, end)
            if self.on_answer:
                self.on_answer()
            self._measure(edit, row)
            if whole(row, "level") > 1 or edit.change not in ("none", "move") or row["predicted"]:
                clean_up(self.comm)
            if row["level"] == 3:
                give_back(whole(row, "elements"))
            self._hand_over(edit, row, start, end)
            yield row

    def _idle(self, edit: ScriptFrame) -> float:
        """Spend the edit time before a frame; the seconds that this has taken, which are none of the frame's."""
        start = perf_counter()
        self.solver.idle(edit)
        self.stages.reset()
        return perf_counter() - start

    def _frame(self, edit: ScriptFrame) -> RowValues:
        """Compute one frame; one with a problem is recorded as refused, and all goes on from the last solution."""
        solver, refused = self.solver, edit.refused or ""
        try:
            solver.returns.leave(edit)
            known = solver.returns.restored(edit)
            mesh_update = known[0] if known else self.moving.update(edit)
            self.errors.note(self.moving, mesh_update)
            report = solver.returned(known[1]) if known else solver(edit, mesh_update)
        except (ReplayProblem, UserError) as problem:
            if edit.index == 0:
                raise _without_solution(edit, problem, self._petsc) from (
                    None if isinstance(problem, UserError) else problem
                )
            refused = problem.one_line if isinstance(problem, UserError) else _refusal(problem)
            log_refused(edit, refused)
            solver.rollback()
            if edit.change != "none":
                self.session.rollback()
            mesh_update, report = MeshUpdate.nothing(), solver.no_report()
        if not refused:
            solver.returns.take(edit, solver.known and not solver.predicted)
        with self.stages("observe"):
            quantities = self.rows.observed(edit.scene, refused)
        for stage, seconds in mesh_update.stages.items():
            self.stages.seconds[stage] += seconds
        self.row = self.rows(edit, mesh_update, report, quantities, refused)
        if log.isEnabledFor(INFO):
            log_frame(edit, mesh_update, report, solver.predicted)
        return self.row

    def _times(self, row: RowValues, start: float, edited: float, end: float) -> None:
        """Add the milliseconds of the answer; `ms_python` is what no compiled stage took of them."""
        seconds = self.stages.seconds
        whole_ms = (end - start) * 1e3
        row["ms_edit"] = (edited - start) * 1e3
        for name, column in STAGE_COLUMNS:
            row[column] = seconds[name] * 1e3
        row["ms_python"] = whole_ms - sum(map(seconds.__getitem__, NATIVE)) * 1e3

    def _measure(self, edit: ScriptFrame, row: RowValues) -> None:
        """Add what is known of the answer: its residual and its errors."""
        measured = self.solver.known and not row["refused"] and self.errors.measuring
        row["mesh_area"] = self.moving.area()
        self.errors.add_to(row, edit, measured)

    def _hand_over(self, edit: ScriptFrame, row: RowValues, start: float, end: float) -> None:
        """Hand the frame to the recorder; its time is up to there, and in what is yielded that of the hand-over too."""
        row["ms_estimate"] = (perf_counter() - end) * 1e3
        begin = perf_counter()
        if self.recorder:
            mesh, known = self.solver.space, self.solver.known
            version = (id(mesh), mesh.topology)
            if version != self.recorded_topology:
                self.recorder.topology(mesh.cells)
                self.recorded_topology = version
            fields = self.analysis.fields() if known else self.analysis.blank_fields(mesh)
            now = perf_counter()
            row["ms_record"], row["ms"] = (now - begin) * 1e3, (now - start) * 1e3
            self.recorder.frame(edit.t, mesh.X, *fields, row)
        now = perf_counter()
        row["ms_record"], row["ms"] = (now - begin) * 1e3, (now - start) * 1e3


def _refusal(problem: ReplayProblem) -> str:
    """What is said of a later frame that has a problem, with what to do about it where that is known."""
    return f"{problem} ({AT_BUCKLING})" if INDEFINITE in str(problem) else str(problem)


def _without_solution(edit: ScriptFrame, problem: ReplayProblem | UserError, petsc: Sequence[str]) -> UserError:
    """What is said of a first frame that has a problem; `petsc` are the user's words for PETSc."""
    if isinstance(problem, UserError):
        return edit.scene.located(problem)
    mend = "mend the scene: its first shape has no solution"
    if INDEFINITE in str(problem):
        mend = AT_BUCKLING
    if followed := of_solvers(petsc):
        do = f"leave these words out, for solvers follow them; where that does not help, {mend}"
        return UserError(str(problem), f"-- {' '.join(followed)}", do)
    return UserError(str(problem), str(edit.scene.path), mend)
