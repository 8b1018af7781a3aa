"""Plates over a plane mesh: its nodes, with the thickness there as a third coordinate."""

from __future__ import annotations

import itertools

import numpy as np

from restshape.mesh.lagrange_space import EdgeInterpolation
from restshape.mesh.mesh import Mesh
from restshape.mesh.over_mesh import OverMesh
from restshape.mesh.thickness import Thickness, require_material
from restshape.scene.expressions import Value

_geometries = itertools.count(1)


class PlateMesh(OverMesh):
    """The nodes of a plane mesh with the plate's thickness, with the attributes that analyses use of a `Mesh`.

    Args:
        plane: by reference; its nodes may move and its edges may flip, its nodes and cells keep their number.
        thickness: a number [m] or a formula of x and y [m]; parameters: of the scene, for the formula.

    Attributes:
        X: (n, 3) places in the plane and thickness there [m].
        taken_off: (n,) [m] of the thickness that the scene gives, what has been taken off underneath.
        dim: of the cells; cell_type: their shape and order, as elements are named.
        geometry: version of `X`, another one in each plate and after each `follow`.

    Raises:
        ReplayProblem: the thickness is not positive somewhere.
    """

    dim = 2
    cell_type = "tri3"

    def __init__(self, plane: Mesh, thickness: Value, parameters: dict[str, float] | None = None) -> None:
        super().__init__(plane)
        self.plane, self.thickness = plane, Thickness(thickness, parameters or {})
        self.X = np.empty((len(plane.X), 3))
        self.taken_off = np.zeros(len(plane.X))
        self._h = self.thickness.at(plane.X)
        self._place()

    @property
    def cells(self) -> np.ndarray:
        """Triangles (ne, 3): the plane mesh's."""
        return self.plane.cells

    @property
    def corners(self) -> np.ndarray:
        """Corners (ne, 3) of the triangles: all their nodes."""
        return self.plane.cells

    @property
    def node_offsets(self) -> np.ndarray:
        """Offsets (ranks + 1,) of the ranks' nodes: the plane mesh's."""
        return self.plane.node_offsets

    @property
    def mesh(self) -> Mesh:
        """The plane mesh, of corners alone."""
        return self.plane.mesh

    @property
    def interpolations(self) -> tuple[EdgeInterpolation, ...]:
        """What flips did to nodes of the plane mesh since the last solution."""
        return self.plane.interpolations

    def nodes_of(self, name: str) -> np.ndarray:
        """Sorted nodes of an entity; see `Mesh.nodes_of`.

        Raises:
            UserError: there is no such entity.
        """
        return self.plane.nodes_of(name)

    def rim(self) -> np.ndarray:
        """Whether (ne, 3) the sides (0, 1), (1, 2), (2, 0) of each triangle are the plate's boundary."""
        plane = self.plane
        loops = [loop for loop in plane.outline.loops if loop.kind != "region"]
        outer = np.isin(plane.facet_edge, [edge for loop in loops for edge, _ in loop.edges])
        cells = plane.facet_cell[outer]
        result = np.zeros(self.cells.shape, dtype=bool)
        # The material is on the left, so that a facet begins where the side does.
        result[cells, (self.cells[cells] == plane.facets[outer, :1]).argmax(axis=1)] = True
        return result

    def follow(self, changed: np.ndarray | None = None) -> np.ndarray:
        """Go where the plane mesh is; returns which triangles (k,) are others than before: those that are given.

        Raises:
            ReplayProblem: the thickness is not positive somewhere; all is as before.
        """
        if self.thickness.varies:
            h = self.thickness.at(self.plane.X)
            require_material(self.plane.X, h - self.taken_off)
            self._h = h
        self._place()
        return np.empty(0, dtype=np.int32) if changed is None else changed

    def interpolate(self, field: np.ndarray, interpolations: tuple) -> np.ndarray:
        """A field (n, f) after flips; see `Mesh.interpolate`."""
        return self.plane.interpolate(field, interpolations)

    def motion(self, motion: np.ndarray) -> np.ndarray:
        """Velocities (k, n, 3) of `X` from those (k, n, 2) of the plane nodes: the thickness is that of the place.

        Raises:
            ReplayProblem: the thickness has no derivative somewhere.
        """
        rates = [self.thickness.rate(self.plane.X, dX) for dX in motion]
        return np.concatenate([motion, np.array(rates)[..., None]], axis=2)

    def take_off(self, depth: np.ndarray) -> None:
        """Make the plate thinner than the scene has it, by depths (n,) [m] at the nodes, which these keep.

        Raises:
            ReplayProblem: nothing is left somewhere; all is as before.
        """
        require_material(self.plane.X, self._h - depth)
        self.taken_off = np.array(depth, dtype=float)
        self._place()

    def thickness_motion(self, rates: np.ndarray) -> np.ndarray:
        """Velocities (n, 3) of `X` where the thickness at the nodes grows with rates (n,)."""
        result = np.zeros_like(self.X)
        result[:, 2] = rates
        return result

    def _place(self) -> None:
        self.X[:, :2] = self.plane.X
        self.X[:, 2] = self._h - self.taken_off
        self.geometry = next(_geometries)
