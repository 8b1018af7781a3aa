"""Whether a shape can be a shape: nothing crosses, touches, collapses or turns inside out.

Curves are judged by straight pieces within CHORD of them; edges that share no vertex keep CLEARANCE apart, twice that,
so that the true curves cannot cross unseen. Both are relative to the size that the shape had when it was made. Lines
and arcs that share a vertex, which no clearance keeps apart, are asked for their second common point besides: that is
exact.
"""

from __future__ import annotations

import numpy as np

from restshape import _kernels
from restshape.arrays import Bytes, Reals
from restshape.bounds import OUTLINE_PIECES, REACH
from restshape.errors import UserError
from restshape.shape.hand.gesture import Gesture
from restshape.shape.outline import Outline
from restshape.shape.place_words import place_words

CLEARANCE = 2e-4
CHORD = 1e-4
SHARPEST = 0.01
"""Smallest angle between two edges at their common vertex [rad]."""

KINDS = {"outline": 0, "hole": 1, "region": 2}
STILL, BENDING, WHOLE = 0, 1, 2


class MotionCheck:
    """Validity along one linear gesture: each call costs some microseconds.

    Args:
        outline: the shape at c = (0, 0).
        gesture: a linear gesture on it, or None to check the shape itself (all edges against all).
        sampled: the shape whose curvature decides on the number of straight pieces; default: `outline`.
    """

    def __init__(self, outline: Outline, gesture: Gesture | None = None, sampled: Outline | None = None) -> None:
        self.outline, self.gesture = outline, gesture
        self._check = self._kernel(sampled or outline)

    def problem(self, c: tuple[float, float] = (0.0, 0.0)) -> str | None:
        """What is wrong with the shape at the coefficients c; None when it is valid."""
        found = self._check.check(c[0], c[1])
        if found is not None and found[0] == "resample":
            now = self.outline if self.gesture is None else self.outline.moved(self.gesture.points(c))
            try:
                self._check = self._kernel(now)
            except UserError as error:
                return error.what
            self._check.settle(c[0], c[1])
            found = self._check.check(c[0], c[1])
        if found is None and len(self.outline.embedded) < 2:
            return None
        now = self.outline if self.gesture is None else self.outline.moved(self.gesture.points(c))
        return _meeting_points(now) if found is None else describe(now, found)

    def _kernel(self, sampled: Outline) -> _kernels.OutlineCheck:
        outline, gesture, size = self.outline, self.gesture, self.outline.size
        params = [sampled.pieces(e, CHORD * size) for e in range(len(outline.edges))]
        if (count := sum(map(len, params))) > OUTLINE_PIECES:
            raise UserError(f"the shape would be cut into {count} straight pieces, more than {OUTLINE_PIECES}")
        first = np.concatenate([[0], np.cumsum([len(s) for s in params])]).astype(np.int32)
        ends = np.array([(edge.start, edge.end) for edge in outline.edges], dtype=np.int32).reshape(-1, 2)
        loops = [
            (KINDS[loop.kind], [e for e, _ in loop.edges], [f for _, f in loop.edges], loop.piece)
            for loop in outline.loops
        ]
        embedded = np.array(outline.embedded, dtype=np.int32)
        rounds = [edge.kind in ("line", "arc") for edge in outline.edges]
        check = _kernels.OutlineCheck(
            first,
            ends,
            loops,
            CLEARANCE * size,
            SHARPEST,
            rounds,
            outline.layout.control_piece[list(outline.embedded)].tolist(),
        )
        reference = outline.points if gesture is None else gesture.reference
        basis = None if gesture is None else gesture.basis
        along, across = np.zeros((2, *outline.points.shape)) if basis is None else basis
        fields = (reference, along, across)
        p0, p1, p2 = (self._chain(params, points) for points in fields)
        e0, e1, e2 = (np.ascontiguousarray(points[embedded]) for points in fields)
        rigid = gesture is not None and gesture.kind in ("drag", "rotate")
        check.set_motion(p0, p1, p2, e0, e1, e2, self._states(), rigid)
        return check

    def _chain(self, params: list[Reals], points: Reals) -> Reals:
        chains = [self.outline.point(e, s, points) for e, s in enumerate(params)]
        return np.ascontiguousarray(np.concatenate(chains))

    def _states(self) -> Bytes:
        gesture, edges = self.gesture, self.outline.edges
        if gesture is None or gesture.basis is None:
            return np.full(len(edges), BENDING, dtype=np.uint8)
        moves = gesture.basis.any(axis=(0, 2))
        states = np.zeros(len(edges), dtype=np.uint8)
        for i, controls in enumerate(self.outline.layout.controls):
            if moves[controls].any():
                states[i] = WHOLE if gesture.whole[controls].all() else BENDING
        return states


def _meeting_points(outline: Outline) -> str | None:
    """That two embedded points of a shape are at one place, or nearly; None where none are."""
    spots, gap = list(outline.embedded), CLEARANCE * outline.size
    apart = np.linalg.norm(outline.points[spots][:, None] - outline.points[spots], axis=2)
    one, other = np.nonzero(np.triu(apart < gap, 1))
    if not len(one):
        return None
    names = [outline.vertex_names[spots[k]] for k in (one[0], other[0])]
    return f"points {' and '.join(names)} would come closer than {gap:.2g} m"


def problem(outline: Outline, moved_points: Reals | None = None) -> str | None:
    """What is wrong with a shape, in one sentence that names the edges; None when it is valid.

    Args:
        outline: the shape.
        moved_points: (k, 2) control points to judge instead of its own.
    """
    shape = outline if moved_points is None else outline.moved(moved_points)
    if not (np.isfinite(shape.points).all() and np.isfinite(shape.bulges).all()):
        return "a coordinate is not a finite number"
    extent = float(np.ptp(shape.points, axis=0).max())
    if extent > REACH * shape.size:
        return beyond_reach("make the shape", f"{extent:.3g} m large", shape)
    try:
        return MotionCheck(shape).problem()
    except UserError as error:
        return error.what


def beyond_reach(does: str, what: str, outline: Outline) -> str:
    """The sentence for an edit that goes farther than `bounds.REACH` allows."""
    far = f"more than {REACH:g} times the {outline.size:.3g} m that it had at first"
    return f"this would {does} {what}, {far}: check the units"


def too_far(outline: Outline, way: tuple[float, float]) -> str | None:
    """Why parts of a shape cannot go that way (x, y) [m] in one edit; None where they can."""
    far = max(map(abs, way))
    return None if far <= REACH * outline.size else beyond_reach("move the shape by", f"{far:.3g} m", outline)


def _panels(outline: Outline, i: int, j: int) -> str:
    """The names of the panels of two edges where they are two."""
    one, other = (outline.piece_names[outline.layout.edge_piece[edge]] for edge in (i, j))
    return f"{one} and {other}" if one != other else ""


def _closest(outline: Outline, i: int, j: int, begin: Reals) -> tuple[float, float]:
    """Where two edges are close [m]: an end of the straight piece of the one that begins there, or of the other's."""
    one, other = (outline.polyline(e, CHORD * outline.size) for e in (i, j))
    k = int(np.hypot(*(one[:-1] - begin).T).argmin())
    piece = one[k : k + 2]
    found = []
    for points, chain in ((piece, other), (other, piece)):
        starts, ways = chain[:-1], np.diff(chain, axis=0)
        off = points[:, None] - starts
        squares = np.maximum((ways * ways).sum(axis=1), np.finfo(float).tiny)
        share = np.clip((off * ways).sum(axis=2) / squares, 0.0, 1.0)
        away = np.linalg.norm(off - share[..., None] * ways, axis=2).min(axis=1)
        found.append((float(away.min()), points[int(away.argmin())]))
    x, y = min(found, key=lambda pair: pair[0])[1]
    return float(x), float(y)


def describe(outline: Outline, found: tuple[str, int, int, float, float]) -> str:
    """The sentence for a finding (what, i, j, x, y) of the kernel in a shape, with the place of edges that touch."""
    what, i, j, x, y = found
    if what == "touch":
        x, y = _closest(outline, i, j, np.array([x, y]))
    # Rounding makes 1e-17 of what is 0.
    x, y = (0.0 if abs(value) < 1e-9 * outline.size else value for value in (x, y))
    place = f"near {place_words(outline, x, y, i)}" if what in ("cross", "touch", "fold", "short") else ""
    edges, loops = outline.edges, outline.loops
    gap = CLEARANCE * outline.size
    if what == "overlap":
        return f"panel {loops[i].name} would lie inside panel {loops[j].name}"
    if what in ("cross", "touch") and (both := _panels(outline, i, j)):
        return f"panels {both} would overlap, or nearly: edges {edges[i].name} and {edges[j].name} meet {place}"
    if what == "cross":
        return f"edge {edges[i].name} would cross " + ("itself" if i == j else f"edge {edges[j].name}") + f" {place}"
    if what == "touch":
        return f"edges {edges[i].name} and {edges[j].name} would come closer than {gap:.2g} m {place}"
    if what == "fold":
        return f"edges {edges[i].name} and {edges[j].name} would fold onto each other {place}"
    if what == "short":
        return f"edge {edges[i].name} would collapse: shorter than {gap:.2g} m {place}"
    if what == "turned":
        return f"loop {loops[i].name} would turn inside out or lose its area"
    if what == "outside":
        return f"{loops[i].kind} {loops[i].name} would lie outside the outline"
    if what == "nested":
        return f"{loops[i].kind} {loops[i].name} would lie inside hole {loops[j].name}"
    name = outline.vertex_names[outline.embedded[i]]
    if what == "point_near":
        return f"point {name} would come closer than {gap:.2g} m to edge {edges[j].name}"
    if what == "point_outside":
        return f"point {name} would lie outside the outline"
    return f"point {name} would lie inside hole {loops[j].name}"
