"""What `restshape replay --predict` does in a scene."""

from __future__ import annotations

from petsc4py import PETSc

from restshape.application import application_of
from restshape.calibration import Calibration
from restshape.errors import UserError
from restshape.policy import policy
from restshape.replay.loop import Replay
from restshape.replay.refined_frames import RefinedFrames
from restshape.replay.request import Request
from restshape.scene.edit_script import Script
from restshape.scene.model import Scene

Line = tuple[str, str, str]
NAME = "--predict gmls"


def prediction(scene: Scene, script: Script | None) -> Line:
    """What is predicted of drags with ``--predict gmls``, or why nothing is: what, which, why."""
    if script is None:
        return NAME, "nothing", "there is no script, and so no drag"
    ways = policy(scene.solve.policy)
    request = Request(scene, script, application_of(scene), ways, Calibration.load(), predict="gmls")
    try:
        found = Replay(request, PETSc.COMM_SELF).prediction
    except UserError as error:
        return NAME, "nothing", f"refused: {error.what}"
    spec = scene.predict
    mesh = "the mesh"
    if isinstance(found, RefinedFrames):
        mesh = f"mesh {found.levels.coarse} of {found.levels.finest}, shown on mesh {found.levels.finest}"
    time = f"{1e3 * spec.frame_time:.3g} ms of solver steps in a frame"
    why = f"predict.levels, .samples, .frame_time; estimates: solve.estimate = {scene.solve.estimate}"
    return NAME, f"drags on {mesh}, from {spec.samples} samples at most, {time}", why
