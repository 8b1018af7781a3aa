"""The way of bodies within a frame, and how far along it they may go before they are in the cloth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from restshape.physics.cloth.contact.body_motion import is_remade
from restshape.physics.cloth.contact.contact import Contact
from restshape.physics.cloth.contact.mesh_bodies import reach_of
from restshape.physics.cloth.contact.tunnelling import size_of
from restshape.physics.cloth.mannequin.growth import growth
from restshape.physics.cloth.scene import kernel_body
from restshape.scene.bodies import MEASURES, Body, numbers_of

TUCKED = 0.25
"""How deep a body may get into the cloth before this follows, over the body's smallest size."""
STAIR = 0.75
"""Part of that depth by which one change of a mannequin's sizes takes its surface, at most: its motion has the rest."""
ARRIVED = 0.05
"""Part of that depth at which a body is there."""
NEARLY = 1e-9
"""Share of a way within which it is at its next part."""
LOOKS = 300
"""Distances that are looked at for one advance of a body, at most; it stops where the last one lets it."""


def same_kind(before: Body, after: Body) -> bool:
    """Whether a body is still the one that it was, moved or made larger: one of another file or size is another one."""
    if before.kind != after.kind:
        return False
    fixed = {*type(after.form).model_fields} - {*numbers_of(after.form)}
    fixed |= {*MEASURES} if after.kind == "mannequin" else set()
    return all(getattr(before.form, key) == getattr(after.form, key) for key in fixed)


def goes_on(before: Body, after: Body) -> bool:
    """Whether a body is still the one that it was, or the same mannequin with other sizes."""
    return same_kind(before, after) or is_remade(before, after)


@lru_cache(maxsize=32)
def stairs(before: Body, after: Body) -> int:
    """In how many parts the sizes of a mannequin change, so that none takes its surface farther than `STAIR`."""
    if not is_remade(before, after):
        return 1
    own = STAIR * TUCKED * min(size_of(before), size_of(after))
    return max(1, math.ceil(_grown(before, after) / own))


def _grown(before: Body, after: Body) -> float:
    """How far the surface of a mannequin goes [m], at most, as its sizes change."""
    if not is_remade(before, after):
        return 0.0
    return max(before.form.scale, after.form.scale) * growth(before.form, after.form)


def between(before: Body, after: Body, share: float) -> Body:
    """A body of numbers at a share of its way: all numbers of its form go straight; one of another kind is there.

    Sizes of a mannequin change by `stairs`: each makes another grid.
    """
    if not goes_on(before, after) or share >= 1.0:
        return after
    if is_remade(before, after):
        parts = stairs(before, after)
        return _of_sizes(before, after, share, math.ceil(max(share, 0.0) * parts - NEARLY) / parts)
    form = {key: _mixed(getattr(before.form, key), getattr(after.form, key), share) for key in numbers_of(after.form)}
    return after.model_copy(update={after.kind: after.form.model_copy(update=form)})


def _of_sizes(before: Body, after: Body, share: float, grown: float) -> Body:
    """A mannequin placed at a share of its way, with sizes at another one."""
    shares = {key: grown if key in MEASURES else share for key in numbers_of(after.form)}
    form = {key: _mixed(getattr(before.form, key), getattr(after.form, key), own) for key, own in shares.items()}
    return after.model_copy(update={after.kind: after.form.model_copy(update=form)})


def _mixed(before: Any, after: Any, share: float) -> Any:
    """Numbers, or tuples of them, at a share of the way between two."""
    if isinstance(after, tuple):
        return tuple(_mixed(a, b, share) for a, b in zip(before, after))
    return before + share * (after - before)


@dataclass(frozen=True)
class Speed:
    """How fast a body's surface goes, over the share of its way.

    Args:
        shift: (3,) with all of it [m].
        rest: of the farthest place, at most, besides [m].
    """

    shift: np.ndarray
    rest: float


def speed_of(before: Body, after: Body, x: np.ndarray) -> Speed:
    """How fast the surface of a body of numbers goes, and that of a half-space where cloth is at x (n, 3) [m]."""
    old, new = before.form, after.form
    match after.kind:
        case "sphere":
            return Speed(_way(old.center, new.center), abs(new.radius - old.radius))
        case "box":
            turned = float(np.abs(_way(old.rotate, new.rotate)).sum())
            half = max(float(np.linalg.norm(form.half)) for form in (old, new))
            # A rounding within the sizes moves corners of the box by no more than itself, times the root of 3.
            rounded = np.sqrt(3.0) * abs(new.radius - old.radius)
            return Speed(
                _way(old.center, new.center), float(np.linalg.norm(_way(old.half, new.half))) + turned * half + rounded
            )
        case "mesh" | "mannequin":
            turned = float(np.abs(_way(old.turn, new.turn)).sum())
            larger = abs(new.scale - old.scale)
            return Speed(_way(old.move, new.move), reach_of(new) * (turned * max(old.scale, new.scale) + larger))
        case "capsule" | "cylinder":
            ends = _way(old.start, new.start), _way(old.end, new.end)
            shift, apart = 0.5 * (ends[0] + ends[1]), 0.5 * float(np.linalg.norm(ends[1] - ends[0]))
            rest = apart + abs(new.radius - old.radius)
            if after.kind == "cylinder":
                axis = _way(old.start, old.end)
                rest += max(old.radius, new.radius) * _turning(axis, ends[1] - ends[0])
                rest += np.sqrt(2.0) * abs(new.rounded - old.rounded)
            return Speed(shift, rest)
        case _:
            away = max(float(np.linalg.norm(x - form.point, axis=1).max()) for form in (old, new))
            turned = _turning(np.array(old.normal), _way(old.normal, new.normal))
            return Speed(_way(old.point, new.point), turned * away)


def _way(before: Sequence[float], after: Sequence[float]) -> np.ndarray:
    return np.array(after, float) - np.array(before, float)


def _turning(direction: np.ndarray, change: np.ndarray) -> float:
    """The fastest that a direction (3,) turns [rad] while it changes by (3,), over the share of the change."""
    square = float(change @ change)
    if square == 0.0:
        return 0.0
    nearest = direction + np.clip(-(direction @ change) / square, 0.0, 1.0) * change
    least = float(np.linalg.norm(nearest))
    return np.sqrt(square) / least if least > 0.0 else np.inf


def _fastest(speed: Speed, rate: np.ndarray) -> float:
    """How fast a body and cloth that goes at a rate (n, 3) come nearer, at most."""
    return float(np.linalg.norm(rate - speed.shift, axis=1).max()) + speed.rest


class BodyPath:
    """Bodies on their way from one frame to the next.

    Args:
        before, after: of numbers, in the scene's order.
        contact: of the cloth with them.
        x: (n, 3) corners where they begin [m].

    Attributes:
        depths: [m] that each may be in the cloth before this follows: of one that is deeper already, as the point of a
            needle that bears all of it, a part of what is left to its middle besides.

    Source: docs/theory/cloth.md.
    """

    def __init__(
        self, before: Sequence[Body], after: Sequence[Body], contact: Contact, x: np.ndarray | None = None
    ) -> None:
        self.before, self.after, self.contact = before, after, contact
        sizes = [min(size_of(old), size_of(new)) for old, new in zip(before, after)]
        # A half-space may get as deep as the smallest other body; sizes change by stairs of the body's own.
        least = min(sizes, default=np.inf)
        remade = map(is_remade, before, after)
        self.depths = [TUCKED * (size if own else least) for size, own in zip(sizes, remade)]
        if x is not None:
            for k, (old, size) in enumerate(zip(before, sizes)):
                self.depths[k] = self._deeper(old, size if np.isfinite(size) else least, x, self.depths[k])

    def _deeper(self, body: Body, size: float, x: np.ndarray, depth: float) -> float:
        """How deep a body of a size [m] may get that is in cloth at x (n, 3) [m] already; others as deep as before."""
        if not np.isfinite(depth):
            return depth
        there = -kernel_body(body).lowest(x, self.contact.cells, ARRIVED * depth)[0]
        return there + TUCKED * (size - there) if depth < there < size else depth

    @property
    def moves(self) -> bool:
        """Whether any body does."""
        return any(old.form != new.form for old, new in zip(self.before, self.after))

    def at(self, share: float) -> tuple[Body, ...]:
        """The bodies at a share of their way."""
        return tuple(between(old, new, share) for old, new in zip(self.before, self.after))

    def farthest(self, begin: float, x: np.ndarray, way: np.ndarray) -> float:
        """The share up to which no body gets deeper into the cloth than it may, by conservative advancement.

        Args:
            begin: the share at which the cloth is at x (n, 3) [m].
            way: (n, 3) [m] that the cloth is guessed to go from there to the end of the bodies' way.
        """
        if begin >= 1.0:
            return 1.0
        rate, share = way / (1.0 - begin), 1.0
        for k, depth in enumerate(self.depths):
            share = min(share, self._advance(k, depth, begin, share, x, rate))
        return share

    def least(self, begin: float, x: np.ndarray, way: np.ndarray) -> float:
        """The share of the way on which no body can get deeper by more than it may be in the cloth; see `farthest`."""
        rate, shares = way / (1.0 - begin), [1.0]
        for old, new, depth in zip(self.before, self.after, self.depths):
            parts = stairs(old, new)
            shares.append(1.0 / parts)
            fastest = _fastest(speed_of(old, new, x), rate) if goes_on(old, new) else 0.0
            if np.isfinite(depth) and fastest > 0.0:
                # It may come upon one change of its sizes, besides.
                shares.append((depth - _grown(old, new) / parts) / fastest)
        return min(shares)

    def _advance(self, k: int, depth: float, begin: float, end: float, x: np.ndarray, rate: np.ndarray) -> float:
        """How far body k may go from a share towards another one; the cloth goes from x (n, 3) at a rate (n, 3)."""
        old, new = self.before[k], self.after[k]
        if not np.isfinite(depth) or not goes_on(old, new):
            return end
        if is_remade(old, new):
            # Up to where it has other sizes next it goes with those that it takes on as it starts.
            parts = stairs(old, new)
            stair = (math.floor(begin * parts + NEARLY) + 1) / parts
            end, taken = min(end, stair), between(old, new, stair)
            grown = {key: getattr(taken.form, key) for key in MEASURES}
            old, new = (one.model_copy(update={"mannequin": one.form.model_copy(update=grown)}) for one in (old, new))
        cells, tolerance = self.contact.cells, 0.5 * ARRIVED * depth
        relative = _fastest(speed_of(old, new, x), rate)
        if relative == 0.0:
            return end
        share = begin
        for _ in range(LOOKS):
            now = x + (share - begin) * rate
            spare = kernel_body(between(old, new, share)).lowest(now, cells, tolerance)[0] - tolerance + depth
            if spare <= ARRIVED * depth:
                break
            share += spare / relative
            if share >= end:
                return end
        return share
