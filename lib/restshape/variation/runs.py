"""Runs the replays of a sweep in one process; each goes on with the analysis of the one before where it can."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from time import process_time

from restshape.analysis.row_values import whole
from restshape.application import application_of
from restshape.errors import UserError
from restshape.interface.run import Run
from restshape.replay.request import Request
from restshape.scene.edit_script import Script, load_script
from restshape.scene.load import load_scene
from restshape.scene.model import Scene, ShapeSpec
from restshape.shape.outline import Outline
from restshape.variation.analysis_reuse import can_follow, remembered
from restshape.variation.following_session import FollowingSession, Standing
from restshape.variation.sweep_request import SweepRequest
from restshape.variation.swept_run import DONE, INVALID, NEW, REUSED, UNSOLVED, SweptRun, errors_count, quantity_columns


class Sweep:
    """The runs of a sweep, one after the other.

    Attributes:
        scene: of the last run that was valid, and `columns` that show its quantities; None before.
        singular: quantities at singular places in one of the runs, with the exponent of displacements.
    """

    def __init__(self, request: SweepRequest) -> None:
        self.request = request
        self.scene: Scene | None = None
        self.columns: list[str] | None = None
        self.singular: dict[str, float] = {}
        self._last: Run | None = None
        self._moved = False
        self._start: tuple[ShapeSpec, Outline] | None = None

    def runs(self, on_frame: Callable[[], None] = lambda: None) -> Iterator[SweptRun]:
        """Each run, as soon as its last frame is done; those that have no result say why.

        Args:
            on_frame: called after each frame; what it raises ends the sweep.
        """
        for index, places in enumerate(self.request.combinations()):
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
        self.scene, names = scene, quantity_columns(scene, application_of(scene))
        self.columns = self.columns or names
        run.limit(scene)
        run.remembered = remembered(scene, application_of(scene))
        last, self._last = self._last, None
        if last and (following := self._follow(last, scene, script)):
            run.analysis = REUSED
            if self._replayed(following, run, on_frame):
                return
            # It may be the way to the solution that fails, and not the solution.
            run.analysis = NEW
        try:
            new = self._new(scene, script)
        except UserError as error:
            run.status, run.why = INVALID, _plain(error)
            return
        self._replayed(new, run, on_frame)

    def _replayed(self, running: Run, run: SweptRun, on_frame: Callable[[], None]) -> bool:
        """Replays all frames of a run; false where the first one has no solution."""
        names = self.columns or []
        run.status, run.why = DONE, ""
        try:
            for frame in running:
                self._moved |= run.frames > 0 and whole(frame.row, "level") > 0
                run.add(frame.row, names)
                on_frame()
        except UserError as error:
            run.status, run.why = UNSOLVED, _plain(error)
            return False
        replay = running.replay
        run.limit(replay.session.scene)
        self._last = running
        self.singular = replay.errors.singular.ever | self.singular
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

    def _new(self, scene: Scene, script: Script) -> Run:
        """A run with solvers of its own.

        Raises:
            UserError: the scene cannot be simulated.
        """
        new = Run(self._asked(scene, script), summed=False)
        self._moved, self._start = False, None
        if (outline := new.replay.session.outline) is not None:
            self._start = scene.shape, outline
        return new

    def _asked(self, scene: Scene, script: Script) -> Request:
        """What the replay of a run is asked for."""
        asked = self.request
        made = Request.of(scene, script, asked.policy, asked.guess, asked.calibration, asked.petsc)
        # No run shows what would mend it.
        return replace(made, guided=False, measured="all" if errors_count(scene) else "nothing")

    def _follow(self, running: Run, scene: Scene, script: Script) -> Run | None:
        """The run that goes on to this scene with the solvers of the last one; None where these cannot."""
        app, last = application_of(scene), running.replay.session
        outline = last.outline
        if outline is None or not can_follow(last.scene, scene, app, self.request.continued):
            return None
        imported = scene.mesh.file is not None
        # A mesh file is read by a replay of its own alone.
        if imported and (self._moved or scene.mesh != last.scene.mesh):
            return None
        known = self._start[1] if self._start and (imported or scene.shape == self._start[0]) else None
        before = Standing(outline, last.scene, self._moved)
        own_mesh = self.request.edits is not None or not self.request.continued
        try:
            session = FollowingSession(scene, script, app, before, own_mesh, known)
            if imported and session.first_change != "values":
                return None
            following = running.follow(session, self._asked(scene, script))
        except UserError:
            # A replay of its own says what is wrong.
            return None
        self._start = scene.shape, session.outline
        self._moved &= session.first_change != "shape"
        return following


def _plain(error: UserError) -> str:
    """A message in one line."""
    return "; ".join(line.strip() for line in str(error).splitlines())
