"""Transfer of nodal fields from an old mesh to a new one."""

from typing import Protocol

import numpy as np

from restshape import _kernels


class FieldNodes(Protocol):
    """Nodes X (n, d) [m] and cells on them, of a dimension, and of a type that says shape and order: "tri3", "tri6"."""

    @property
    def dim(self) -> int: ...
    @property
    def cell_type(self) -> str: ...
    @property
    def X(self) -> np.ndarray: ...
    @property
    def cells(self) -> np.ndarray: ...
    @property
    def corners(self) -> np.ndarray: ...


class Transfer:
    """Interpolation from the nodes of one mesh to points, found once for any number of fields.

    A point outside the mesh takes the value of the nearest boundary point.

    Args:
        mesh: where the fields live, triangles of first or second order.
        points: (m, d) where they are wanted [m].
        close: they follow each other closely, so that they are found faster; one on a side may be found in either cell.

    Attributes:
        cells: (m,) that the points lie in; nodes, weights: (m, k) of these, as their fields are interpolated.

    Raises:
        ValueError: cells of the mesh's type cannot be searched for points, or points are of another dimension.
    """

    def __init__(self, mesh: FieldNodes, points: np.ndarray, close: bool = False) -> None:
        points = np.ascontiguousarray(points, dtype=float)
        if not mesh.X.shape[1] == points.shape[1] == mesh.dim:
            many = f"{mesh.X.shape[1]} and {points.shape[1]} coordinates"
            raise ValueError(f"nodes and points have {many}: cells of dimension {mesh.dim} are searched in it alone")
        if mesh.cell_type == "tri6":
            found, self.weights = _kernels.locate_quadratic(mesh.X, mesh.corners, mesh.cells, points, close)
        elif mesh.cell_type == "tri3":
            found, self.weights = _kernels.locate(mesh.X, mesh.cells, points, close)
        else:
            raise ValueError(
                f"fields are transferred between triangles in the plane, not between cells {mesh.cell_type!r}"
            )
        self.mesh, self.cells, self.nodes = mesh, found, mesh.cells[found]

    def __call__(self, field: np.ndarray) -> np.ndarray:
        """Values (m, f) at the points.

        Args:
            field: (n, f) values at the nodes.
        """
        out = np.empty((1, len(self.nodes), field.shape[1]))
        self.rows(np.ascontiguousarray(field, dtype=float)[None], out)
        return out[0]

    def rows(self, rows: np.ndarray, out: np.ndarray) -> None:
        """Write the values of many fields at the points.

        Args:
            rows: (count, n, f) values at the nodes.
            out: (count, m, f) those at the points.
        """
        _kernels.interpolate_rows(self.nodes, self.weights, rows, out)

    def curved(self, field: np.ndarray) -> np.ndarray:
        """The same on triangles of first order, (m, f) with the curvature that gradients at the nodes show.

        Each corner gives its value, and half of what its gradient makes of it at the point: of third order where
        gradients are of second, and the same where the field is linear.

        Args:
            field: (n, f) values at the nodes.
        """
        X, values = self.mesh.X, self(field)
        away = np.einsum("ij,ijd->id", self.weights, X[self.nodes])[:, None] - X[self.nodes]
        slopes = nodal_gradients(X, self.mesh.cells, field)[self.nodes]
        return values + 0.5 * np.einsum("ij,ijfd,ijd->if", self.weights, slopes, away)


def nodal_gradients(X: np.ndarray, cells: np.ndarray, field: np.ndarray) -> np.ndarray:
    """Gradients (n, f, 2) at nodes X (n, 2) of a field (n, f) that is linear in each of the triangles, by area."""
    corners, values = X[cells], field[cells]
    (ax, ay), (bx, by) = np.moveaxis(corners[:, 1:] - corners[:, :1], 0, -1)
    au, bu = (values[:, k] - values[:, 0] for k in (1, 2))
    # Twice the areas, times the gradients.
    parts = np.stack([au * by[:, None] - bu * ay[:, None], bu * ax[:, None] - au * bx[:, None]], axis=2)
    nodes, n = cells.ravel(), len(X)
    sums = [np.bincount(nodes, np.repeat(part, 3), n) for part in parts.reshape(len(cells), -1).T]
    areas = np.bincount(nodes, np.repeat(ax * by - bx * ay, 3), n)
    return np.stack(sums, axis=1).reshape(n, *parts.shape[1:]) / areas[:, None, None]


class Points(Protocol):
    """Points X (m, d) [m]."""

    @property
    def X(self) -> np.ndarray: ...


def transfer(old: FieldNodes, new: Points, field: np.ndarray) -> np.ndarray:
    """Values (n_new, f) of a nodal field of the old mesh at the nodes of the new one.

    Exact for linear fields, and of second order for quadratic ones too where sides are straight.

    Args:
        old, new: meshes of nearly the same shape, each of either order; of the new one the nodes count alone.
        field: (n_old, f) values.
    """
    return Transfer(old, new.X)(field)
