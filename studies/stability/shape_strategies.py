"""Hypothesis strategies of numbers, places and shapes, which scenes of all applications share."""

import math
from typing import Any

from hypothesis import strategies as st

Table = dict[str, Any]


# Numbers of few digits shrink to what people can read.
def numbers(least: float, most: float) -> st.SearchStrategy[float]:
    """Numbers of at most three decimals."""
    return st.integers(math.ceil(1000 * least), math.floor(1000 * most)).map(lambda k: k / 1000)


places = st.tuples(numbers(-1.5, 1.5), numbers(-1.5, 1.5)).map(list)
angles = numbers(-4, 4)


@st.composite
def shapes(draw: st.DrawFn) -> tuple[Table, float]:
    """The [shape] of an outline about the origin, with or without a hole, a region and a point, and its area [m^2]."""
    count = draw(st.integers(3, 6))
    turns = [(k + draw(numbers(-0.25, 0.25))) * 2 * math.pi / count for k in range(count)]
    corners = [(r * math.cos(a), r * math.sin(a)) for a, r in ((a, draw(numbers(0.5, 1.0))) for a in turns)]
    corners = [(round(x, 3), round(y, 3)) for x, y in corners]
    edges = {}
    for k, (p, q) in enumerate(zip(corners, [*corners[1:], corners[0]]), start=1):
        ends = [f"p{k}", f"p{k % count + 1}"]
        middle = [round(0.52 * (p[i] + q[i]), 3) for i in (0, 1)]
        kind = draw(st.sampled_from(["line", "line", "line", "arc", "spline", "polyline"]))
        more = {"line": {}, "arc": {"bulge": draw(numbers(-0.2, 0.3))}}.get(kind, {"through": [middle]})
        edges[f"e{k}"] = {kind: ends, **more}
    shape: Table = {"outline": list(edges), "vertices": {f"p{k}": list(p) for k, p in enumerate(corners, start=1)}}
    shape["edges"] = edges
    if draw(st.booleans()):
        round_hole = {"circle": {"center": [-0.1, 0.0], "radius": draw(numbers(0.01, 0.12))}}
        square = {"polygon": [[-0.15, -0.05], [-0.05, -0.05], [-0.05, 0.05], [-0.15, 0.05]]}
        shape["holes"] = {"window": draw(st.sampled_from([round_hole, square]))}
    if draw(st.integers(0, 2)) == 0:
        shape["regions"] = {"patch": {"polygon": [[0.06, -0.06], [0.18, -0.06], [0.18, 0.06], [0.06, 0.06]]}}
    if draw(st.integers(0, 4)) == 0:
        shape["points"] = {"probe": [0.0, 0.15]}
    area = 0.5 * sum(p[0] * q[1] - p[1] * q[0] for p, q in zip(corners, [*corners[1:], corners[0]]))
    return shape, area


def entities(shape: Table) -> list[str]:
    """Names that a shape gives: corners, edges, hole, region, point."""
    named = [*shape["vertices"], *shape["edges"], *shape.get("holes", {}), *shape.get("regions", {})]
    inner = [f"window.{part}" for part in ("1", "2", "v1")] if "holes" in shape else []
    return [*named, *inner, *shape.get("points", {})]


def sides(shape: Table) -> list[str]:
    """Names of what has a boundary: edges, the outline, a hole."""
    return [*shape["edges"], "outline", *shape.get("holes", {})]


def mesh_size(area: float, elements: int) -> float:
    """The size [m] of a mesh of about so many triangles over an area [m^2]."""
    return round(math.sqrt(4 * area / (math.sqrt(3) * elements)), 3)
