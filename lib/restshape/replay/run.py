"""Runs a whole replay and sums it up."""

import csv
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO

from petsc4py import PETSc

from restshape.application import application
from restshape.calibration import Calibration
from restshape.errors import UserError
from restshape.policy import policy
from restshape.replay.columns import columns
from restshape.replay.loop import Replay
from restshape.replay.parity import Parity
from restshape.replay.recorder import Recorder
from restshape.replay.request import Request
from restshape.replay.summary import summarise
from restshape.scene.load import load_scene
from restshape.scene.script import load_script


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
    replay = Replay(
        request.scene, request.script, request.application, request.policy, comm, request.calibration, recorder
    )
    if recorder:
        recorder.add_header({"ranks": comm.size, "petsc": list(PETSc.Sys.getVersion())})
    check = Parity(replay) if parity else None
    rows = []
    with _table(csv if first else None, list(request.scene.quantities)) as table:
        for row in replay.frames():
            if check:
                row |= check()
            rows.append(row)
            if table:
                table(row)
            on_frame()
    summary = summarise(rows, request.policy.name, comm.size)
    if check:
        summary["parity"] = check.summary()
    return summary


def replay_files(scene: Path, edits: Path, name: str, overrides: Sequence[str] = ()) -> dict[str, Any]:
    """The summary of a replay of files under the policy `name`, for studies; nothing is recorded.

    Args:
        scene: scene file.
        edits: edit script.
        name: of the policy.
        overrides: ``key=value`` as after --set.
    """
    read = load_scene(scene, overrides)
    script = load_script(edits, read)
    return run_replay(Request(read, script, application(read.app), policy(name), Calibration.load()))


@contextmanager
def _table(path: Path | None, quantities: list[str]) -> Iterator[Any]:
    """A function that writes one row to the CSV file, line by line so that none is lost; None without a file."""
    if path is None:
        yield None
        return
    try:
        file: TextIO = path.open("w", newline="", buffering=1)
    except OSError as error:
        raise UserError(
            f"cannot write: {error.strerror}", str(path), "choose a folder that exists and may be written"
        ) from error
    with file:
        writer = csv.DictWriter(file, list(columns(quantities)), extrasaction="ignore")
        writer.writeheader()
        yield writer.writerow
