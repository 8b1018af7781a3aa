"""Runs a whole replay and sums it up."""

# More than 15 modules: a whole run reads, replays, checks and sums up, each by a module of its own.
import csv
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from petsc4py import PETSc

from restshape.analysis.analysis import RowValues
from restshape.application import application
from restshape.calibration import Calibration
from restshape.errors import UserError
from restshape.policy import policy
from restshape.replay.columns import columns
from restshape.replay.loop import Replay
from restshape.replay.parity import Parity
from restshape.replay.petsc_options import refusal
from restshape.replay.recorder import Recorder
from restshape.replay.request import Request
from restshape.replay.summary import summarise
from restshape.scene.load import load_scene
from restshape.scene.script import load_script
from restshape.surroundings import petsc_options


def run_replay(
    request: Request,
    recorder: Recorder | None = None,
    parity: bool = False,
    csv: Path | None = None,
    on_frame: Callable[[], None] = lambda: None,
) -> dict[str, Any]:
    """The summary of a replay on all ranks of PETSc's world, as `replay --json` writes it, with all `rows`.

    Args:
        request: what is to be replayed.
        recorder: takes each frame; on rank 0 only.
        parity: compare each frame with a cold solve on the same mesh.
        csv: file for a row of numbers a frame.
        on_frame: called after each frame.

    Raises:
        UserError: the scene cannot be simulated, or a file cannot be written.
    """
    comm = PETSc.COMM_WORLD
    first = comm.rank == 0
    replay = _replay(request, recorder)
    if recorder:
        version = list(PETSc.Sys.getVersion())
        recorder.add_header({"ranks": comm.size, "petsc": version, "petsc_in_effect": petsc_options()})
    check = Parity(replay) if parity else None
    rows, interrupted = [], False
    names = list(columns(list(request.scene.quantities), request.application.own_columns(request.scene)))
    with _table(csv if first else None, names) as table:
        try:
            for row in _frames(replay, request.petsc):
                if check:
                    row |= check()
                rows.append(row)
                if table:
                    table(row)
                on_frame()
        except KeyboardInterrupt:
            # The other ranks know nothing of it, and one that waits for this one cannot be determined.
            if comm.size > 1 or not rows:
                raise
            interrupted = True
    summary = summarise(rows, request.policy.name, comm.size, replay.analysis.estimated_quantity) | {
        "interrupted": interrupted
    }
    if request.application.report:
        summary |= request.application.report.summarised(rows)
    if check:
        summary["parity"] = check.summary()
    return summary


def _replay(request: Request, recorder: Recorder | None) -> Replay:
    """The replay, with its solvers set up."""
    try:
        return Replay.of(request, PETSc.COMM_WORLD, recorder)
    except PETSc.Error as error:
        if not request.petsc:
            raise
        raise refusal(error, request.petsc) from error


def _frames(replay: Replay, petsc: Sequence[str]) -> Iterator[RowValues]:
    """The rows of all frames; where PETSc fails in the first one, what it says against the user's words."""
    frames = replay.frames()
    try:
        yield next(frames)
    except PETSc.Error as error:
        # On several ranks the others may not have failed.
        if not petsc or replay.comm.size > 1:
            raise
        raise refusal(error, petsc) from error
    yield from frames


def replay_files(
    scene: Path, edits: Path, name: str, overrides: Sequence[str] = (), predict: str = "none"
) -> dict[str, Any]:
    """The summary of a replay of files under the policy `name`, for studies; nothing is recorded.

    Args:
        scene: scene file.
        edits: edit script.
        name: of the policy.
        overrides: ``key=value`` as after --set.
        predict: as after --predict.
    """
    read = load_scene(scene, overrides)
    script = load_script(edits, read)
    return run_replay(Request(read, script, application(read.app), policy(name), Calibration.load(), predict=predict))


@contextmanager
def _table(path: Path | None, names: list[str]) -> Iterator[Callable[[RowValues], None] | None]:
    """A function that writes one row to the CSV file, line by line so that none is lost; None without a file."""
    if path is None:
        yield None
        return
    with _user_errors(path):
        file = path.open("w", newline="", buffering=1)
    writer = csv.DictWriter(file, names, extrasaction="ignore")

    def write(row: RowValues) -> None:
        with _user_errors(path):
            writer.writerow(row)

    try:
        with _user_errors(path):
            writer.writeheader()
        yield write
    finally:
        with _user_errors(path):
            file.close()


@contextmanager
def _user_errors(path: Path) -> Iterator[None]:
    """Turn a failure to write into a user's error."""
    try:
        yield
    except OSError as error:
        raise UserError(
            f"cannot write: {error.strerror}", str(path), "choose a place with room that may be written"
        ) from error
