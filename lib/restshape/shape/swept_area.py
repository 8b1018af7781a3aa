"""Areas that edges go round: exact for lines, arcs, splines and polylines, and cheap for each new shape of a drag."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Protocol

import numpy as np

from restshape.arrays import Indices, Integers, Reals
from restshape.shape import curves

if TYPE_CHECKING:
    from scipy.sparse import csr_array

DENSE = 96
"""Control points up to which the form is kept as a full matrix."""


class SweptEdge(Protocol):
    """What is asked of an edge; see `restshape.shape.outline.Edge`."""

    @property
    def kind(self) -> str: ...
    @property
    def knots(self) -> tuple[float, ...]: ...
    @property
    def ends(self) -> tuple[str, str]: ...


class SweptArea:
    """Half the integral of x dy - y dx along signed edges: the area [m^2] that closed chains of them go round.

    Of lines, splines and polylines it is x S y of the control points, with a matrix S that never changes while they
    move. What is bent, arcs and lines that an edit has bent, adds the segment between it and its chord.

    Args:
        edges: of a layout.
        controls: for each edge its control points.
        signed: pairs of an edge's index and the sign (1 or -1) with which it counts; together closed chains.
    """

    def __init__(
        self, edges: tuple[SweptEdge, ...], controls: tuple[Indices, ...], signed: Iterable[tuple[int, float]]
    ) -> None:
        rows, columns, values, arcs = [], [], [], []
        for index, sign in signed:
            edge, own = edges[index], controls[index]
            form = sign * _form(edge, len(own))
            rows.append(np.repeat(own, len(own)))
            columns.append(np.tile(own, len(own)))
            values.append(form.ravel())
            if edge.kind in ("line", "arc"):
                arcs.append((index, own[0], own[-1], sign))
        used, where = np.unique(np.concatenate(rows), return_inverse=True)
        across = np.searchsorted(used, np.concatenate(columns))
        self._used, self._form = used, _summed(np.concatenate(values), where, across, len(used))
        self._arcs = np.array([index for index, *_ in arcs], dtype=np.int64)
        self._chords = np.array([(a, b) for _, a, b, _ in arcs], dtype=np.int64).reshape(-1, 2)
        self._signs = np.array([sign for *_, sign in arcs])

    def __call__(self, points: Reals, bulges: Reals) -> float:
        """The area [m^2] at control points (k, 2) [m] and bulges (n_edges,) of the edges."""
        # Far from the origin the terms would cancel.
        own = points[self._used] - points[self._used[0]]
        total = float(own[:, 0] @ (self._form @ own[:, 1]))
        bulges = bulges[self._arcs]
        if bulges.any():
            a, b = points[self._chords[:, 0]], points[self._chords[:, 1]]
            squares = ((b - a) ** 2).sum(axis=1)
            total += float((self._signs * squares) @ curves.segment_areas(bulges))
        return total


def _summed(values: Reals, rows: Integers, columns: Integers, n: int) -> Reals | csr_array:
    """The matrix (n, n) of values (k,) at rows and columns (k,): full where it is small."""
    if n <= DENSE:
        full = np.zeros((n, n))
        np.add.at(full, (rows, columns), values)
        return full
    from scipy.sparse import csr_array

    return csr_array((values, (rows, columns)), shape=(n, n))


def _form(edge: SweptEdge, count: int) -> Reals:
    """The matrix (count, count) S of an edge with so many control points; of an arc that of its chord."""
    if edge.kind == "spline":
        s, w = curves.gauss_parameters(edge.knots)
        place = curves.spline_weights(edge.knots, edge.ends, s)
        rate = curves.spline_weight_rates(edge.knots, edge.ends, s)
        half = 0.5 * place.T @ (w[:, None] * rate)
    else:
        half = 0.5 * np.eye(count, k=1)
    return half - half.T
