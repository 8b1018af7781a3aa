"""Meshes with their fields as VTU and CSV files, in SI units."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import meshio
import numpy as np

from restshape.export.frame_mesh import FrameMesh
from restshape.outputs.atomic_files import replacing, write_whole
from restshape.outputs.kinds import EXPORT_HEADS, EXPORT_MARK

AXES = "xyz"


def write_vtu(mesh: FrameMesh, path: Path) -> None:
    """Writes mesh and fields for ParaView; rest positions, or those in space of cloth, whose nodes move there.

    Cloth has its places in the pattern as texture coordinates.

    Raises:
        OSError: it cannot be written.
    """
    points = _positions(mesh)
    spatial = np.column_stack([points, np.zeros((len(points), 3 - points.shape[1]))])
    fields = {name: _padded(values) for name, values in mesh.at_points.items()}
    texture = mesh.texture if mesh.placed is not None else None
    if texture is not None:
        fields["texture"] = texture.values
    found = meshio.Mesh(spatial, [(mesh.cell_type, mesh.cells)], fields, {k: [v] for k, v in mesh.in_cells.items()})
    with replacing(path) as part:
        found.write(part, file_format="vtu")
        head, _, rest = part.read_bytes().partition(b"<VTKFile")
        about = EXPORT_MARK if texture is None else f"{EXPORT_MARK}; {texture.words}"
        text = f"{head.decode()}<!-- {about} -->\n<VTKFile{rest.decode()}"
        if texture is not None:
            text = text.replace("<PointData>", '<PointData TCoords="texture">', 1)
        write_whole(part, text)


def write_csv(mesh: FrameMesh, path: Path) -> None:
    """Writes a row a node: its number, its position, and the components of each field at nodes.

    Raises:
        OSError: it cannot be written.
    """
    X = _positions(mesh)
    columns = {axis: X[:, i] for i, axis in enumerate(AXES[: X.shape[1]])}
    for name, values in mesh.at_points.items():
        if values.ndim == 1:
            columns[name] = values
            continue
        names = AXES if values.shape[1] <= len(AXES) else [str(i) for i in range(1, values.shape[1] + 1)]
        columns |= {f"{name}_{names[i]}": values[:, i] for i in range(values.shape[1])}
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(["node", *columns])
    rows.writerows([i, *map(float, row)] for i, row in enumerate(zip(*columns.values())))
    assert text.getvalue().startswith(EXPORT_HEADS)
    write_whole(path, text.getvalue())


def _positions(mesh: FrameMesh) -> np.ndarray:
    """Positions (n, 2 or 3) [m]: of cloth where it is in space, else at rest."""
    return mesh.X if mesh.placed is None else mesh.placed


def _padded(values: np.ndarray) -> np.ndarray:
    """Vectors in the plane with a third component 0, as VTK wants them."""
    if values.ndim == 2 and values.shape[1] == 2:
        return np.column_stack([values, np.zeros(len(values))])
    return values
