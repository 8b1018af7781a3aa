"""A drawing for a workshop: what is cut out, the holes in it, and what is engraved, each on a layer of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from restshape.arrays import Reals
from restshape.export.kerf import tool_path
from restshape.export.shape_tables import shape_tables
from restshape.scene.model import ShapeSpec
from restshape.scene.plain_values import Table, table_in
from restshape.shape.build import outline_from_spec
from restshape.shape.outline import Outline

CUT, HOLES, ENGRAVE = "CUT", "HOLES", "ENGRAVE"
"""Layers of what is cut out, of holes, and of what is engraved alone."""
LAYER_OF = {"outline": CUT, "hole": HOLES, "region": ENGRAVE}


@dataclass(frozen=True)
class EngravedText:
    """A text about its middle.

    Args:
        text: one line; place: (2,) [m]; height: of capital letters [m].
    """

    text: str
    place: Reals
    height: float


@dataclass(frozen=True)
class Engraving:
    """What an application has engraved and drilled besides what the shape says.

    Args:
        holes: centre (2,) and radius [m] of round holes that the shape lacks, by name.
        crosses: (n, 2) places that are marked [m]; arm: half the length of the lines of a cross [m].
        texts: that are engraved.
        notes: for people.
    """

    holes: Mapping[str, tuple[Reals, float]] = field(default_factory=dict)
    crosses: Reals = field(default_factory=lambda: np.zeros((0, 2)))
    arm: float = 1e-3
    texts: Sequence[EngravedText] = ()
    notes: Sequence[str] = ()

    def lines(self) -> list[Reals]:
        """The lines (2, 2) [m] of all crosses."""
        ways = self.arm * np.eye(2)
        return [np.array([place - way, place + way]) for place in self.crosses for way in ways]


@dataclass(frozen=True)
class CutDrawing:
    """What is drawn.

    Args:
        path: of the tool: the outline and its holes.
        shape: whose regions and points are engraved.
        engraving: what is engraved besides.
    """

    path: Outline
    shape: Outline
    engraving: Engraving

    def edges(self, *layers: str) -> list[tuple[str, Outline, int, bool]]:
        """Layer, outline, number and direction of each edge on these layers, in their order.

        Regions that share edges with the border have their other edges engraved.
        """
        border = {e for loop in self.shape.loops if loop.kind != "region" for e, _ in loop.edges}
        engraved: dict[int, bool] = {}
        for loop in self.shape.loops:
            if loop.kind == "region":
                engraved |= {e: forward for e, forward in loop.edges if e not in border}
        found = [(ENGRAVE, self.shape, e, forward) for e, forward in engraved.items()]
        for loop in self.path.loops:
            if loop.kind != "region":
                found += [(LAYER_OF[loop.kind], self.path, e, forward) for e, forward in loop.edges]
        return [edge for layer in layers for edge in found if edge[0] == layer]

    def points(self) -> Reals:
        """Points (n, 2) [m] of the shape inside of the material."""
        return self.shape.points[list(self.shape.embedded)]

    def path_length(self) -> float:
        """How far the tool goes [m]."""
        lengths = self.path.lengths()
        return float(sum(lengths[e] for loop in self.path.loops if loop.kind != "region" for e, _ in loop.edges))


def cut_drawing(outline: Outline, kerf: float, engraving: Engraving) -> CutDrawing:
    """The drawing of a shape with what is engraved and drilled besides.

    Args:
        outline: the shape; kerf: width of the cut [m], or 0; engraving: of its application.

    Raises:
        UserError: a hole does not fit into the shape, or the cut does not fit into a hole or a bay.
    """
    drilled = with_holes(outline, engraving.holes) if engraving.holes else outline
    return CutDrawing(tool_path(drilled, kerf) if kerf else drilled, drilled, engraving)


def with_holes(outline: Outline, holes: Mapping[str, tuple[Reals, float]]) -> Outline:
    """A shape with round holes besides: centre (2,) and radius [m] by name.

    Raises:
        UserError: one of them crosses an edge, leaves the outline, or has a name that is used already.
    """
    return outline_from_spec(ShapeSpec.model_validate(tables_with_circles(outline, holes)))


def tables_with_circles(outline: Outline, circles: Mapping[str, tuple[Reals, float]], kind: str = "holes") -> Table:
    """The plain tables of a ``[shape]`` with circles besides, as "holes" or as "regions"; arguments as of `with_holes`.

    Points that lie in a hole are left out.
    """
    tables = shape_tables(outline)
    added = {
        name: {"circle": {"center": [float(x) for x in centre], "radius": float(radius)}}
        for name, (centre, radius) in circles.items()
    }
    if kind == "holes":
        points = table_in(tables, "points").items()
        tables["points"] = {name: place for name, place in points if not _inside(np.array(place), circles)}
    return {**tables, kind: table_in(tables, kind) | added}


def _inside(place: Reals, circles: Mapping[str, tuple[Reals, float]]) -> bool:
    """Whether a place (2,) [m] lies in one of some circles."""
    return any(float(np.hypot(*(place - centre))) <= radius for centre, radius in circles.values())
