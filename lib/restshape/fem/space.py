"""What a finite-element space offers: nodes and cells that unknowns live on, over a mesh that moves."""

from typing import Protocol, Self, runtime_checkable

import numpy as np

from restshape.mesh.lagrange_space import EdgeInterpolation
from restshape.mesh.mesh import Mesh
from restshape.mesh.transfer import FieldNodes
from restshape.shape.outline import Outline


@runtime_checkable
class Space(FieldNodes, Protocol):
    """Nodes and cells over a mesh whose nodes may move and whose edges may flip.

    Attributes:
        X: (n, d) material coordinates [m], changed in place when the mesh moves.
        cells: (ne, k) int32 nodes whose X an element reads.
        dofs: (ne, k) int32 nodes whose unknowns it reads: `cells` itself, but at seams and under periodicity.
        dof_X: (m, d) X of the nodes that `dofs` number, the rows of unknowns: X, but at seams and in mixed spaces.
        corners: (ne, c) int32 the corners of the cells.
        cell_region: (ne,) int32 0, or i + 1 for the i-th region of the outline.
        node_offsets: (ranks + 1,) int32 nodes of rank r are node_offsets[r]:node_offsets[r + 1].
        topology: version of the connectivity; geometry: version of the positions.
        outline: whose entities the mesh resolves.
        mesh: plane mesh that it stands on; of a mesh itself.
        interpolations: what flips did to nodes in the middle of edges since the last solution, see `interpolate`.
        dim: of the cells; cell_type: their shape and order, as elements are named ("tri3", "tet10").
    """

    @property
    def dofs(self) -> np.ndarray: ...
    @property
    def dof_X(self) -> np.ndarray: ...
    @property
    def cell_region(self) -> np.ndarray: ...
    @property
    def node_offsets(self) -> np.ndarray: ...
    @property
    def topology(self) -> int: ...
    @property
    def geometry(self) -> int: ...
    @property
    def outline(self) -> Outline: ...
    @property
    def mesh(self) -> Mesh: ...
    @property
    def interpolations(self) -> tuple[EdgeInterpolation, ...]: ...

    def nodes_of(self, name: str) -> np.ndarray:
        """Sorted nodes (k,) int32 of an entity of the outline.

        Raises:
            UserError: there is no such entity.
        """

    def cells_of(self, name: str) -> np.ndarray:
        """Cells (k,) int32 inside an entity of the outline.

        Raises:
            UserError: there is no such entity.
        """

    def follow(self, changed: np.ndarray) -> np.ndarray:
        """Go where the mesh below is.

        Args:
            changed: (k,) its cells that flips have changed.

        Returns:
            (m,) int32 cells of this space that are others than before.
        """

    def interpolate(self, field: np.ndarray, interpolations: tuple[EdgeInterpolation, ...]) -> np.ndarray:
        """A field (n, f) after flips, at the new places of nodes of flipped edges.

        Args:
            field: before the flips; it stays as it is.
            interpolations: what the flips did, in their order.
        """

    def at_dofs(self, field: np.ndarray) -> np.ndarray:
        """A field (n, k) of the nodes X as one (m, k) of the rows of unknowns, which lie at `dof_X`."""

    def project(self, old: Self, field: np.ndarray) -> np.ndarray:
        """Unknowns (m, f) of this space from those of another one of the same kind, on nearly the same shape.

        Args:
            old: where they live.
            field: (m_old, f), one for each of its rows.
        """


class PlaneSpace(Space, Protocol):
    """A space over a plane mesh, which knows the mesh's facets on the outline.

    Attributes:
        facets: (nf, 2) or (nf, 3) int32 nodes of each: both ends, then the middle.
    """

    @property
    def facets(self) -> np.ndarray: ...

    def on_corners(self, gradient: np.ndarray) -> np.ndarray:
        """A gradient (corners, d) by the places of the corners, of one (n, d) by those of all nodes, which follow."""

    def facets_of(self, name: str) -> np.ndarray:
        """Facets (k,) int32 on an entity of the outline.

        Raises:
            UserError: there is no such entity.
        """
