"""The area of a mesh that moves: of a large one from its border alone, where that is closed."""

from __future__ import annotations

from restshape import _kernels
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh

MANY = 30_000
"""Cells from which on a border takes less than they do."""
CLOSED = 1e-9
"""Of the area, by which a border that is closed may differ from the cells by rounding."""


class MeshArea:
    """Areas of meshes, frame after frame; whether a border is closed is found once a topology.

    Triangles with straight sides have together the area inside of their border. A large mesh has few nodes there, while
    a sum over its cells reads all of its memory. Lines inside, such as those of regions, are no border.
    """

    def __init__(self) -> None:
        self._known: tuple[object, int] = (None, 0)
        self._closed = False

    def __call__(self, space: Mesh | LagrangeSpace) -> float:
        """The area [m^2] of a mesh where its nodes are now."""
        straight = space.X.shape[1] == 2 and space.cells.shape[1] == 3
        if not straight or len(space.cells) < MANY:
            return _kernels.total_area(space.X, space.cells)
        if self._known != (space, space.topology):
            whole = _kernels.total_area(space.X, space.cells)
            self._closed = bool(abs(border_area(space) - whole) <= CLOSED * abs(whole))
            self._known = space, space.topology
        return border_area(space) if self._closed else _kernels.total_area(space.X, space.cells)


def border_area(mesh: Mesh | LagrangeSpace) -> float:
    """The area [m^2] on the left of the facets of a mesh in the plane, if they are closed."""
    start, end = (mesh.X[nodes] - mesh.X[0] for nodes in mesh.facets.T)
    return 0.5 * float((start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0]).sum())
