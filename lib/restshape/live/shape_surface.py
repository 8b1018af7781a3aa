"""The shape of a frame as a surface of triangles, with its displacement and the field that gives the colours."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, isfinite
from typing import Protocol

import numpy as np

from restshape import _kernels
from restshape.arrays import AnyArray, Indices, Reals
from restshape.live.frame_arrays import PicturePart, same_bytes, sent_points
from restshape.live.shifted_points import ShiftedPoints
from restshape.live.surface_cells import ShownTriangles, triangles_of

MODE = "mode_"
"""Begins the names of modes, which are drawn as displacements of an arbitrary size."""


class ShownSpace(Protocol):
    """The mesh of a frame.

    Attributes:
        X: (n, d) [m]; cells: (ne, k); topology: version of the cells.
    """

    @property
    def X(self) -> Reals: ...
    @property
    def cells(self) -> Indices: ...
    @property
    def topology(self) -> int: ...


@dataclass(frozen=True)
class Colours:
    """Which field gives the colours.

    Args:
        name: of it; source: name in the analysis: with an ending where each cell has values of its own.
        in_cells: it is of cells.
    """

    name: str
    source: str
    in_cells: bool


class ShapeSurface:
    """The part "shape" of the picture of each frame; arrays that have not changed are the same objects."""

    def __init__(self) -> None:
        self._version: tuple[object, int] = (None, -1)
        self._cells: AnyArray | None = None
        self._triangles = ShownTriangles.none()
        self._known: dict[str, AnyArray] = {}
        self._shifted = ShiftedPoints()
        self._geometry: object = None
        self._facets: object = None
        self._moved = True

    @property
    def triangles(self) -> ShownTriangles:
        """Those of the last frame."""
        return self._triangles

    def __call__(
        self, space: ShownSpace, at_nodes: Mapping[str, Reals], in_cells: Mapping[str, Reals], colours: Colours | None
    ) -> PicturePart:
        """The part of a frame.

        Args:
            space: its mesh; at_nodes, in_cells: its fields, as `Analysis.fields` gives them.
            colours: which of them gives the colours; None: none does.
        """
        return self.placed(space, space.X, at_nodes, in_cells, colours)

    def placed(
        self,
        space: ShownSpace,
        X: Reals,
        at_nodes: Mapping[str, Reals],
        in_cells: Mapping[str, Reals],
        colours: Colours | None,
    ) -> PicturePart:
        """The same of a mesh whose nodes are at other places X (n, d) [m]."""
        if self._version[1] != space.topology or not (self._version[0] is space or self._cells is space.cells):
            self._known, self._shifted = {}, ShiftedPoints()
            # Flips leave the border as it is, as they leave facets.
            facets, before = getattr(space, "facets", None), self._facets
            stays = facets is not None and facets is before and self._version[0] is space
            self._triangles = triangles_of(X, space.cells, self._triangles.border if stays else None)
            self._facets = facets
        self._version, self._cells = (space, space.topology), space.cells
        geometry = getattr(space, "geometry", None)
        # In a frame that moves nodes nothing is as it was.
        self._moved = geometry is not None and geometry != self._geometry
        self._geometry = geometry
        shown = self._triangles
        moved = at_nodes.get("displacement")
        if self._moved and shown.nodes is None and moved is not None and colours is not None and not colours.in_cells:
            values = at_nodes[colours.source]
            if values.ndim == 1:
                return self._after_move(X, moved, values, colours.name)
        arrays = {
            "points": self._kept("points", sent_points(shown.chosen(X))),
            "cells": shown.corners,
            "border": shown.border,
        }
        said: dict[str, object] = {} if shown.parts == 1 else {"element": shown.parts}
        if moved is None and (mode := _mode(at_nodes, colours)) in at_nodes:
            moved, said = at_nodes[mode], said | {"mode": int(mode.removeprefix(MODE))}
        if moved is not None:
            arrays["displacement"], shift = self._displaced(moved)
            said |= {"shift": shift} if shift else {}
        if colours is not None:
            given = (in_cells if colours.in_cells else at_nodes)[colours.source]
            key = "valueInCells" if colours.in_cells else "value"
            arrays[key], known = self._valued(key, given, colours.in_cells)
            said |= {"field": colours.name, "range": known}
        return PicturePart("shape", "surface", "shape", arrays, said)

    def _after_move(self, X: Reals, moved: Reals, values: Reals, field: str) -> PicturePart:
        """The part of a frame whose nodes have moved, all of which are shown, by one pass over its fields.

        It is the usual one of a drag; so it is the same as elsewhere, in less time.
        """
        points, displacement, value, low, high = _kernels.sent_fields(X, moved, values)
        known, shown = self._known, self._triangles
        known["points"], known["value"] = points, value
        # The solver makes new fields in each frame.
        self._shifted.begin(moved, displacement)
        arrays = {
            "points": points,
            "cells": shown.corners,
            "border": shown.border,
            "displacement": displacement,
            "value": value,
        }
        said: dict[str, object] = {"field": field, "range": [low, high] if low < inf else None}
        if shown.cell_size != 3:
            said["element"] = shown.parts
        return PicturePart("shape", "surface", "shape", arrays, said)

    def _displaced(self, values: Reals) -> tuple[AnyArray, list[float] | None]:
        """Displacements, those of before where all have gone on by one vector [m], which is then the second."""
        chosen = self._triangles.chosen(values)
        found = sent_points(chosen)
        # The sum of numbers is none where one of them is none.
        if not isfinite(np.add.reduce(found, axis=None)):
            found = np.nan_to_num(found, nan=0.0, posinf=0.0, neginf=0.0)
        if self._moved:
            self._shifted = ShiftedPoints()
        return self._shifted(chosen, found)

    def _kept(self, key: str, found: AnyArray) -> AnyArray:
        """An array, or that of before where it is the same."""
        before = self._known.get(key)
        if before is not None and not self._moved and same_bytes(before, found):
            return before
        self._known[key] = found
        return found

    def _valued(self, key: str, values: Reals, in_cells: bool) -> tuple[AnyArray, list[float] | None]:
        """The values that give colours, and the least and the largest of all that are known."""
        scalar = values
        if values.ndim == 2 and not (in_cells and values.shape[1] == self._triangles.cell_size):
            scalar = np.linalg.norm(values, axis=1)
        shown = self._triangles.spread(scalar) if in_cells else self._triangles.chosen(scalar)
        flat = scalar.ravel()
        low = float(np.minimum.reduce(flat, initial=np.inf))
        high = float(np.maximum.reduce(flat, initial=-np.inf))
        if not (isfinite(low) and isfinite(high)):
            finite = scalar[np.isfinite(scalar)]
            low, high = (float(finite.min()), float(finite.max())) if finite.size else (np.inf, np.inf)
        return self._kept(key, shown.astype("<f4")), [low, high] if isfinite(low) else None


def mode_of(field: str) -> int:
    """The number of the mode that is drawn where a field gives the colours: that of the field, else the first."""
    number = field.rpartition("_")[2] if MODE in field else ""
    return int(number) if number.isdecimal() else 1


def _mode(at_nodes: Mapping[str, Reals], colours: Colours | None) -> str:
    """The field of the mode that is drawn as a displacement."""
    wanted = f"{MODE}{mode_of(colours.name if colours else '')}"
    return wanted if wanted in at_nodes else f"{MODE}1"
