"""The surface of a body as triangles: a contour on an even grid, whose nodes are then spread evenly over it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_matrix, diags
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D

ROUNDS = 6
"""Times that nodes are moved to the middle of their neighbours and back onto the surface."""
STEP = 1e-5
"""Of the central differences of distances [m]."""
DECIMALS = 5
"""Of metres that places are rounded to, so that files are the same on all machines."""

Distance = Callable[[np.ndarray], np.ndarray]


def body_mesh(distance: Distance, low: np.ndarray, high: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, 3) [m] and triangles (m, 3), counter-clockwise seen from outside, of the surface of a body.

    Args:
        distance: from the body at places (..., 3), negative inside.
        low, high: corners (3,) of a box around it [m].
        size: of the grid [m], about that of the triangles.
    """
    nodes, triangles = _contour(distance, low, high, size)
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    # Each side of a closed surface is there once in each direction.
    beside = csr_matrix((np.ones(len(sides)), tuple(sides.T)), shape=(len(nodes),) * 2)
    mean = diags(1.0 / np.asarray(beside.sum(axis=1)).ravel()) @ beside
    for _ in range(ROUNDS):
        nodes = _on_surface(distance, 0.5 * (nodes + mean @ nodes))
    return np.round(nodes, DECIMALS) + 0.0, triangles


def _contour(distance: Distance, low: np.ndarray, high: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray]:
    counts = [int(count) for count in np.ceil((high - low) / size)]
    x, y, z = (start + size * np.arange(count + 1) for start, count in zip(low, counts))
    values = np.concatenate([distance(_layer(x, y, one)) for one in z])
    grid = vtkImageData()
    grid.SetDimensions(*(count + 1 for count in counts))
    grid.SetSpacing(size, size, size)
    grid.SetOrigin(*low)
    grid.GetPointData().SetScalars(numpy_to_vtk(values, deep=True))
    contour = vtkFlyingEdges3D()
    contour.SetInputData(grid)
    contour.SetValue(0, 0.0)
    contour.ComputeNormalsOff()
    contour.Update()
    found = contour.GetOutput()
    # VTK takes the larger values for the inside.
    triangles = vtk_to_numpy(found.GetPolys().GetConnectivityArray()).reshape(-1, 3)[:, ::-1]
    return vtk_to_numpy(found.GetPoints().GetData()).astype(float), triangles.astype(np.int64)


def _layer(x: np.ndarray, y: np.ndarray, z: float) -> np.ndarray:
    """Places (ny nx, 3) of a level of the grid; x runs fastest."""
    return np.column_stack([np.tile(x, len(y)), np.repeat(y, len(x)), np.full(len(x) * len(y), z)])


def _on_surface(distance: Distance, places: np.ndarray) -> np.ndarray:
    """Places (n, 3) after three steps of Newton's method along the gradient."""
    for _ in range(3):
        slope = np.column_stack([distance(places + d) - distance(places - d) for d in STEP * np.eye(3)]) / (2.0 * STEP)
        places = places - (distance(places) / (slope**2).sum(axis=1))[:, None] * slope
    return places


def obj_text(nodes: np.ndarray, triangles: np.ndarray, heading: str) -> str:
    """A surface as a file of Wavefront (OBJ), whose first line is the heading."""
    rows = [f"v {x:.{DECIMALS}f} {y:.{DECIMALS}f} {z:.{DECIMALS}f}" for x, y, z in nodes]
    return "\n".join([f"# {heading}", *rows, *(f"f {a} {b} {c}" for a, b, c in triangles + 1), ""])
