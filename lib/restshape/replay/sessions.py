"""The session of a script: of a shape with an outline, or of planks."""

from typing import Any

from restshape.application import application as application_named
from restshape.scene.model import Scene
from restshape.scene.script import Script
from restshape.shape.outline import Outline
from restshape.shape.session import EditSession


def session_of(scene: Scene, script: Script, outline: Outline | None = None) -> Any:
    """The session that turns a script's events into frames.

    Args:
        scene: where it starts.
        script: validated events.
        outline: the shape, when it does not come from the scene (imported meshes).

    Raises:
        UserError: the scene's shape, or its piece, is not valid.
    """
    application = application_named(scene.app)
    if application.planks:
        return application.make_session()(scene, script, application)
    return EditSession(scene, script, outline=outline)
