"""What `restshape replay --predict` does in a scene."""

from __future__ import annotations

from restshape.errors import UserError
from restshape.interface.run import Run
from restshape.replay.refined_frames import RefinedFrames
from restshape.replay.request import Request
from restshape.scene.edit_script import Press, Pull, Script
from restshape.scene.event_line import EventLine
from restshape.scene.model import Scene
from restshape.shape.hand.arc_grab import is_arc
from restshape.shape.hand.pin_drag import is_in_space
from restshape.shape.protocol import Session
from restshape.shape.session import EditSession

Line = tuple[str, str, str]
NAME = "--predict gmls"


def _holds_the_shape(event: EventLine, session: Session) -> bool:
    """Whether an event is a hand whose drags are predicted: on the shape, but no whole panel, and no arc that bends."""
    if isinstance(event, Pull) and isinstance(session, EditSession):
        outline = session.outline
        return event.pins is not None or event.on not in outline.layout.entities or not is_arc(outline, event.on)
    if not isinstance(event, Press) or not isinstance(session, EditSession):
        return event.do in ("press", "pull")
    return not is_in_space(session.outline, session.scene, event.on)


def prediction(scene: Scene, script: Script | None) -> Line:
    """What is predicted of drags with ``--predict gmls``, or why nothing is: what, which, why."""
    if script is None:
        return NAME, "nothing", "there is no script, and so no drag"
    request = Request.of(scene, script, predict="gmls")
    try:
        replay = Run(request, summed=False).replay
    except UserError as error:
        return NAME, "nothing", f"refused: {error.what}"
    if not any(_holds_the_shape(event, replay.session) for event in script.events):
        bent = any(isinstance(event, Pull) for event in script.events)
        return NAME, "nothing", "bending an arc is not linear" if bent else "no hand holds the shape"
    found, spec = replay.prediction, scene.predict
    mesh = "the mesh"
    if isinstance(found, RefinedFrames):
        mesh = f"mesh {found.levels.coarse} of {found.levels.finest}, shown on mesh {found.levels.finest}"
    time = f"{1e3 * spec.frame_time:.3g} ms of solver steps in a frame"
    why = f"predict.levels, .samples, .frame_time; estimates: solve.estimate = {scene.solve.estimate}"
    return NAME, f"drags on {mesh}, from {spec.samples} samples at most, {time}", why
