"""A scene brought to one of its frames, for validation, studies and commands that look at one shape."""

from collections.abc import Sequence
from pathlib import Path

from petsc4py import PETSc

from restshape.errors import UserError
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
    scene = load_scene(path, overrides)
    replay = Replay(Request.of(scene), comm)
    list(replay.frames())
    return replay


def replay_of(scene: Scene, edits: Path | None) -> Replay:
    """A replay of a scene's edits before its first frame; `frames` goes through them, `analysis` holds each result.

    Args:
        scene: where the edits start.
        edits: script file; None: the first shape alone.

    Raises:
        UserError: the scene or the script makes no sense.
    """
    script = load_script(edits, scene) if edits else None
    try:
        return Replay(Request.of(scene, script), PETSc.COMM_WORLD)
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
    replay = replay_of(scene, edits)
    last = -1
    try:
        for last, _ in enumerate(replay.frames()):
            if last == frame:
                break
    except UserError as error:
        raise scene.located(error) from error
    if frame is not None and last != frame:
        one = f"the edits have {counted(last + 1, 'frame')}" if edits else "without edits there is one frame"
        raise UserError(one, f"--frame {frame}", f"use 0 to {last}" if last else "use 0, or leave it out")
    return replay
