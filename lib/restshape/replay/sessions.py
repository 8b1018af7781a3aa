"""The session of a script: of a shape with an outline, or of the application's own kind."""

from typing import Protocol, cast

from restshape.application import application as application_named
from restshape.mesh.advance import MeshUpdate
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.scene.edit_script import Script
from restshape.scene.model import Scene
from restshape.shape.outline import Outline
from restshape.shape.protocol import Session
from restshape.shape.session import EditFrame


class Follower(Protocol):
    """What follows the frames of a session: a moving mesh, or models of the application's own."""

    @property
    def mesh(self) -> Mesh: ...
    @property
    def field_mesh(self) -> Mesh | LagrangeSpace:
        """What the unknowns of the next solve live on."""

    def area(self) -> float:
        """Area of the mesh [m^2]; not a number where there is none."""

    def update(self, frame: EditFrame) -> MeshUpdate:
        """Go where a frame leads; what that did.

        Raises:
            ReplayProblem: it cannot; all is as before.
            UserError: the scene's new values make no sense; likewise.
        """

    def solved(self) -> None:
        """Take note that the frame has a solution on `field_mesh`, which holds all that flips have done to it."""

    def rollback(self) -> None:
        """Be as before the last frame, which has no solution."""


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
    return cast(Session, application.editing.make_session(scene, script, application, *imported))
