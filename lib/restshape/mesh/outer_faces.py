"""The faces of a body of several parts that bound it: those within another part, or between two, do not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from restshape import _kernels
from restshape.mesh.closed_surface import ClosedSurface

COARSE = 0.05
"""Longest side of a triangle, over the size of the body, above which it is cut before it is looked at."""
CUTS = 12
"""How often a triangle is cut in four, at most."""
BESIDE = 1e-5
"""How far from a face it is asked whether a place is inside, over the size of the body."""
INSIDE = 0.5
"""Winding number above which a place is inside."""
PLACES = np.array([[1, 1, 1], [2.4, 0.3, 0.3], [0.3, 2.4, 0.3], [0.3, 0.3, 2.4]]) / 3.0
"""Barycentric coordinates (4, 3) at which a triangle is looked at."""
QUARTERS = np.array(
    [
        [[2, 0, 0], [1, 1, 0], [1, 0, 1]],
        [[1, 1, 0], [0, 2, 0], [0, 1, 1]],
        [[1, 0, 1], [0, 1, 1], [0, 0, 2]],
        [[1, 1, 0], [0, 1, 1], [1, 0, 1]],
    ]
) / 2.0  # fmt: skip
"""Barycentric coordinates (4, 3, 3) of the corners of a triangle's quarters."""


@dataclass(frozen=True, eq=False)
class OuterSearch:
    """Distances from the faces that bound a body, as `_kernels.SurfaceSearch` gives them from all.

    Args:
        whole: all faces, which say what is inside; outer: those that bound it.
    """

    whole: _kernels.SurfaceSearch
    outer: _kernels.SurfaceSearch

    def nearest(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The signed distances (n,) [m] of places x (n, 3) [m], negative inside, and the nearest places (n, 3)."""
        distance, at = self.outer.nearest(x)
        return np.where(self.whole.winding(x) > INSIDE, -1.0, 1.0) * np.abs(distance), at

    def fill_lattice(self, origin: np.ndarray, spacing: float, wanted: np.ndarray, values: np.ndarray) -> None:
        """Put distances [m] of places origin + spacing (i, j, k) [m] into values (i, j, k), where wanted (i, j, k)."""
        self.outer.fill_lattice(origin, spacing, wanted, values, self.whole)

    def first_hits(self, x: np.ndarray, ways: np.ndarray) -> np.ndarray:
        """How far (n,) [m] from x (n, 3) ways (n, 3) first meet a face that bounds; infinite where never."""
        return self.outer.first_hits(x, ways)


Search: TypeAlias = "_kernels.SurfaceSearch | OuterSearch"
"""Either gives signed distances, and where rays first meet the surface."""


def body_search(surface: ClosedSurface, finest: float) -> Search:
    """What gives distances from a body's surface, without the faces inside of it.

    Args:
        surface: its triangles have area.
        finest: length of sides [m] down to which triangles are cut that are partly inside; the smallest ones stay.

    Source: docs/theory/cloth.md.
    """
    whole = _kernels.SurfaceSearch(surface.X, surface.cells)
    size = float(np.ptp(surface.X, axis=0).max())
    open_, kept, dropped = surface.X[surface.cells], [np.empty((0, 3, 3))], 0
    for cut in range(CUTS + 1):
        if not len(open_):
            break
        share = _share_within(whole, open_, BESIDE * size)
        longest = np.linalg.norm(open_ - np.roll(open_, 1, axis=1), axis=2).max(axis=1)
        again = (longest > finest) & (((share > 0.0) & (share < 1.0)) | (longest > COARSE * size)) & (cut < CUTS)
        kept.append(open_[~again & (share < 1.0)])
        dropped += int((~again & (share == 1.0)).sum())
        open_ = np.einsum("qik,mka->mqia", QUARTERS, open_[again]).reshape(-1, 3, 3)
    if not dropped:
        return whole
    corners = np.concatenate(kept).reshape(-1, 3)
    return OuterSearch(whole, _kernels.SurfaceSearch(corners, np.arange(len(corners), dtype=np.int32).reshape(-1, 3)))


def _share_within(whole: _kernels.SurfaceSearch, triangles: np.ndarray, way: float) -> np.ndarray:
    """The share (m,) of the looked-at places of triangles (m, 3, 3) that have the body on both sides, a way [m] off."""
    a, b, c = triangles.swapaxes(0, 1)
    normals = np.cross(b - a, c - a)
    normals = way * normals / np.linalg.norm(normals, axis=1)[:, None]
    places = np.einsum("pk,mka->mpa", PLACES, triangles).reshape(-1, 3)
    beside = np.repeat(normals, len(PLACES), axis=0)
    within = whole.winding(places + beside) > INSIDE
    within[within] = whole.winding((places - beside)[within]) > INSIDE
    return within.reshape(-1, len(PLACES)).mean(axis=1)
