"""Bodies as triangles to draw."""

from __future__ import annotations

from itertools import product

import numpy as np
from scipy.spatial import ConvexHull

from restshape.physics.cloth.contact.body_motion import body_axes
from restshape.physics.cloth.contact.mesh_bodies import located_distance, placed_surface
from restshape.physics.cloth.mannequin.growth import mannequin_surface
from restshape.scene.bodies import POINTS, Body, Box, Capsule, Cylinder, MannequinBody, MeshBody, Plane, Sphere
from restshape.scene.model import Scene
from restshape.shape.placement import rotation

PIECES = 48
"""Pieces of a turn."""

KEPT = 64
"""Surfaces that are kept, of bodies that may come back."""

Surface = tuple[np.ndarray, np.ndarray]
"""Places (n, 3) [m] and triangles (m, 3)."""
_MADE: dict[str, Surface] = {}


def body_surface(body: Body, low: np.ndarray, high: np.ndarray, own: Surface | None = None) -> Surface:
    """The surface of a body as triangles, which look outwards; of a plane at least what lies within a box.

    Args:
        body: of numbers.
        low, high: (3,) corners of the box [m].
        own: of a body of triangles, in its own coordinates [m].
    """
    form = body.form
    match form:
        case MeshBody():
            return (np.empty((0, 3)), np.empty((0, 3), int)) if own is None else (placed_surface(form, own[0]), own[1])
        case MannequinBody():
            made = mannequin_surface(form.sizes, form.size)
            return placed_surface(form, made.X), made.cells
        case Sphere():
            return _rounded(np.array([form.center]), form.radius)
        case Capsule():
            return _rounded(np.array([form.start, form.end]), form.radius)
        case Cylinder():
            return _rounded(_rims(form), form.rounded)
        case Box():
            turn, half = rotation(form.rotate), np.array(form.half) - form.radius
            places, triangles = _rounded(np.array(list(product((-1.0, 1.0), repeat=3))) * half, form.radius)
            return places @ turn.T + form.center, triangles
        case _:
            return _square(form, low, high)


def surface_in_scene(scene: Scene, name: str, low: np.ndarray, high: np.ndarray) -> Surface:
    """The surface of a body of a scene as it is now; low and high as of `body_surface`.

    A body that has only moved is not made again.
    """
    body = scene.bodies[name].evaluated(scene.parameters)
    form, own = body.form, None
    if isinstance(form, Plane):
        return body_surface(body, low, high)
    if isinstance(form, MeshBody):
        known = located_distance(scene, name)
        own = known.X, known.cells
    points = POINTS[body.kind]
    shift = np.array(getattr(form, points[0]))
    there = {key: tuple(np.round(np.array(getattr(form, key)) - shift, 12).tolist()) for key in points}
    places, triangles = _made(body.model_copy(update={body.kind: form.model_copy(update=there)}), own)
    return places + shift, triangles


def _made(body: Body, own: Surface | None) -> Surface:
    """The surface of a body without its place; those that were made last are kept."""
    key = f"{body!r} {0 if own is None else id(own[0])}"
    if key not in _MADE:
        while len(_MADE) >= KEPT:
            del _MADE[next(iter(_MADE))]
        _MADE[key] = body_surface(body, np.zeros(3), np.zeros(3), own)
    return _MADE[key]


def _rims(form: Cylinder) -> np.ndarray:
    """Points (k, 3) of the circles around both ends of a cylinder without its rounding."""
    start, end = np.array(form.start), np.array(form.end)
    axes = body_axes(Body(cylinder=form))[1] / (np.linalg.norm(end - start), form.radius, form.radius)
    around = np.linspace(0.0, 2.0 * np.pi, PIECES, endpoint=False)
    circle = (form.radius - form.rounded) * (
        np.outer(np.cos(around), axes[:, 1]) + np.outer(np.sin(around), axes[:, 2])
    )
    inwards = form.rounded * axes[:, 0]
    return np.vstack([start + inwards + circle, end - inwards + circle])


def _rounded(
    core: np.ndarray, radius: float, turn: np.ndarray | None = None, center: float | np.ndarray = 0.0
) -> Surface:
    """All within a radius of what is between some points (k, 3), turned and moved."""
    around = np.linspace(0.0, 2.0 * np.pi, PIECES, endpoint=False)[:, None]
    up = np.linspace(-0.5 * np.pi, 0.5 * np.pi, PIECES // 2 + 1)
    x, y, z = np.cos(around) * np.cos(up), np.sin(around) * np.cos(up), np.sin(up) + 0.0 * around
    ball = radius * np.stack([x, y, z], axis=-1).reshape(-1, 3)
    hull = ConvexHull((core[:, None] + ball).reshape(-1, 3))
    places, triangles = hull.points[hull.vertices], np.searchsorted(hull.vertices, hull.simplices)
    a, b, c = (places[triangles[:, k]] for k in range(3))
    inwards = (np.cross(b - a, c - a) * hull.equations[:, :3]).sum(axis=1) < 0.0
    triangles[inwards] = triangles[inwards, ::-1]
    return places, triangles


def _square(plane: Plane, low: np.ndarray, high: np.ndarray) -> Surface:
    """A square of a plane, beyond what a box cuts out of it."""
    normal = np.array(plane.normal) / np.linalg.norm(plane.normal)
    first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    first *= 2.0 * np.linalg.norm(high - low) / np.linalg.norm(first)
    middle = 0.5 * (low + high)
    middle = middle - normal * (normal @ (middle - plane.point))
    second = np.cross(normal, first)
    corners = [middle - first - second, middle + first - second, middle + first + second, middle - first + second]
    return np.array(corners), np.array([[0, 1, 2], [0, 2, 3]])
