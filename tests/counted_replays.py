"""Replays whose frames are counted: unknowns, matrix entries, kernel calls, PETSc's events, stages."""

from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from petsc4py import PETSc
from restshape_studies.explain.filled import stored
from slepc4py import SLEPc

from restshape import _kernels
from restshape.algebra.linear import LinearSolver
from restshape.algebra.reuse.counted_work import counted_seconds
from restshape.algebra.stages import LOGGED, log_stage
from restshape.application import application_of
from restshape.calibration import Calibration
from restshape.interface.run import Run
from restshape.policy import policy
from restshape.replay.event_counts import EventCounts
from restshape.replay.frame_counts import difference
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.edit_script import Script, load_script
from restshape.scene.load import load_scene

EVENTS = (
    "RestshapePattern",
    "RestshapePatch",
    "RestshapeValues",
    "MatCholFctrSym",
    "MatCholFctrNum",
    "MatICCFactorSym",
    "MatLUFactorSym",
    "MatLUFactorNum",
    "MatILUFactorSym",
    "PCSetUp",
    "PCApply",
    "KSPSolve",
    "KSPGMRESOrthog",
    "MatMult",
    "MatMultAdd",
    "MatSolve",
    "SNESSolve",
    "SNESFunctionEval",
    "SNESJacobianEval",
    "EPSSolve",
)


class Watch:
    """What a replay has done when its frame has an answer.

    `calls` of kernels, what PETSc did (`events`), which `stages` took time, and of linear problems `counted_seconds`:
    what that costs by the calibration.
    """

    def __init__(self, replay: Replay) -> None:
        self._replay, self._events, self.row = replay, EventCounts(EVENTS), dict[str, Any]()
        replay.on_answer = self._on_answer
        self.begin()

    def begin(self) -> None:
        """A frame begins."""
        self._events.since_last()
        _kernels.reset_calls()

    def _on_answer(self) -> None:
        events, row = self._events.since_last(), self._replay.row
        stages = sorted(name for name, seconds in self._replay.stages.seconds.items() if seconds > 0.0)
        solver = getattr(self._replay.analysis, "solver", None)
        known = isinstance(solver, LinearSolver)
        seconds = counted_seconds(events, int(row["iterations"]), solver) if known else 0.0
        self.row = {"calls": _kernels.calls(), "events": events, "stages": stages, "counted_seconds": seconds}


def begin_log() -> None:
    """Let PETSc count, with the events of all its parts known by their names, and none of them open."""
    PETSc.Log.begin()
    for part in (PETSc.KSP, PETSc.SNES, SLEPc.EPS):
        part().create(PETSc.COMM_SELF).destroy()
    for name in LOGGED:
        stage = log_stage(name)
        stage.push()
        end_open_events(stage.id)
        stage.pop()
    end_open_events(0)


def end_open_events(stage: int) -> None:
    """End what an error left open in the current log stage: PETSc counts no event within itself."""
    for name in EVENTS:
        event = PETSc.Log.Event(name)
        while not counted(event, stage):
            event.end()


def counted(event: PETSc.LogEvent, stage: int) -> bool:
    """Whether an event that happens now is counted."""
    before = event.getPerfInfo(stage)["count"]
    event.begin()
    event.end()
    return bool(event.getPerfInfo(stage)["count"] > before)


def watched(
    scene: Path,
    script: Path | None = None,
    overrides: Sequence[str] = (),
    name: str = "auto",
    predict: str = "none",
    frames: int | None = None,
) -> tuple[list[dict[str, Any]], Replay]:
    """The rows of a replay in this process, and the replay.

    Those of the first `frames`, if not None. Each row has besides `calls`, `calls_beside`, `events`, `stages`,
    `counted_seconds`, and `entries` of the replay's matrices.
    """
    read = load_scene(scene, overrides)
    edits = load_script(script, read) if script else Script.empty(read)
    asked = Request(read, edits, application_of(read), policy(name), Calibration.load(), (), predict)
    run = Run(asked, summed=False)
    watch, before, rows = Watch(run.replay), stored()[1], []
    for row in islice(run.rows(), frames):
        beside = difference(_kernels.calls(), watch.row["calls"])
        rows.append({**row, **watch.row, "calls_beside": beside, "entries": stored()[1] - before})
        watch.begin()
    return rows, run.replay


def kernels(rows: list[dict[str, Any]], purpose: str = "") -> set[str]:
    """Names of the kernels that were called in the frames' time, for a purpose if one is named."""
    return {name for row in rows for name, calls in row["calls"].items() if not purpose or purpose in calls}


def happened(rows: list[dict[str, Any]], event: str) -> int:
    """How often an event was logged in the frames' time."""
    return sum(row["events"][event] for row in rows)


def tally(rows: list[dict[str, Any]]) -> list[tuple[Any, ...]]:
    """All that is counted, frame by frame."""
    return [
        (row["unknowns"], row["elements"], row["entries"], row["calls"], row["events"], row["stages"]) for row in rows
    ]
