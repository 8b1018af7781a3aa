"""Faces of planks that lie on the floor or on each other, and stay there when planks become thicker or thinner."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from restshape_apps.furniture.shape.planks import FLUSH, Piece, Plane, Plank, parts_of

TOUCHING = 1e-4
"""How far two faces may be from each other to lie on each other [m]: less than what counts as overlap."""


@dataclass(frozen=True)
class FaceContact:
    """A face of plank `upper` on a face of plank `lower` (-1: a fixed plane), seen along `normal` (3,).

    Args:
        gap: between the two faces [m], about nought.
    """

    lower: int
    upper: int
    normal: np.ndarray
    gap: float


def face_contacts(planks: Sequence[Plank], planes: Sequence[Plane] = (Plane(),)) -> tuple[FaceContact, ...]:
    """The faces that lie on a plane or on each other; ends of planks are none.

    Args:
        planks: all planks.
        planes: fixed ones, such as the floor.
    """
    found = [one for i, plank in enumerate(planks) for plane in planes if (one := _on_plane(i, plank, plane))]
    for i in range(len(planks)):
        found += [one for j in range(i) if (one := _on_plank(planks, i, j))]
    return tuple(found)


def flat_between_parts(piece: Piece, near: float) -> tuple[int, int, float] | None:
    """The nearest two planks of different parts whose faces lie over each other, the one of the smaller part first, and
    how far they are from each other [m]; None where none are near.

    Args:
        piece: in parts.
        near: how far the faces may be from each other [m].
    """
    centres, normals, thick = (
        np.array(one) for one in zip(*((plank.centre, plank.axes[:, 2], plank.size[2]) for plank in piece.planks))
    )
    found = []
    for part in parts_of(piece)[1:]:
        for i in part:
            apart = np.abs((centres - centres[i]) @ normals[i]) - 0.5 * (thick + thick[i])
            close = (np.abs(normals @ normals[i]) > 0.5) & (np.abs(apart) <= near)
            close[list(part)] = False
            for j in np.flatnonzero(close).tolist():
                if one := _on_plank(piece.planks, i, j, near):
                    # What is less than a flush joint leaves open is rounding.
                    found.append((i, j, one.gap if one.gap > FLUSH else 0.0))
    return min(found, key=lambda one: one[2], default=None)


def kept_contacts(
    before: Sequence[Plank], after: Sequence[Plank], planes: Sequence[Plane], fixed: Collection[int] = ()
) -> tuple[Plank, ...]:
    """Planks of another thickness, moved along their normals so that faces that lay on each other still do.

    A face on the floor stays on it; what lies on the plank goes with its upper face. Of planks that lie on each other
    away from the floor the face stays where they meet, of several such faces their mean. Where a plank lies on two that
    grow by different amounts, it keeps the one that leaves no overlap.

    Args:
        before: planks before.
        after: the same planks, some of them with another thickness.
        planes: that faces may lie on.
        fixed: planks that stay where they are in `after`.
    """
    contacts = face_contacts(before, planes)
    thick = {k for k, (old, new) in enumerate(zip(before, after)) if old.size[2] != new.size[2]}
    found = list(after)
    for stack in _stacks(contacts):
        members = {one.upper for one in stack} | {one.lower for one in stack} - {-1}
        if not members & thick:
            continue
        normal = next((one.normal for one in stack if one.lower < 0), stack[0].normal)
        shifts = _Stack(before, after, stack, normal, fixed).shifts()
        for k, shift in shifts.items():
            if k not in fixed and shift != 0.0:
                found[k] = replace(found[k], centre=found[k].centre + shift * normal)
    return tuple(found)


class _Stack:
    """Planks that lie on each other along a normal, whose heights follow from the lowest one up."""

    def __init__(
        self,
        before: Sequence[Plank],
        after: Sequence[Plank],
        contacts: Sequence[FaceContact],
        normal: np.ndarray,
        fixed: Collection[int],
    ) -> None:
        # Contacts of one stack may have been found along either way.
        self.contacts = [
            one if one.normal @ normal > 0.0 else replace(one, lower=one.upper, upper=one.lower, normal=-one.normal)
            for one in contacts
        ]
        members = {one.upper for one in self.contacts} | {one.lower for one in self.contacts} - {-1}
        self.height = {k: float(before[k].centre @ normal) for k in members}
        self.half = {k: 0.5 * float(after[k].size[2]) for k in members}
        self.growth = {k: self.half[k] - 0.5 * float(before[k].size[2]) for k in members}
        self.fixed = {k: float(after[k].centre @ normal) - self.height[k] for k in members if k in fixed}

    def shifts(self) -> dict[int, float]:
        """How far each plank goes along the normal [m]."""
        shift, upwards = dict(self.fixed), sorted(self.height, key=lambda k: self.height[k])
        for k in upwards:
            below = [self._top(one.lower, shift) + self.growth[k] for one in self.contacts if one.upper == k]
            shift.setdefault(k, max(below, default=0.0))
        lying = {one.upper for one in self.contacts} | set(self.fixed)
        for k in (k for k in reversed(upwards) if k not in lying):
            above = [shift[one.upper] - self.growth[one.upper] for one in self.contacts if one.lower == k]
            shift[k] = min(above) - self.growth[k]
        if self.fixed or any(one.lower < 0 for one in self.contacts):
            return shift
        mean = float(np.mean([self._top(one.lower, shift) for one in self.contacts]))
        return {k: one - mean for k, one in shift.items()}

    def _top(self, plank: int, shift: dict[int, float]) -> float:
        """How far the upper face of a plank goes; nought of a fixed plane."""
        return shift[plank] + self.growth[plank] if plank >= 0 else 0.0


def _stacks(contacts: Sequence[FaceContact]) -> list[list[FaceContact]]:
    """Contacts by what lies on each other, fixed planes apart."""
    stacks: list[tuple[set[int], list[FaceContact]]] = []
    for one in contacts:
        planks, own = {one.lower, one.upper} - {-1}, [one]
        apart = []
        for other, theirs in stacks:
            if other & planks:
                planks, own = planks | other, theirs + own
            else:
                apart.append((other, theirs))
        stacks = [*apart, (planks, own)]
    return [own for _, own in stacks]


def _on_plane(i: int, plank: Plank, plane: Plane) -> FaceContact | None:
    """The contact of a face with a fixed plane; None without one."""
    normal, point = np.array(plane.normal), np.array(plane.point)
    slope = float(plank.axes[:, 2] @ normal)
    lean = float(0.5 * plank.size[:2] @ np.abs(plank.axes[:, :2].T @ normal))
    gap = float((plank.centre - point) @ normal) - 0.5 * float(plank.size[2])
    if abs(slope) < 0.5 or abs(gap) + lean > TOUCHING:
        return None
    return FaceContact(-1, i, normal, gap)


def _on_plank(planks: Sequence[Plank], i: int, j: int, near: float = TOUCHING) -> FaceContact | None:
    """The contact of the faces of two planks that are near, along the normal of the first one; None without one."""
    one, other = planks[i], planks[j]
    normal = one.axes[:, 2]
    way = other.centre - one.centre
    along = float(way @ normal)
    gap = abs(along) - 0.5 * float(one.size[2] + other.size[2])
    if not -TOUCHING <= gap <= near or abs(float(other.axes[:, 2] @ normal)) < 0.5:
        return None
    lean = float(0.5 * other.size[:2] @ np.abs(other.axes[:, :2].T @ normal))
    if abs(gap) + lean > near or not _meet(one, other, way):
        return None
    return FaceContact(i, j, normal, gap) if along > 0.0 else FaceContact(j, i, normal, gap)


def _meet(one: Plank, other: Plank, way: np.ndarray) -> bool:
    """Whether two rectangles in parallel planes lie over each other (separating axes)."""
    for axis in np.concatenate([one.axes[:, :2].T, other.axes[:, :2].T]):
        reach = sum(0.5 * float(plank.size[:2] @ np.abs(plank.axes[:, :2].T @ axis)) for plank in (one, other))
        if abs(float(way @ axis)) >= reach - FLUSH:
            return False
    return True
