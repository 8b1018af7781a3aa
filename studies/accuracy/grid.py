"""Fields on plane triangles of either order, evaluated at any points."""

from dataclasses import dataclass

import numpy as np

from restshape import _kernels
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.mesh.quadratic_basis import quadratic_basis

SLOPES = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
"""Of the three basis functions of a first-order triangle, with respect to reference coordinates."""

NEXT, BEFORE = [1, 2, 0], [2, 0, 1]


@dataclass(frozen=True)
class Grid:
    """A mesh as it lies in one frame.

    Args:
        X: (n, 2) nodes [m].
        cells: (ne, 3) or, of second order, (ne, 6) int32.
        regions: (ne,) of the shape's regions that the cells lie in, as of `Mesh.cell_region`.
    """

    X: np.ndarray
    cells: np.ndarray
    regions: np.ndarray

    @classmethod
    def of(cls, mesh: Mesh | LagrangeSpace) -> "Grid":
        """A copy of a mesh, which stays where it is when the mesh moves on."""
        return cls(mesh.X.copy(), mesh.cells.copy(), mesh.cell_region.copy())

    def same(self, other: "Grid") -> bool:
        """Whether another grid has the same cells at the same places, down to rounding."""
        if self.X.shape != other.X.shape or not np.array_equal(self.cells, other.cells):
            return False
        return bool(np.allclose(self.X, other.X, rtol=0.0, atol=1e-12 * np.ptp(self.X)))

    def locate(self, points: np.ndarray, regions: np.ndarray) -> "Places":
        """Places of the grid at points (m, 2) [m], each in a cell of its own region; see `Mesh.cell_region`.

        Where none holds it, a point is put on the nearest boundary point of the region's cells: between chord and arc
        of an interface, cells of the other material say nothing of it.

        Args:
            points: (m, 2) [m].
            regions: (m,) that the points lie in; where the grid has no cell of one, all its cells are looked at.
        """
        found, reference = np.empty(len(points), dtype=np.int64), np.empty((len(points), 2))
        for region in np.unique(regions):
            own, cells = np.flatnonzero(regions == region), np.flatnonzero(self.regions == region)
            cells = cells if len(cells) else np.arange(len(self.cells))
            part, reference[own] = _located(self.X, self.cells[cells], points[own])
            found[own] = cells[part]
        return Places(self, found, reference)

    def centroids(self) -> "Places":
        """The middle of every cell."""
        return Places(self, np.arange(len(self.cells)), np.full((len(self.cells), 2), 1.0 / 3.0))


def _located(X: np.ndarray, cells: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The cell (m,) of each point (m, 2) [m], and its coordinates (m, 2) in it, as of `Places`."""
    if cells.shape[1] == 3:
        found, barycentric = _kernels.locate(X, cells, points)
    else:
        corners = np.ascontiguousarray(cells[:, :3])
        found, values = _kernels.locate_quadratic(X, corners, cells, points)
        # Barycentric coordinates lie in the space that the basis spans: they are interpolated exactly.
        sides = values[:, 3:]
        barycentric = values[:, :3] + 0.5 * (sides + sides[:, BEFORE])
    return np.asarray(found), barycentric[:, 1:]


class Places:
    """Places in the cells of a grid, where fields are evaluated.

    Args:
        grid: whose nodes the fields live on.
        found: (m,) cell of each place, kept as `cells`.
        reference: (m, 2) coordinates in it, 0 to 1 along the sides from its first corner.

    Attributes:
        area: (m,) Jacobian over 2 at the places [m^2]: at a centroid the area of the cell, up to the bend of its sides.
    """

    def __init__(self, grid: Grid, found: np.ndarray, reference: np.ndarray) -> None:
        self.cells, self.nodes = found, grid.cells[found]
        if grid.cells.shape[1] == 3:
            x, y = reference.T
            self.values = np.stack([1.0 - x - y, x, y], axis=1)
            slopes = np.broadcast_to(SLOPES, (len(found), 3, 2))
        else:
            self.values, slopes = quadratic_basis(reference)
        jacobian = np.einsum("mai,maj->mij", grid.X[self.nodes], slopes)
        self.area = 0.5 * np.linalg.det(jacobian)
        self.slopes = np.einsum("maj,mji->mai", slopes, np.linalg.inv(jacobian))

    def points(self, grid: Grid) -> np.ndarray:
        """Where the places are (m, 2) [m]."""
        return self.field(grid.X)

    def field(self, field: np.ndarray) -> np.ndarray:
        """Values (m, f) of a nodal field (n, f)."""
        return np.einsum("ma,maf->mf", self.values, field[self.nodes])

    def gradient(self, field: np.ndarray) -> np.ndarray:
        """Derivatives (m, f, 2) of a nodal field (n, f) with respect to x and y."""
        return np.einsum("maf,mai->mfi", field[self.nodes], self.slopes)
