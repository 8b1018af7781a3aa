"""How the nodes of a mesh follow a number of the scene that gives the shape."""

from collections.abc import Sequence

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.mesh.relocate import BoundaryNodes, motion
from restshape.scene.model import Scene
from restshape.scene.panels import frames_of
from restshape.shape.build import unchecked_outline
from restshape.shape.given_shape import followed, in_frames, same_layout
from restshape.shape.hand.gesture import other_curves
from restshape.shape.outline import Outline


def outline_velocity(
    space: Mesh | LagrangeSpace, scene: Scene, ends: Sequence[Scene], step: float
) -> np.ndarray | None:
    """Velocities (n, 2) of the nodes of a plane mesh a unit of a number; None where that moves no part of the outline.

    Control points are differenced, and nodes follow them harmonically, as under an edit.

    Args:
        space: the mesh as it lies, also after edits by hand.
        scene: of the number as it is; ends: with the number a step larger, and a step smaller.
        step: of the number.

    Raises:
        UserError: the number changes how arcs or splines bend, which nodes do not follow linearly, or which edges
            there are.
    """
    along = point_velocity(space.mesh.outline, scene, ends, step)
    return None if along is None else node_velocity(space, along)[1]


def node_velocity(space: Mesh | LagrangeSpace, along: Reals) -> tuple[Reals, Reals]:
    """Velocities of the corners (m, 2) and of all nodes (n, 2) of a plane mesh.

    Args:
        space: the mesh as it lies; along: (k, 2) velocities of the control points of its outline.
    """
    mesh = space.mesh
    basis = np.stack([along, np.zeros_like(along)])
    corners = motion(mesh, BoundaryNodes(mesh).basis(mesh.outline, basis), "harmonic")
    return corners[0], space.motion(corners, basis)[0]


def point_velocity(outline: Outline, scene: Scene, ends: Sequence[Scene], step: float) -> Reals | None:
    """Velocities (k, 2) of the control points of an outline a unit of a number; arguments as of `outline_velocity`."""
    if all(end.shape == scene.shape for end in ends):
        return None
    before = unchecked_outline(scene.shape, scene.folder)
    # Where panels are laid, such as in rows, changes nothing of them.
    targets = [in_frames(unchecked_outline(end.shape, end.folder), frames_of(end), frames_of(scene)) for end in ends]
    if any(not same_layout(target.layout, before.layout) for target in targets):
        what = "as this number changes the shape gets other edges, and so another mesh"
        raise UserError(what, do="choose another value of it, or name another number")
    moved = [followed(outline, before, target) for target in targets]
    if any(other_curves(outline, end) for end in moved):
        what = "this number changes how edges of the shape bend, and derivatives are by what moves their points alone"
        raise UserError(what, do="give arcs by their bulge, and splines by their knots")
    return (moved[0].points - moved[1].points) / (2.0 * step)
