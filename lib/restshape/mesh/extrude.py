"""Bodies over a plane mesh: tetrahedra in layers between a bottom and a top."""

from __future__ import annotations

import itertools
from typing import Literal

import numpy as np

from restshape import _kernels
from restshape.mesh.lagrange_space import EdgeInterpolation, LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.mesh.over_mesh import OverMesh
from restshape.mesh.thickness import Thickness, require_material
from restshape.scene.expressions import Value

DATUMS = {"bottom": 0.0, "middle": 0.5, "top": 1.0}
"""Share of the thickness that lies below z = 0, by which of the three is flat."""

_geometries = itertools.count(1)


class Extrusion(OverMesh):
    """Tetrahedra over a plane mesh, of its order, with the attributes that analyses use of a `Mesh`.

    Over each plane node stands a column of nodes, ``levels`` of them from bottom to top: node k over plane node i is
    ``i * levels + k``. So each rank's nodes are contiguous, and a field (n, f) is ``field.reshape(-1, levels, f)`` by
    columns. In each layer three tetrahedra stand over a triangle; those of the plane cell e are the rows
    ``3 * layers * e`` and on. Diagonals follow the plane nodes' `places`: they are the same on any number of ranks. Of
    second order curved sides of the plane mesh become curved walls.

    Args:
        plane: by reference; its nodes may move and its edges may flip, its nodes and cells keep their number.
        layers: how many, one or more.
        thickness: a number [m] or a formula of x and y [m]; parameters: of the scene, for the formula.
        flat: which of the faces, or the surface midway, lies in z = 0.

    Attributes:
        X: (n, 3) rest positions [m]; cells: (ne, 4 or 10) tetrahedra, corners first, then the middles of the sides
            (0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3).
        taken_off: (n2,) [m] at the plane nodes, by which the lower face lies above the place that the scene gives it.
        levels: nodes of a column; node_offsets: (ranks + 1,) nodes of rank r are node_offsets[r]:node_offsets[r + 1].
        geometry: version of the positions, another one in each body and after each `follow`.
        dim: of the cells; cell_type: their shape and order, as elements are named.

    Raises:
        ReplayProblem: the thickness is not positive somewhere.
    """

    dim = 3

    def __init__(
        self,
        plane: Mesh | LagrangeSpace,
        layers: int,
        thickness: Value,
        parameters: dict[str, float] | None = None,
        flat: Literal["bottom", "middle", "top"] = "middle",
    ) -> None:
        super().__init__(plane)
        self.plane, self.layers = plane, layers
        self.thickness = Thickness(thickness, parameters or {})
        self.datum = DATUMS[flat]
        self.order = 1 if plane.cell_type == "tri3" else 2
        self.cell_type = {1: "tet4", 2: "tet10"}[self.order]
        self.levels = self.order * layers + 1
        self.node_offsets = (plane.node_offsets * self.levels).astype(np.int32)
        self.X = np.empty((len(plane.X) * self.levels, 3))
        self.cells = np.empty((3 * layers * len(plane.cells), 4 if self.order == 1 else 10), dtype=np.int32)
        self._h, self.taken_off = self.thickness.at(plane.X), np.zeros(len(plane.X))
        _kernels.split_prisms(plane.cells, plane.places, layers, self.cells)
        self._place()

    @property
    def corners(self) -> np.ndarray:
        """Corners (ne, 4) of the tetrahedra."""
        return self.cells[:, :4]

    @property
    def mesh(self) -> Mesh:
        """The plane mesh, of corners alone."""
        return self.plane.mesh

    @property
    def interpolations(self) -> tuple[EdgeInterpolation, ...]:
        """What flips did to nodes of the plane mesh since the last solution."""
        return self.plane.interpolations

    @property
    def cell_region(self) -> np.ndarray:
        """Region (ne,) of each tetrahedron, see `Mesh`."""
        return np.repeat(self.plane.cell_region, 3 * self.layers)

    def nodes_of(self, name: str) -> np.ndarray:
        """Sorted nodes of all columns over an entity's; see `Mesh.nodes_of`.

        Raises:
            UserError: there is no such entity.
        """
        return self.columns(self.plane.nodes_of(name)).ravel()

    def cells_of(self, name: str) -> np.ndarray:
        """Tetrahedra over the triangles inside an entity; see `Mesh.cells_of`.

        Raises:
            UserError: there is no such entity.
        """
        return self.over(self.plane.cells_of(name))

    def columns(self, nodes: np.ndarray) -> np.ndarray:
        """Nodes (k, levels), from bottom to top, over plane nodes (k,)."""
        return (np.asarray(nodes, dtype=np.int32)[:, None] * self.levels + np.arange(self.levels)).astype(np.int32)

    def over(self, cells: np.ndarray) -> np.ndarray:
        """Tetrahedra (3 * layers * k,) over plane cells (k,)."""
        block = 3 * self.layers
        return (np.asarray(cells, dtype=np.int32)[:, None] * block + np.arange(block)).ravel().astype(np.int32)

    def follow(self, changed: np.ndarray | None = None) -> np.ndarray:
        """Go where the plane mesh is; returns which tetrahedra (k,) are others than before.

        Args:
            changed: plane cells that flips have changed.

        Raises:
            ReplayProblem: the thickness is not positive somewhere; all is as before.
        """
        if self.thickness.varies:
            h = self.thickness.at(self.plane.X)
            require_material(self.plane.X, h - self.taken_off)
            self._h = h
        self._place()
        if changed is None or not len(changed):
            return np.empty(0, dtype=np.int32)
        _kernels.split_prisms(self.plane.cells, self.plane.places, self.layers, self.cells, changed)
        return self.over(changed)

    def motion(self, motion: np.ndarray) -> np.ndarray:
        """Velocities (k, n, 3) of the nodes from those (k, n2, 2) of the plane ones, whose place sets the thickness.

        Raises:
            ReplayProblem: the thickness has no derivative somewhere.
        """
        result = np.empty((len(motion), *self.X.shape))
        for rates, out in zip(motion, result):
            rates = np.ascontiguousarray(rates)
            self._columns_at(rates, self.thickness.rate(self.plane.X, rates), out)
        return result

    def take_off(self, depth: np.ndarray) -> None:
        """Take depths (n2,) [m] off underneath: the lower face rises, the nodes above it share the way.

        Raises:
            ReplayProblem: nothing is left somewhere; all is as before.
        """
        require_material(self.plane.X, self._h - depth)
        self.taken_off = np.array(depth, dtype=float)
        self._place()

    def thickness_motion(self, rates: np.ndarray) -> np.ndarray:
        """Velocities (n, 3) of the nodes where the lower face goes down with rates (n2,), and the upper one stays."""
        result = np.zeros_like(self.X)
        result[:, 2] = np.outer(rates, -self._shares()).ravel()
        return result

    def interpolate(self, field: np.ndarray, interpolations: tuple[EdgeInterpolation, ...]) -> np.ndarray:
        """A field (n, f) after flips: values of the old one where the columns in flipped edges now are.

        Args:
            field: before; it stays as it is.
            interpolations: of the plane mesh, in their order.
        """
        if not interpolations:
            return field
        result = field.reshape(len(self.plane.X), -1).copy()
        for nodes, stencil, weights in interpolations:
            result[nodes] = np.einsum("ij,ijk->ik", weights, result[stencil])
        return result.reshape(field.shape)

    def _place(self) -> None:
        self._columns_at(self.plane.X, self._h, self.X)
        if self.taken_off.any():
            self.X[:, 2] += np.outer(self.taken_off, self._shares()).ravel()
        self.geometry = next(_geometries)

    def _shares(self) -> np.ndarray:
        """The share (levels,) that each node of a column has in what its lowest one does."""
        return np.linspace(1.0, 0.0, self.levels)

    def _columns_at(self, plane: np.ndarray, thickness: np.ndarray, out: np.ndarray) -> None:
        _kernels.extrude_nodes(plane, thickness, self.levels, self.datum, out)
