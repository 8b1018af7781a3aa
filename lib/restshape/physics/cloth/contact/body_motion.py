"""Where points that stick to a body are when the body has moved, turned or grown."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from restshape.physics.cloth.mannequin.growth import taken_to
from restshape.scene.bodies import Body, MannequinBody
from restshape.shape.placement import rotation, rotation_rates

PASSED = -0.95
"""Cosine of the angle between two axes of a capsule beyond which its ends, which go straight, passed each other."""

Frame = tuple[np.ndarray, np.ndarray]


def body_axes(body: Body) -> Frame:
    """The origin (3,) [m] of a body of numbers, and the matrix (3, 3) that takes its own coordinates to space."""
    form = body.form
    match body.kind:
        case "sphere":
            return np.array(form.center), form.radius * np.eye(3)
        case "box":
            return np.array(form.center), rotation(form.rotate) @ np.diag(form.half)
        case "mesh" | "mannequin":
            return np.array(form.move), form.scale * rotation(form.turn)
        case "capsule" | "cylinder":
            start, end = np.array(form.start), np.array(form.end)
            length = float(np.linalg.norm(end - start)) or form.radius
            return 0.5 * (start + end), _axes(end - start) * (length, form.radius, form.radius)
        case _:
            return np.array(form.point), _axes(np.array(form.normal))


def is_remade(before: Body, after: Body) -> bool:
    """Whether a body of numbers is a mannequin that has other sizes."""
    old, new = before.form, after.form
    if not (isinstance(old, MannequinBody) and isinstance(new, MannequinBody)):
        return False
    return old.sizes != new.sizes and all(getattr(old, key) == getattr(new, key) for key in new.settings)


def moved_with(before: Body, after: Body, points: np.ndarray) -> np.ndarray:
    """Where points (n, 3) [m] on a body are after it has moved; a body of another kind takes none along.

    Args:
        before, after: of numbers alone, without formulas.
    """
    if before.kind != after.kind or before.form == after.form:
        return points
    (from_, A), (to, B) = body_axes(before), body_axes(after)
    if is_remade(before, after):
        own = taken_to(before.form, after.form, (points - from_) @ np.linalg.inv(A).T)
        return own @ B.T + to
    if before.kind in ("capsule", "cylinder", "plane"):
        B = _turn(A[:, 0], _onward(before, A[:, 0], B[:, 0])) @ _axes(A[:, 0]) * np.linalg.norm(B, axis=0)
    return (points - from_) @ np.linalg.inv(A).T @ B.T + to


def turn_of(before: Body, after: Body) -> np.ndarray:
    """The turn (3, 3) of a body of numbers from one place to another; spheres have none."""
    match before.kind:
        case "sphere":
            return np.eye(3)
        case "box":
            return rotation(after.form.rotate) @ rotation(before.form.rotate).T
        case "mesh" | "mannequin":
            return rotation(after.form.turn) @ rotation(before.form.turn).T
        case _:
            first, second = body_axes(before)[1][:, 0], body_axes(after)[1][:, 0]
            return _turn(first, _onward(before, first, second))


def turning_of(before: Body, after: Body) -> float:
    """The angle [rad] by which a body turns while its numbers go straight, at most; 0 of spheres and half-spaces."""
    match before.kind:
        case "sphere" | "plane":
            return 0.0
        case "box":
            return float(np.abs(np.subtract(after.form.rotate, before.form.rotate)).sum())
        case "mesh" | "mannequin":
            return float(np.abs(np.subtract(after.form.turn, before.form.turn)).sum())
        case _:
            cosine = 0.5 * (float(np.trace(turn_of(before, after))) - 1.0)
            return float(np.arccos(np.clip(cosine, -1.0, 1.0)))


def turned_share(before: Body, after: Body, parts: int) -> float:
    """The share of its way on which a body turns by one of so many even parts of `turning_of`."""
    if parts == 1 or before.kind not in ("capsule", "cylinder"):
        return 1.0 / parts
    whole = turning_of(before, after)
    first, last = (float(np.linalg.norm(body_axes(body)[1][:, 0])) for body in (before, after))
    # The tip of the axis goes straight: the law of sines, on both sides of where it is then.
    gone, left = first * np.sin(whole / parts), last * np.sin(whole - whole / parts)
    return float(gone / (gone + left))


def _axes(axis: np.ndarray) -> np.ndarray:
    """Columns (3, 3) of length 1: along an axis, and two across it."""
    length = np.linalg.norm(axis)
    if length == 0.0:
        return np.eye(3)
    a = axis / length
    # The coordinate axis that it has least of is never along it.
    b = np.cross(a, np.eye(3)[np.argmin(np.abs(a))])
    b /= np.linalg.norm(b)
    return np.column_stack([a, b, np.cross(a, b)])


def _onward(body: Body, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """The direction that an axis has after: its ends have passed each other where it looks the other way then."""
    opposite = before @ after < PASSED * np.linalg.norm(before) * np.linalg.norm(after)
    return -after if opposite and body.kind != "plane" else after


def _turn(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """The least turn (3, 3) of a direction into another one: a body that is round about it does not roll."""
    a, b = before / np.linalg.norm(before), after / np.linalg.norm(after)
    middle = a + b
    square = middle @ middle
    # Half a turn goes about any direction across; elsewhere two mirrors make the turn.
    if square < 1e-20:
        across = _axes(a)[:, 1]
        return 2.0 * np.outer(across, across) - np.eye(3)
    return (np.eye(3) - 2.0 / square * np.outer(middle, middle)) @ (np.eye(3) - 2.0 * np.outer(a, a))


def taken_rates(body: Body, rates: Mapping[str, Any], points: np.ndarray) -> np.ndarray:
    """Rates (n, 3) [m] of `moved_with` of points (n, 3) [m] on a body as its numbers begin to change.

    Args:
        body: of numbers alone.
        rates: of the numbers of its form, by key.
    """
    form = body.form
    match body.kind:
        case "sphere":
            return rates["center"] + rates["radius"] / form.radius * (points - form.center)
        case "box":
            own = (points - form.center) @ rotation(form.rotate)
            turned = own @ rotation_rates(form.rotate, rates["rotate"]).T
            return rates["center"] + turned + own * (rates["half"] / np.array(form.half)) @ rotation(form.rotate).T
        case "mesh" | "mannequin":
            places = points - form.move
            turned = places @ rotation(form.turn) @ rotation_rates(form.turn, rates["turn"]).T
            return rates["move"] + turned + rates["scale"] / form.scale * places
        case "capsule" | "cylinder":
            start, end = np.array(form.start), np.array(form.end)
            middle, along = 0.5 * (rates["start"] + rates["end"]), rates["end"] - rates["start"]
            return middle + _grown(points - 0.5 * (start + end), end - start, along, form.radius, rates["radius"])
        case _:
            normal = np.array(form.normal)
            size = np.linalg.norm(normal)
            turn = np.cross(normal, rates["normal"]) / size**2
            return rates["point"] + np.cross(turn, points - form.point)


def _grown(places: np.ndarray, axis: np.ndarray, rate: np.ndarray, radius: float, wider: float) -> np.ndarray:
    """Rates (n, 3) of places (n, 3) beside the middle of an axis (3,) that turns and grows, in a radius that grows."""
    length = np.linalg.norm(axis)
    if length == 0.0:
        return wider / radius * places
    unit = axis / length
    along = (places @ unit)[:, None] * unit
    turned = np.cross(np.cross(unit, rate / length), places)
    return turned + (unit @ rate) / length * along + wider / radius * (places - along)
