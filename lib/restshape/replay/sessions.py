"""The session of a script: of a shape with an outline, or of the application's own kind."""

from restshape.application import application as application_named
from restshape.scene.edit_script import Script
from restshape.scene.model import Scene
from restshape.shape.outline import Outline
from restshape.shape.protocol import Session


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
    imported = () if outline is None else (outline,)
    return application.editing.make_session(scene, script, application, *imported)
