"""Closed triangle meshes of files: OBJ, STL and PLY, in metres, with small holes closed."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from restshape.bounds import BODY_TRIANGLES, LENGTH
from restshape.errors import UserError
from restshape.mesh.importer import read_file

FORMATS = {".obj": "obj", ".stl": "stl", ".ply": "ply"}
"""File name endings that are read, and meshio's name of their format."""
GUESSES = ((3.0, 1.0, "m"), (300.0, 1e-2, "cm"), (3000.0, 1e-3, "mm"))
"""A body whose longest side is shorter than so many units of its file is taken to be in metres, centimetres, ..."""
COINCIDENT = 1e-7
"""Corners closer than this share of the size are one."""
FLAT = 1e-12
"""A triangle with less area than this share of its longest side squared has none; a body with less of its volume."""
STL_HEAD, STL_TRIANGLE = 84, 50
"""Bytes of a binary STL file before its triangles, whose last four count them; and of each triangle."""
LARGE_HOLE = 0.3
"""A hole wider than this share of the size makes the surface an open one."""


@dataclass(frozen=True)
class SurfaceHole:
    """A hole of a surface, which has been closed.

    Args:
        edges: around it.
        width: of the box around it, along its longest side [m].
        center: (3,) mean of its corners [m].
    """

    edges: int
    width: float
    center: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class ClosedSurface:
    """A closed surface of triangles that look outwards.

    Args:
        X: (n, 3) corners [m].
        cells: (m, 3) int32 triangles, those that close holes last.
        unit: metres in one unit of the file; guessed: from the size.
        holes: that the file's surface has.
        turned: the file's triangles look inwards, all of them.
    """

    X: np.ndarray
    cells: np.ndarray
    unit: float
    guessed: bool = False
    holes: tuple[SurfaceHole, ...] = ()
    turned: bool = False

    @property
    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """The lowest and the highest corner (3,) of the box around it [m]."""
        return self.X.min(axis=0), self.X.max(axis=0)

    @property
    def areas(self) -> np.ndarray:
        """The areas (m,) [m^2] of the triangles, 0 of those whose corners lie in a line."""
        a, b, c = (self.X[self.cells[:, k]] for k in range(3))
        found = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
        longest = np.max([((p - q) ** 2).sum(axis=1) for p, q in ((a, b), (b, c), (c, a))], axis=0)
        return np.where(2.0 * found > FLAT * longest, found, 0.0)

    @property
    def volume(self) -> float:
        """What it encloses [m^3]."""
        a, b, c = (self.X[self.cells[:, k]] for k in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


def read_closed_surface(path: Path | str, unit: float | None = None) -> ClosedSurface:
    """The closed surface of a file.

    Corners at one place are joined, as STL files repeat them; polygons are cut into triangles; triangles with two
    corners at one place are left out. Holes are closed by triangles about their middle. Triangles that all look inwards
    are turned over.

    Args:
        path: .obj, .stl or .ply.
        unit: metres in one unit of the file; None: guessed from the longest side, see `GUESSES`.

    Raises:
        UserError: the file cannot be read, or does not hold a closed surface.
    """
    path = Path(path)
    read = read_file(path, FORMATS)
    X, cells = np.asarray(read.points, float), _triangles(read.cells)
    if not len(cells):
        what = _cut_off(path) or "the file holds no triangles"
        raise UserError(what, str(path), "export the surface as a triangle mesh")
    if X.shape[1] != 3 or not np.isfinite(X).all():
        raise UserError("a corner is no place in space", str(path), "export the surface again")
    if cells.min() < 0 or cells.max() >= len(X):
        raise UserError("a triangle names a corner that is not there", str(path), "export the surface again")
    if len(cells) > BODY_TRIANGLES:
        what = f"the surface has {len(cells)} triangles, more than {BODY_TRIANGLES}"
        raise UserError(what, str(path), "simplify it, as by Blender's decimate")
    X, cells = _joined(X, cells)
    if not len(cells):
        raise UserError("all triangles are without area", str(path), "export the surface again")
    size = float(np.ptp(X, axis=0).max())
    metres = _guessed_unit(size, path) if unit is None else unit
    if size * metres > LENGTH:
        raise UserError(f"the body is {size * metres:.3g} m long", str(path), "check its unit")
    surface = _closed(ClosedSurface(metres * X, cells, metres, unit is None), path)
    if surface.volume < 0.0:
        surface = replace(surface, cells=np.ascontiguousarray(surface.cells[:, ::-1]), turned=True)
    low, high = surface.box
    if surface.volume < FLAT * float(np.max(high - low)) ** 3:
        raise UserError("the surface encloses no volume", str(path), "give a body, not a sheet")
    return surface


def _cut_off(path: Path) -> str:
    """That a binary STL file ends before its last triangle; empty of others."""
    data = path.read_bytes() if path.suffix.lower() == ".stl" else b""
    if len(data) < STL_HEAD or b"\0" not in data:
        return ""
    announced, there = int.from_bytes(data[STL_HEAD - 4 : STL_HEAD], "little"), (len(data) - STL_HEAD) // STL_TRIANGLE
    return f"the file is cut off: it announces {announced} triangles and holds {there}" if announced > there else ""


def _guessed_unit(size: float, path: Path) -> float:
    """Metres in one unit of a file whose body has so many units along its longest side."""
    for most, metres, _ in GUESSES:
        if 0.05 * GUESSES[0][0] <= size < most:
            return metres
    what = f"the unit of a body with a longest side of {size:.4g} cannot be guessed"
    raise UserError(what, str(path), 'write unit = "mm", or what it is, beside its file')


def _triangles(blocks: list) -> np.ndarray:
    """The triangles (m, 3) of a file's blocks of polygons."""
    found = [np.empty((0, 3), dtype=np.int64)]
    for block in blocks:
        if block.type == "triangle" or block.type == "quad" or block.type.startswith("polygon"):
            data = np.asarray(block.data)
            found += [data[:, [0, k, k + 1]] for k in range(1, data.shape[1] - 1)]
    return np.concatenate(found).astype(np.int64)


def _joined(X: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners and triangles without corners at one place, triangles of two places, and corners without triangles."""
    step = COINCIDENT * max(float(np.ptp(X[cells], axis=(0, 1)).max()), 1e-300)
    _, first, own = np.unique(np.round(X / step).astype(np.int64), axis=0, return_index=True, return_inverse=True)
    cells = own.ravel()[cells]
    X = X[first]
    # Those of three places in a line stay: where corners of one triangle lie on an edge of another, they join both.
    cells = cells[(cells != np.roll(cells, 1, axis=1)).all(axis=1)]
    used, cells = np.unique(cells, return_inverse=True)
    return X[used], np.ascontiguousarray(cells.reshape(-1, 3), dtype=np.int32)


def _closed(surface: ClosedSurface, path: Path) -> ClosedSurface:
    """The surface with its holes closed.

    Raises:
        UserError: a hole is large, or triangles beside each other look to unlike sides.
    """
    edges = _open_edges(surface, path)
    size = float(np.ptp(surface.X, axis=0).max())
    X, cells, holes = list(surface.X), [surface.cells], []
    for loop in _loops(edges):
        places = surface.X[loop]
        center = places.mean(axis=0)
        hole = SurfaceHole(len(loop), float(np.ptp(places, axis=0).max()), tuple(center.tolist()))
        if hole.width > LARGE_HOLE * size:
            where = ", ".join(f"{value:.3g}" for value in center)
            what = f"the surface is open: it has a hole of {hole.width:.3g} m about ({where}) m"
            raise UserError(what, str(path), "close it before you export it")
        holes.append(hole)
        # The open edges run as their triangles do: what closes the hole runs against them.
        cells.append(np.column_stack([np.roll(loop, -1), loop, np.full(len(loop), len(X))]).astype(np.int32))
        X.append(center)
    holes.sort(key=lambda hole: -hole.width)
    return replace(surface, X=np.array(X), cells=np.concatenate(cells), holes=tuple(holes))


def _open_edges(surface: ClosedSurface, path: Path) -> np.ndarray:
    """Edges (k, 2), as their triangles run, that no triangle runs against.

    Raises:
        UserError: three triangles meet at an edge, or two that run the same way.
    """
    directed = np.concatenate([surface.cells[:, [k, (k + 1) % 3]] for k in range(3)])
    low, high = directed.min(axis=1), directed.max(axis=1)
    edges, own = np.unique(np.column_stack([low, high]), axis=0, return_inverse=True)
    own = own.ravel()
    balance = np.bincount(own, np.where(directed[:, 0] == low, 1, -1), minlength=len(edges))
    count = np.bincount(own, minlength=len(edges))
    wrong = (balance != 0) & (count > 1)
    if wrong.any():
        where = ", ".join(f"{value:.3g}" for value in surface.X[edges[wrong.argmax()]].mean(axis=0))
        many = int((wrong & (count > 2)).sum())
        if many:
            what, do = f"{many} edges have an odd number of triangles", "remove the walls within it"
        else:
            what = f"{int(wrong.sum())} edges lie between triangles that look to unlike sides"
            do = "let all look outwards, as Blender's Recalculate Outside does"
        raise UserError(f"{what}, the first about ({where}) m", str(path), do)
    return directed[(count == 1)[own]]


def _loops(edges: np.ndarray) -> list[np.ndarray]:
    """Corners of the closed runs of edges (k, 2), each in its order."""
    after: dict[int, list[int]] = defaultdict(list)
    for a, b in edges.tolist():
        after[a].append(b)
    loops = []
    while after:
        first = min(after)
        loop, at = [first], first
        while True:
            following = after[at].pop()
            if not after[at]:
                del after[at]
            if following == first or following not in after:
                break
            loop.append(following)
            at = following
        loops.append(np.array(loop))
    return loops
