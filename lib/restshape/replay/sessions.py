"""The session of a script: of a shape with an outline, or of the application's own kind."""

from restshape.application import application as application_named
from restshape.scene.model import Scene
from restshape.scene.script import Script
from restshape.shape.outline import Outline
from restshape.shape.protocol import Session
from restshape.shape.session import EditSession


def session_of(scene: Scene, script: Script, outline: Outline | None = None) -> Session:
    """The session that turns a script's events into frames.

    Args:
        scene: where it starts.
        script: validated events.
        outline: the shape, when it does not come from the scene (imported meshes).

    Raises:
        UserError: what the scene starts from is not valid.
    """
    application = application_named(scene.app)
    if application.session:
        return application.make_session()(scene, script, application)
    return EditSession(scene, script, outline=outline)
