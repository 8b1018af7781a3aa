"""A scene brought to one of its frames, for validation, studies and commands that look at one shape."""

from collections.abc import Sequence
from pathlib import Path

from petsc4py import PETSc

from restshape.errors import UserError
from restshape.interface.run import Run
from restshape.outputs.si_numbers import counted
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene
from restshape.scene.model import Scene


def first_frame(path: Path, overrides: Sequence[str] = (), comm: PETSc.Comm = PETSc.COMM_WORLD) -> Replay:
    """A replay of a scene's first shape after its only frame; `row` and `analysis` hold the result.

    Args:
        path: scene file.
        overrides: ``key=value`` as after --set.
        comm: PETSc communicator.
    """
    run = Run(Request.of(load_scene(path, overrides)), summed=False, comm=comm)
    for _ in run:
        pass
    return run.replay


def run_of(scene: Scene, edits: Path | None) -> Run:
    """The run of a scene's edits before its first frame; `replay.analysis` holds the result of each.

    Args:
        scene: where the edits start.
        edits: script file; None: the first shape alone.

    Raises:
        UserError: the scene or the script makes no sense.
    """
    script = load_script(edits, scene) if edits else None
    try:
        return Run(Request.of(scene, script), summed=False)
    except UserError as error:
        raise scene.located(error) from error


def replayed_to(scene: Scene, edits: Path | None, frame: int | None) -> Replay:
    """A replay of a scene's edits that stands at one of their frames; `analysis` holds its result.

    Args:
        scene: where the edits start.
        edits: script file; None: the first shape alone.
        frame: its number; None: the last one.

    Raises:
        UserError: there is no such frame, or none at all.
    """
    run = run_of(scene, edits)
    last = -1
    try:
        for last, _ in enumerate(run):
            if last == frame:
                break
    except UserError as error:
        raise scene.located(error) from error
    if frame is not None and last != frame:
        one = f"the edits have {counted(last + 1, 'frame')}" if edits else "without edits there is one frame"
        raise UserError(one, f"--frame {frame}", f"use 0 to {last}" if last else "use 0, or leave it out")
    return run.replay
