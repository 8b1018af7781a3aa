"""Where the named entities of an outline are, as lines and points, and which way is outwards."""

from dataclasses import dataclass

import numpy as np

from restshape.report.inner_points import inner_point
from restshape.shape.outline import Outline

ALONG = 7
"""Points along a chain of edges at which arrows stand, at most."""
CHORD = 2e-5
"""How far curves are drawn from themselves, over the size of the shape."""


@dataclass(frozen=True)
class Place:
    """Where an entity is.

    Args:
        lines: (m, 2) points along each of its edges [m].
        points: (k, 2) its vertices, of an entity without edges [m].
        at: (p, 2) points spread over it, where arrows stand [m].
        outwards: (p, 2) unit vectors out of the body at these; 0 at vertices.
        inside: a point (2,) [m] in the material of an area, or in a hole; else its middle.
    """

    lines: list[np.ndarray]
    points: np.ndarray
    at: np.ndarray
    outwards: np.ndarray
    inside: np.ndarray


def place_of(outline: Outline, name: str) -> Place:
    """Where an entity of this name is.

    Raises:
        UserError: there is none.
    """
    entity = outline.entity(name)
    edges = list(entity.edges) if name != "all" else list(outline.entity("outline").edges)
    lines = [smooth(outline, edge) for edge in edges]
    points = outline.points[list(entity.vertices)] if not edges else np.empty((0, 2))
    at, outwards = _spread(outline, edges)
    if not edges:
        at, outwards = points, np.zeros_like(points)
    middle = _middle(outline, lines, points)
    inside = inner_point(outline, name, entity, middle) if entity.loops else middle
    return Place(lines, points, at, outwards, inside)


def smooth(outline: Outline, edge: int) -> np.ndarray:
    """Points (m, 2) along an edge [m] whose chords nobody sees."""
    return outline.polyline(edge, CHORD * outline.size)


def _spread(outline: Outline, edges: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """Points on edges, as many as suits their lengths, and unit vectors out of the body there."""
    if not edges:
        return np.empty((0, 2)), np.empty((0, 2))
    lengths = np.array([outline.length(edge) for edge in edges])
    at, outwards = [], []
    for edge, length in zip(edges, lengths):
        count = max(1, round(ALONG * length / lengths.sum()))
        s = (np.arange(count) + 0.5) / count
        along = outline.tangent(edge, s)
        along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
        at.append(outline.point(edge, s))
        outwards.append(_sense(outline, edge) * np.column_stack([along[:, 1], -along[:, 0]]))
    return np.concatenate(at), np.concatenate(outwards)


def _sense(outline: Outline, edge: int) -> float:
    """1 where the body is on the left of an edge, -1 where it is on the right."""
    for loop in sorted(outline.loops, key=lambda loop: loop.kind == "region"):
        for number, forward in loop.edges:
            if number == edge:
                return 1.0 if forward else -1.0
    return 1.0


def _middle(outline: Outline, lines: list[np.ndarray], points: np.ndarray) -> np.ndarray:
    return np.concatenate([*lines, points]).mean(axis=0) if lines or len(points) else outline.points.mean(axis=0)
