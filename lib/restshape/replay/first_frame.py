"""The first frame of a scene, for validation and studies."""

from collections.abc import Sequence
from pathlib import Path

from petsc4py import PETSc

from restshape.application import application
from restshape.calibration import Calibration
from restshape.policy import policy
from restshape.replay.loop import Replay
from restshape.scene.edit_script import Script
from restshape.scene.load import load_scene


def first_frame(path: Path, overrides: Sequence[str] = (), comm: PETSc.Comm = PETSc.COMM_WORLD) -> Replay:
    """A replay of a scene's first shape after its only frame; `row` and `analysis` hold the result.

    Args:
        path: scene file.
        overrides: ``key=value`` as after --set.
        comm: PETSc communicator.
    """
    scene = load_scene(path, overrides)
    chosen = policy(scene.solve.policy)
    replay = Replay(scene, Script.empty(scene), application(scene.app), chosen, comm, Calibration.load())
    list(replay.frames())
    return replay
