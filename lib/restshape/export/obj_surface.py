"""A surface of triangles as OBJ with texture coordinates, by VTK: cloth in space with its pattern, for renderers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOGeometry import vtkOBJWriter

from restshape.errors import UserError
from restshape.export.frame_mesh import FrameMesh
from restshape.export.stl_surface import FOURTHS
from restshape.outputs.atomic_files import replacing, write_whole
from restshape.outputs.kinds import EXPORT_MARK


def write_obj(mesh: FrameMesh, path: Path) -> list[str]:
    """Writes triangles in metres, and their places in the pattern as texture coordinates; what there is to note.

    Args:
        mesh: of triangles, in the plane or in space; path: of the file.

    Raises:
        UserError: it is a body, which has no pattern.
        OSError: it cannot be written.
    """
    texture = mesh.texture
    if texture is None:
        raise UserError("a body has no pattern to take texture coordinates from", "--as obj", "use --as stl")
    triangles = mesh.cells[:, FOURTHS].reshape(-1, 3) if mesh.cell_type == "triangle6" else mesh.cells[:, :3]
    x = np.column_stack([mesh.X, np.zeros(len(mesh.X))]) if mesh.placed is None else mesh.placed
    with replacing(path) as part:
        writer = vtkOBJWriter()
        writer.SetFileName(str(part))
        writer.SetInputData(_surface(x, triangles, texture.values))
        if not writer.Write():
            raise OSError(f"VTK cannot write {path}")
        _, _, rest = part.read_text(encoding="utf-8").partition("\n")
        write_whole(part, f"# {EXPORT_MARK}: metres; {texture.words}\n{rest}")
    return [texture.words]


def _surface(x: np.ndarray, triangles: np.ndarray, texture: np.ndarray) -> vtkPolyData:
    points, cells, surface = vtkPoints(), vtkCellArray(), vtkPolyData()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(x), deep=True))
    rows = np.column_stack([np.full(len(triangles), 3), triangles]).astype(np.int64)
    cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(rows.ravel(), deep=True))
    surface.SetPoints(points)
    surface.SetPolys(cells)
    coordinates = numpy_to_vtk(np.ascontiguousarray(texture), deep=True)
    coordinates.SetName("texture")
    surface.GetPointData().SetTCoords(coordinates)
    return surface
