"""What is in the openings of cloth: bodies whose axes pass through the surfaces that span its inner borders."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from restshape.scene.bodies import Body
from restshape.shape.placement import rotation

Inside = dict[str, int]
"""By opening and body, such as ``1 around neck``, how often the body's axis passes through; 0 is left out."""


BESIDE, ASKEW = 1e-5, np.array([0.5773, 0.3314, 0.7463])
"""How far the middle of a fan lies beside that of its loop, over the loop's size, and where: what goes exactly through
the middle, or along a spoke, would be counted more than once."""


def inside(X: np.ndarray, cells: np.ndarray, x: np.ndarray, bodies: Mapping[str, Body]) -> Inside:
    """What is in the openings of cloth.

    Args:
        X: (n, 2) nodes of the pattern [m], whose longest border is no opening.
        cells: (ne, 3) triangles.
        x: (n, 3) places of the nodes [m].
        bodies: of numbers, by name.
    """
    loops = sorted(borders(cells), key=lambda loop: -length(X[loop]))
    found = {}
    for number, loop in enumerate(loops[1:], 1):
        for name, body in bodies.items():
            ends = axis(body, normal(x[loop]))
            if ends is not None and (count := passages(x[loop], *ends)):
                found[f"{number} around {name}"] = abs(count)
    return found


def kept(before: Inside, after: Inside) -> bool | None:
    """Whether all that was in an opening still is; None where nothing was."""
    return all(after.get(name) == count for name, count in before.items()) if before else None


def borders(cells: np.ndarray) -> list[np.ndarray]:
    """The closed chains of nodes that bound triangles (ne, 3)."""
    edges = {(int(a), int(b)) for cell in cells[:, :3] for a, b in zip(cell, np.roll(cell, -1))}
    following = {a: b for a, b in edges if (b, a) not in edges}
    loops = []
    while following:
        first, node = following.popitem()
        loop = [first]
        while node != first:
            loop.append(node)
            node = following.pop(node)
        loops.append(np.array(loop))
    return loops


def length(points: np.ndarray) -> float:
    """The length of a closed chain of points (k, d)."""
    return float(np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1).sum())


def normal(points: np.ndarray) -> np.ndarray:
    """The unit normal (3,) of the area that a closed chain of points (k, 3) encloses."""
    from_middle = points - points.mean(axis=0)
    area = np.cross(from_middle, np.roll(from_middle, -1, axis=0)).sum(axis=0)
    return area / (np.linalg.norm(area) or 1.0)


def axis(body: Body, across: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """The ends (3,) of a body's axis, of a ball that along a direction (3,); None of a half-space."""
    form = body.form
    match body.kind:
        case "sphere":
            return form.center - form.radius * across, form.center + form.radius * across
        case "capsule":
            start, end = np.array(form.start), np.array(form.end)
            along = end - start
            beyond = form.radius / (np.linalg.norm(along) or 1.0) * along
            return start - beyond, end + beyond
        case "cylinder":
            return np.array(form.start), np.array(form.end)
        case "box":
            k = int(np.argmax(form.half))
            along = form.half[k] * rotation(form.rotate)[:, k]
            return form.center - along, form.center + along
        case _:
            return None


def passages(loop: np.ndarray, start: np.ndarray, end: np.ndarray) -> int:
    """How often a way from start to end (3,) passes through the fan that spans a loop (k, 3), by its sense."""
    middle, second = loop.mean(axis=0) + BESIDE * np.ptp(loop, axis=0).max() * ASKEW, np.roll(loop, -1, axis=0)
    u, v, way = loop - middle, second - middle, end - start
    normals = np.cross(u, v)
    steep = normals @ way
    with np.errstate(divide="ignore", invalid="ignore"):
        at = normals @ (middle - start) / steep
        place = start + at[:, None] * way - middle
        square = (normals**2).sum(axis=1)
        a = (np.cross(place, v) * normals).sum(axis=1) / square
        b = (np.cross(u, place) * normals).sum(axis=1) / square
        hit = (at >= 0.0) & (at <= 1.0) & (a >= 0.0) & (b >= 0.0) & (a + b <= 1.0)
    return int(np.sign(steep[hit]).sum())
