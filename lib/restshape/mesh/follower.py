"""What follows the frames of a session."""

from typing import Protocol

import numpy as np

from restshape.mesh.advance import MeshUpdate
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.mesh.moved_meshes import OtherMesh
from restshape.shape.script_frame import ScriptFrame


class Follower(Protocol):
    """What follows the frames of a session: a moving mesh, or models of the application's own."""

    @property
    def mesh(self) -> Mesh: ...
    @property
    def field_mesh(self) -> Mesh | LagrangeSpace:
        """What the unknowns of the next solve live on."""

    def area(self) -> float:
        """Area of the mesh [m^2]; not a number where there is none."""

    def update(self, frame: ScriptFrame) -> MeshUpdate:
        """Go where a frame leads; what that did.

        Raises:
            ReplayProblem: it cannot; all is as before.
            UserError: the scene's new values make no sense; likewise.
        """

    def other_meshes(self, old: Mesh | LagrangeSpace | None) -> tuple[OtherMesh, ...]:
        """Meshes beside which the last update's flips, or new mesh, are seen; none where nothing can be compared.

        Args:
            old: of the update.
        """

    @property
    def linear_motion(self) -> np.ndarray | None:
        """Displacements (2, n, d) of the nodes of `field_mesh` a unit of the hand's coefficients.

        None where they do not follow the hand linearly.
        """

    def solved(self) -> None:
        """Take note that the frame has a solution on `field_mesh`, which holds all that flips have done to it."""

    def rollback(self) -> None:
        """Be as before the last frame, which has no solution."""
