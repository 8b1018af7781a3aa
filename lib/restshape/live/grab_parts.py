"""What can be taken hold of, as lines and dots of the picture, each with its name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from restshape import _kernels
from restshape.arrays import AnyArray, Complexes, Indices, Reals
from restshape.errors import UserError
from restshape.live.frame_arrays import PicturePart, sent_indices, sent_points
from restshape.shape.curves import arc_fraction
from restshape.shape.outline import Outline

PIECES = 32
"""Of an edge as long as the shape is large, at least."""


@dataclass(frozen=True)
class Thing:
    """An entity, a body, or a support, which a hand may take hold of.

    Args:
        name: that events use; role: what it is, as `ThingInfo.role` of `page/src/protocol.ts`.
        grabs: events that take hold of it.
        part: of the picture, which draws it.
        lines: names of the lines, or dots, that draw it; empty: those of its own name.
        parameters: that may be held in its stead.
        triangles: of the part's triangles those that draw it: for each run of them the first, and how many; empty: all.
    """

    name: str
    role: str
    grabs: Sequence[str]
    part: str
    lines: Sequence[str] = ()
    parameters: Sequence[str] = ()
    triangles: Sequence[tuple[int, int]] = ()

    def said(self) -> dict[str, object]:
        """What the page gets."""
        found: dict[str, object] = {"name": self.name, "role": self.role, "grabs": [*self.grabs], "part": self.part}
        more = {"lines": [*self.lines], "parameters": [*self.parameters], "triangles": [*self.triangles]}
        return found | {key: value for key, value in more.items() if value}


@dataclass(frozen=True, eq=False)
class OutlineCurves:
    """Points on all edges of an outline, linear in its control points as long as no arc bends.

    Args:
        first: (n_edges + 1,) where the points of each edge start, the last one how many there are.
        ends: (2, m) control points at both ends of the edge of each point.
        share: (m,) complex: of the way from one end to the other, turned about the first.
        curved: of edges with inner points: where their points are, their control points, and the weights of these.
    """

    first: Indices
    ends: Indices
    share: Complexes
    curved: Sequence[tuple[slice, Indices, Reals]]

    @classmethod
    def none(cls) -> OutlineCurves:
        """No points."""
        return cls(np.zeros(1, dtype=np.int32), np.zeros((2, 0), dtype=np.int32), np.zeros(0, dtype=complex), ())

    @classmethod
    def of(cls, outline: Outline, parameters: Sequence[Reals]) -> OutlineCurves:
        """Those at parameters (n,) of each edge, from 0 to 1."""
        first = np.concatenate([[0], np.cumsum([len(s) for s in parameters])]).astype(np.int32)
        ends = np.ascontiguousarray(np.repeat(outline.layout.ends, np.diff(first), axis=0).T)
        share, curved = np.zeros(first[-1], dtype=complex), []
        for edge, s in enumerate(parameters):
            here = slice(int(first[edge]), int(first[edge + 1]))
            controls = outline.layout.controls[edge]
            if edge in outline.layout.curved:
                units = np.zeros((len(controls), len(outline.points), 2))
                units[np.arange(len(controls)), controls, 0] = 1.0
                curved.append((here, controls, np.column_stack([outline.point(edge, s, unit)[:, 0] for unit in units])))
            else:
                share[here] = arc_fraction(float(outline.bulges[edge]), s)
        return cls(first, ends, share, curved)

    def sent(self, controls: Reals, vertices: int) -> tuple[AnyArray, AnyArray]:
        """The points (m, 2) of control points (k, 2), and the first of these, as they travel."""
        lines, dots = _kernels.sent_outline(controls, self.ends, self.share, vertices)
        for here, own, weights in self.curved:
            lines[here] = weights @ controls[own]
        return lines, dots


class OutlineParts:
    """The edges of an outline as lines, its vertices and the control points of its curves as dots.

    Arrays that have not changed from frame to frame are the same objects.
    """

    def __init__(self) -> None:
        self._outline: Outline | None = None
        self._topology = -1
        self._parts: list[PicturePart] = []
        self._curves = OutlineCurves.none()
        self._controls: list[int] = []

    def __call__(self, outline: Outline | None) -> list[PicturePart]:
        """The parts of an outline; none without one."""
        if outline is None or outline is self._outline:
            return self._parts
        if outline.topology != self._topology or self._bent(outline):
            self._cut(outline)
        self._outline = outline
        edges, vertices, controls = self._parts
        lines, dots = self._curves.sent(outline.points, len(outline.vertex_names))
        edges = PicturePart("outline", "lines", "outline", {**edges.arrays, "points": lines}, edges.said)
        vertices = _moved(vertices, dots)
        if self._controls or not controls.arrays:
            controls = _moved(controls, sent_points(outline.points[self._controls]))
        self._parts = [edges, vertices, controls]
        return self._parts

    def _bent(self, outline: Outline) -> bool:
        """Whether curves have bent since they were cut into pieces."""
        before = self._outline
        return before is not None and (outline.bulges is not before.bulges or outline.layout is not before.layout)

    def _cut(self, outline: Outline) -> None:
        """Cut the edges of a layout into pieces."""
        self._topology = outline.topology
        error = 5e-4 * outline.size
        self._curves = OutlineCurves.of(outline, [_pieces(outline, edge, error) for edge in range(len(outline.edges))])
        controls = [(k, edge.name) for edge in outline.edges for k in edge.inner]
        self._controls = [k for k, _ in controls]
        starts = sent_indices(self._curves.first[:-1], int(self._curves.first[-1]))
        self._parts = [
            PicturePart(
                "outline", "lines", "outline", {"starts": starts}, {"names": [edge.name for edge in outline.edges]}
            ),
            PicturePart("vertices", "dots", "outline", {}, {"names": list(outline.vertex_names)}),
            PicturePart("controls", "dots", "outline", {}, {"names": [name for _, name in controls]}),
        ]


def _moved(part: PicturePart, points: AnyArray) -> PicturePart:
    """Dots at other places; the same ones where they are the same."""
    before = part.arrays.get("points")
    if before is not None and before.shape == points.shape and before.tobytes() == points.tobytes():
        return part
    return PicturePart(part.name, part.kind, part.role, {"points": points}, part.said)


def _pieces(outline: Outline, edge: int, error: float) -> Reals:
    """Parameters along an edge, a few where it has too many pieces; straight edges bend with the shape, too."""
    try:
        found = outline.pieces(edge, error)
    except UserError:
        return np.linspace(0.0, 1.0, 65)
    length = float(np.hypot(*np.diff(outline.point(edge, found), axis=0).T).sum())
    return np.union1d(found, np.linspace(0.0, 1.0, int(np.ceil(PIECES * length / outline.size)) + 1))


def things_of(outline: Outline | None) -> list[Thing]:
    """What of an outline can be taken hold of."""
    if outline is None:
        return []
    edges = outline.edges
    found = [Thing(name, "vertex", ("press",), "vertices") for name in outline.vertex_names]
    for edge in edges:
        curved = edge.kind != "line"
        found.append(Thing(edge.name, "edge", ("press", "pull") if curved else ("press",), "outline"))
    found += [
        Thing(name, "control", ("pull",), "controls")
        for name in dict.fromkeys(edge.name for edge in edges if edge.inner)
    ]
    panels = outline.piece_names
    for loop in outline.loops:
        role = loop.kind if loop.kind != "outline" else "panel" if panels != ("outline",) else ""
        if role:
            names = [edges[edge].name for edge, _ in loop.edges]
            found.append(Thing(loop.name, role, ("press",), "outline", names))
    for name in outline.groups:
        entity = outline.entity(name)
        part = "outline" if entity.edges else "vertices"
        names = [edges[e].name for e in entity.edges] or [outline.vertex_names[v] for v in entity.vertices]
        found.append(Thing(name, "group", ("press",), part, names))
    return found
