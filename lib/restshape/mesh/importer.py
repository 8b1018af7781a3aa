"""Meshes from files: Abaqus, Nastran, Gmsh and VTU, their group names kept."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from restshape.bounds import LENGTH, MESH_BYTES, READING_MEMORY, TRIANGLES
from restshape.errors import UserError, printable
from restshape.memory import bounded_memory
from restshape.mesh.generate import assemble
from restshape.mesh.mesh import Mesh, edges_of_cells
from restshape.mesh.nastran import constraint_sets, has_grid, read_deck
from restshape.mesh.tracing import Triangles, trace
from restshape.mesh.wavefront import read_wavefront
from restshape.shape.outline import Outline

if TYPE_CHECKING:
    import meshio

FORMATS = {".inp": "abaqus", ".bdf": "nastran", ".nas": "nastran", ".dat": "nastran", ".msh": "gmsh", ".vtu": "vtu"}
"""File name endings that are read, and meshio's name of their format."""

PLANE_ELEMENTS = {
    **dict.fromkeys(("CPE3", "CPE3H", "CPEG3", "M3D3"), "triangle"),
    **dict.fromkeys(("CPE4", "CPE4H", "CPE4I", "CPE4R", "CPEG4", "CPS4I", "M3D4", "M3D4R"), "quad"),
    **dict.fromkeys(("CPE6", "CPE6H", "CPE6M", "CPEG6", "CPS6", "CPS6M", "M3D6"), "triangle6"),
    **dict.fromkeys(("CPE8", "CPE8H", "CPE8R", "CPEG8", "CPS8", "CPS8R", "M3D8", "M3D8R"), "quad8"),
}
"""Abaqus names of plane elements that meshio does not know."""

SECOND_ORDER = {"triangle6": 3, "quad8": 4, "quad9": 4}
"""Elements with a node in the middle of each side, as meshio calls them, and how many corners they have."""

FLAT = 1e-6
"""Share of the size by which z may differ from 0."""

COINCIDENT = 1e-9
"""Two nodes closer than this share of the size count as the same place."""

DEGENERATE = 1e-6
"""A triangle with less area than this share of its longest side squared is degenerate."""


def read_mesh(path: Path | str, unit: float = 1.0, ranks: int = 1) -> tuple[Mesh, Outline]:
    """The plane mesh of a file, and the outline that it fills, with the file's groups as named entities.

    Node sets and line elements name boundary edges and points; sets of triangles, properties and integer cell data name
    regions. Quadrilaterals are cut in two along their shorter diagonal. Nodes that no triangle uses are dropped.

    Runs of boundary nodes on one circle become arcs. Of elements of second order the mesh has the corners; curved sides
    on the boundary make arcs or splines of it, on which the nodes of second order will stand.

    Args:
        path: .inp, .bdf, .nas, .dat, .msh or .vtu.
        unit: metres in one unit of the file.
        ranks: number of ranks.

    Raises:
        UserError: the file cannot be read, or does not hold a plane mesh in one piece.
    """
    path = Path(path)
    read = read_file(path)
    with _readable(path, FORMATS[path.suffix.lower()]):
        triangles = _checked(_triangles(read, path, unit), path)
    try:
        outline, boundary, X, cells = trace(triangles)
    except UserError as error:
        raise UserError(error.what, str(path), error.do) from None
    mesh = assemble(outline, boundary, X, cells, ranks)
    return mesh, outline


def of_second_order(path: Path) -> bool:
    """Whether a mesh file has elements of second order.

    Raises:
        UserError: the file cannot be read.
    """
    return any(block.type in SECOND_ORDER for block in read_file(path).cells)


def read_file(path: Path, formats: Mapping[str, str] = FORMATS) -> meshio.Mesh:
    """What meshio reads from a file.

    Args:
        path: the file.
        formats: endings of its name, and meshio's name of their format.

    Raises:
        UserError: there is none, it is too long, or it cannot be read.
    """
    if not path.is_file():
        raise UserError("there is no such mesh file", str(path), "paths in a scene are relative to the scene's folder")
    kind = formats.get(path.suffix.lower())
    if kind is None:
        raise UserError(f"a {path.suffix or 'nameless'} file is no mesh", str(path), f"use {', '.join(formats)}")
    if not path.stat().st_size:
        raise UserError("the mesh file is empty", str(path), "write it again")
    if path.stat().st_size > MESH_BYTES:
        raise UserError(f"the mesh file is longer than {MESH_BYTES} bytes", str(path), "take a coarser mesh")
    # meshio waits for ever for the first card of a deck without any.
    if kind == "nastran" and not has_grid(path):
        raise UserError("there is no GRID card in the bulk data", str(path), "export the nodes too")
    if kind == "abaqus":
        _refuse_includes(path)
    import meshio  # late: few scenes have a mesh file
    from meshio.abaqus._abaqus import abaqus_to_meshio_type

    for name, shape in PLANE_ELEMENTS.items():
        abaqus_to_meshio_type.setdefault(name, shape)
    with _readable(path, kind):
        if kind == "nastran":
            return read_deck(path)
        if kind == "obj":
            return read_wavefront(path)
        return meshio.read(path, file_format=kind)


@contextlib.contextmanager
def _readable(path: Path, kind: str) -> Iterator[None]:
    """Has whatever is wrong with a file that is read within be an error of the user's."""
    # meshio prints why it fails before it leaves.
    printed = io.StringIO()
    try:
        with (
            contextlib.redirect_stdout(printed),
            contextlib.redirect_stderr(io.StringIO()),
            bounded_memory(READING_MEMORY),
        ):
            yield
    except UserError:
        raise
    except MemoryError:
        what = f"reading this {kind} mesh would take more than {READING_MEMORY >> 30} GB of memory"
        raise UserError(what, str(path), "take a coarser mesh, or export it again") from None
    # meshio's readers raise whatever the damage of a file leads to, and some of them leave by SystemExit.
    except (Exception, SystemExit) as failure:
        reason = printed.getvalue() if isinstance(failure, SystemExit) else str(failure)
        why = f" ({printable(reason.strip().splitlines()[0][:200])})" if reason.strip() else ""
        raise UserError(f"this is no {kind} mesh that can be read{why}", str(path), "export it again") from None


def _refuse_includes(path: Path) -> None:
    """Refuses a deck that reads other files, which no scene has named."""
    with path.open(encoding="utf-8", errors="replace") as lines:
        for number, line in enumerate(lines, start=1):
            if line.lstrip().upper().startswith("*INCLUDE"):
                what = "*INCLUDE reads another file, which is not done"
                raise UserError(what, f"{path} (line {number})", "put all of the mesh into one file")


def _triangles(read: meshio.Mesh, path: Path, unit: float) -> Triangles:
    """Triangles and groups of a meshio mesh, quadrilaterals cut in two."""
    points = np.asarray(read.points, dtype=float)
    if points.ndim != 2 or not len(points):
        raise UserError("the mesh has no nodes", str(path), "export the nodes too")
    points = np.column_stack([points, np.zeros((len(points), 3 - points.shape[1]))]) * unit
    if not np.isfinite(points).all():
        raise UserError(f"node {int(np.argmin(np.isfinite(points).all(axis=1))) + 1} has no finite place", str(path))
    if np.abs(points).max() > LENGTH:
        raise UserError(f"a node lies farther than {LENGTH:g} m from 0", str(path), "check mesh.unit")
    cells, lines, row_of_cell, row_of_line = [], [], [], []
    sides: list[np.ndarray] = []
    row = 0
    for block in read.cells:
        rows = np.arange(row, row + len(block.data))
        row += len(block.data)
        data = np.asarray(block.data, dtype=np.int64).reshape(len(block.data), -1)
        if data.size and (data.min() < 0 or data.max() >= len(points)):
            raise UserError("an element names a node that is not there", str(path), "export it again")
        if block.type in SECOND_ORDER:
            sides.append(_with_middles(data, SECOND_ORDER[block.type]))
        if block.type in ("triangle", "triangle6"):
            cells.append(data[:, :3])
            row_of_cell.append(rows)
        elif block.type in ("quad", "quad8", "quad9"):
            cells.append(_halves(points, data[:, :4]))
            row_of_cell.append(np.repeat(rows, 2))
        elif block.type in ("line", "line3"):
            lines.append(data)
            row_of_line.append(rows)
        elif block.type != "vertex":
            what = f"the mesh has elements of type {block.type!r}"
            raise UserError(what, str(path), "only triangles and quadrilaterals in the plane are read")
    extent = float(np.ptp(points, axis=0).max())
    if np.abs(points[:, 2]).max() > FLAT * extent:
        raise UserError("the mesh is not in the plane z = 0", str(path), "only plane meshes are read: project it")
    if not cells:
        raise UserError("the mesh has no triangles", str(path), "export the elements too")
    known = np.unique(np.concatenate(sides), axis=0) if sides else np.empty((0, 3), dtype=np.int64)
    ends = [_ends(data, known[:, 2]) for data in lines]
    found = Triangles(
        points[:, :2].copy(),
        np.concatenate(cells),
        np.concatenate(ends) if ends else np.empty((0, 2), dtype=np.int64),
        sides=known[:, :2],
        middles=points[known[:, 2], :2],
    )
    for name, rows in _element_groups(read).items():
        chosen = np.zeros(row, dtype=bool)
        chosen[rows] = True
        found.add(name, "cells", np.flatnonzero(chosen[np.concatenate(row_of_cell)]))
        if lines:
            found.add(name, "lines", np.flatnonzero(chosen[np.concatenate(row_of_line)]))
    for name, nodes in read.point_sets.items():
        found.add(name, "nodes", np.unique(np.asarray(nodes, dtype=np.int64)))
    if FORMATS[path.suffix.lower()] == "nastran":
        for name, nodes in constraint_sets(path).items():
            found.add(name, "nodes", nodes)
    return found


def _with_middles(data: np.ndarray, corners: int) -> np.ndarray:
    """Ends, the smaller first, and middle (m, 3) of each side of elements of second order with so many corners."""
    ends = np.stack([data[:, :corners], np.roll(data[:, :corners], -1, axis=1)], axis=2)
    return np.concatenate([np.sort(ends, axis=2), data[:, corners : 2 * corners, None]], axis=2).reshape(-1, 3)


def _ends(lines: np.ndarray, middles: np.ndarray) -> np.ndarray:
    """Ends (m, 2) of lines, whose middle formats put second or third."""
    if lines.shape[1] == 2:
        return lines
    second = np.isin(lines[:, 1], middles)
    return np.where(second[:, None], lines[:, (0, 2)], lines[:, :2])


def _halves(points: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Two triangles for each quadrilateral (m, 4), in turn, cut along the shorter diagonal."""
    first = np.hypot(*(points[quads[:, 2], :2] - points[quads[:, 0], :2]).T)
    second = np.hypot(*(points[quads[:, 3], :2] - points[quads[:, 1], :2]).T)
    along = (first <= second)[:, None, None]
    halves = np.where(along, quads[:, ((0, 1, 2), (0, 2, 3))], quads[:, ((0, 1, 3), (1, 2, 3))])
    return halves.reshape(-1, 3)


def _element_groups(read: meshio.Mesh) -> dict[str, np.ndarray]:
    """Rows of elements, counted through all blocks, by group name."""
    starts = np.concatenate([[0], np.cumsum([len(block.data) for block in read.cells])])
    found: dict[str, list[np.ndarray]] = {}
    for name, blocks in read.cell_sets.items():
        if not name.startswith("gmsh:"):
            for start, rows in zip(starts, blocks):
                if rows is not None and len(rows):
                    found.setdefault(name, []).append(start + np.asarray(rows, dtype=np.int64))
    names = {(int(tag), int(dim)): name for name, (tag, dim) in read.field_data.items()}
    dims = {"vertex": 0, "line": 1, "line3": 1}
    for array, blocks in read.cell_data.items():
        if array in ("gmsh:geometrical", "medit:ref"):
            continue
        label = {"gmsh:physical": "physical", "nastran:ref": "property"}.get(array, array)
        for start, block, values in zip(starts, read.cells, blocks):
            values = np.asarray(values)
            if values.ndim != 1 or not np.issubdtype(values.dtype, np.integer):
                continue
            for value in np.unique(values):
                name = names.get((int(value), dims.get(block.type, 2)), f"{label}_{value}")
                if array != "gmsh:physical" or value:
                    found.setdefault(name, []).append(start + np.flatnonzero(values == value))
    return {name: np.unique(np.concatenate(rows)) for name, rows in found.items()}


def _checked(found: Triangles, path: Path) -> Triangles:
    """The triangles without orphan nodes, all counter-clockwise.

    Raises:
        UserError: with the first element or node that is wrong, numbered from 1 in the order of the file.
    """
    from scipy.spatial import cKDTree

    X, cells = found.X, found.cells
    if len(cells) > TRIANGLES:
        raise UserError(f"the mesh has more than {TRIANGLES} triangles", str(path), "take a coarser one")
    u, v = X[cells[:, 1]] - X[cells[:, 0]], X[cells[:, 2]] - X[cells[:, 0]]
    double = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    longest = np.max([np.sum(side**2, axis=1) for side in (u, v, v - u)], axis=0)
    flat = np.abs(double) <= DEGENERATE * longest
    if flat.any():
        raise UserError(f"{_triangle(found, flat)} is degenerate: it has no area", str(path), "repair the mesh")
    found.cells = np.where((double < 0.0)[:, None], cells[:, (0, 2, 1)], cells)
    used = np.unique(cells)
    extent = float(np.ptp(X[used], axis=0).max())
    pairs = cKDTree(X[used]).query_pairs(COINCIDENT * extent, output_type="ndarray")
    if len(pairs):
        a, b = (used[pairs[0]] + 1).tolist()
        raise UserError(f"nodes {a} and {b} stand in the same place: the mesh is torn there", str(path), "merge them")
    found.keep_nodes(used)
    edges, cell_edges = edges_of_cells(found.cells, len(found.X))
    count = np.bincount(cell_edges.ravel(), minlength=len(edges))
    if count.max() > 2:
        crowded = (count[cell_edges] > 2).any(axis=1)
        raise UserError(f"{_triangle(found, crowded)} has a side that more than two elements share", str(path))
    a, b = found.cells[:, (1, 2, 0)].ravel(), found.cells[:, (2, 0, 1)].ravel()
    same_way = np.bincount(cell_edges.ravel(), weights=np.where(a < b, 1.0, -1.0), minlength=len(edges))
    folded = (np.abs(same_way[cell_edges]) > 1.5).any(axis=1)
    if folded.any():
        raise UserError(
            f"{_triangle(found, folded)} is inverted: it lies on its neighbour", str(path), "repair the mesh"
        )
    return found


def _triangle(found: Triangles, chosen: np.ndarray) -> str:
    """Words for the first chosen triangle."""
    row = int(np.argmax(chosen))
    nodes = ", ".join(f"({x:.6g}, {y:.6g}) m" for x, y in found.X[found.cells[row]].tolist())
    return f"triangle {row + 1} with corners {nodes} m"
