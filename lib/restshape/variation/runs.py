"""Runs the replays of a sweep in one process; each goes on with the analysis of the one before where it can."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import process_time

from petsc4py import PETSc

from restshape.analysis.row_values import whole
from restshape.application import SHAPES, Application, application
from restshape.calibration import Calibration
from restshape.errors import UserError
from restshape.policy import Policy, policy
from restshape.replay.loop import Replay
from restshape.scene.edit_script import Script, load_script
from restshape.scene.load import load_scene
from restshape.scene.model import Scene
from restshape.scene.plan import plan, refuse_switched
from restshape.shape.outline import Outline
from restshape.shape.session import EditSession
from restshape.variation.following_session import FollowingSession, Standing
from restshape.variation.swept_key import SweptKey, combinations
from restshape.variation.swept_run import DONE, INVALID, NEW, REUSED, UNSOLVED, SweptRun, quantity_columns

FIXED = ("app", "quantities", "solve")
"""What an analysis, and the columns of its replay, are made for."""


@dataclass(frozen=True)
class SweepRequest:
    """What is to be swept, and how.

    Args:
        scene: the file.
        fixed: overrides of all runs.
        swept: keys, each with its values.
        edits: script that each run replays; None: the first shape only.
        policy, guess: as of a replay; None: the scene's.
        calibration: seconds a unit of counted work.
        continued: nonlinear solutions start from that of the run before, and follow its branch.
    """

    scene: Path
    fixed: Sequence[str]
    swept: Sequence[SweptKey]
    edits: Path | None
    policy: str | None
    guess: str | None
    calibration: Calibration
    continued: bool = False


class Sweep:
    """The runs of a sweep, one after the other.

    Attributes:
        scene: of the last run that was valid, and `columns` that show its quantities; None before.
    """

    def __init__(self, request: SweepRequest) -> None:
        self.request = request
        self.scene: Scene | None = None
        self.columns: list[str] | None = None
        self._replay: Replay | None = None
        self._moved = False
        self._start: Outline | None = None

    def runs(self, on_frame: Callable[[], None] = lambda: None) -> Iterator[SweptRun]:
        """Each run, as soon as its last frame is done; those that have no result say why.

        Args:
            on_frame: called after each frame; what it raises ends the sweep.
        """
        for index, places in enumerate(combinations(self.request.swept)):
            pairs = list(zip(self.request.swept, places))
            numbers = {one.key: one.numbers[place] for one, place in pairs if one.numbers}
            run = SweptRun(index, {one.key: one.values[place] for one, place in pairs}, numbers)
            start = process_time()
            self._run(run, on_frame)
            run.cpu_s = process_time() - start
            yield run

    def _run(self, run: SweptRun, on_frame: Callable[[], None]) -> None:
        """Replays one run, and notes its result."""
        try:
            scene, script = self._read(run)
        except UserError as error:
            run.status, run.why = INVALID, _plain(error)
            return
        self.scene, names = scene, quantity_columns(scene, application(scene.app))
        self.columns = self.columns or names
        last, self._replay = self._replay, None
        if last and self._follow(last, scene, script):
            run.analysis = REUSED
            if self._replayed(last, run, on_frame):
                return
            # It may be the way to the solution that fails, and not the solution.
            run.analysis = NEW
        try:
            replay = self._new(scene, script)
        except UserError as error:
            run.status, run.why = INVALID, _plain(error)
            return
        self._replayed(replay, run, on_frame)

    def _replayed(self, replay: Replay, run: SweptRun, on_frame: Callable[[], None]) -> bool:
        """Replays all frames of a run; false where the first one has no solution."""
        names = self.columns or []
        run.status, run.why = DONE, ""
        try:
            for row in replay.frames():
                self._moved |= run.frames > 0 and whole(row, "level") > 0
                run.add(row, names)
                on_frame()
        except UserError as error:
            run.status, run.why = UNSOLVED, _plain(error)
            return False
        self._replay = replay
        return True

    def _read(self, run: SweptRun) -> tuple[Scene, Script]:
        """The scene and the script of a run.

        Raises:
            UserError: one of them is not valid.
        """
        request = self.request
        words = [*request.fixed, *(f"{key}={value}" for key, value in run.values.items())]
        scene = load_scene(request.scene, words)
        script = load_script(request.edits, scene) if request.edits else Script.empty(scene)
        return scene, script

    def _new(self, scene: Scene, script: Script) -> Replay:
        """A replay of its own.

        Raises:
            UserError: the scene cannot be simulated.
        """
        chosen: Policy = policy(self.request.policy or scene.solve.policy, self.request.guess)
        app = application(scene.app)
        replay = Replay(scene, script, app, chosen, PETSc.COMM_WORLD, self.request.calibration)
        self._moved, self._start = False, None
        if isinstance(replay.session, EditSession):
            self._start = replay.session.outline
        return replay

    def _follow(self, replay: Replay, scene: Scene, script: Script) -> bool:
        """Has the replay of the last run go on to this scene; false where it cannot."""
        app, last = application(scene.app), replay.session
        if not isinstance(last, EditSession) or not _can_follow(last.scene, scene, app, self.request.continued):
            return False
        imported = scene.mesh.file is not None
        # A mesh file is read by a replay of its own alone.
        if imported and (self._moved or scene.mesh != last.scene.mesh):
            return False
        known = self._start if imported or scene.shape == last.scene.shape else None
        before = Standing(last.outline, last.scene, self._moved)
        try:
            session = FollowingSession(scene, script, app, before, self.request.edits is not None, known)
            if imported and session.first_change != "values":
                return False
            replay.follow(session, scene, app)
        except UserError:
            # A replay of its own says what is wrong.
            return False
        self._start = session.outline
        self._moved &= session.first_change != "shape"
        return True


def _can_follow(old: Scene, new: Scene, app: Application, continued: bool) -> bool:
    """Whether the analysis of a scene may go on to another one, and gives what one of its own would.

    Its equations determine the solution alone, not the way to it: they are linear, or give eigenvalues.
    """
    if app.editing.replayed != SHAPES.replayed or any(app.transient(scene) for scene in (old, new)):
        return False
    if not continued and plan(new, app).solver.equations == "nonlinear":
        return False
    if any(old.raw.get(key) != new.raw.get(key) for key in FIXED) or old.quantities != new.quantities:
        return False
    if old.mesh.file != new.mesh.file:
        return False
    try:
        refuse_switched(old, new, app)
    except UserError:
        return False
    return list(app.own_columns(old)) == list(app.own_columns(new))


def _plain(error: UserError) -> str:
    """A message in one line."""
    return str(error).replace("\n  try:", "; try:").replace("\n", " ")
