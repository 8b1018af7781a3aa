"""The pieces of a pattern from loose curves: loops, each with the loops inside it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from restshape.arrays import Reals
from restshape.scene.plain_values import table_in
from restshape.shape.drawings.closed_splines import cut_closed
from restshape.shape.drawings.gaps import joints
from restshape.shape.drawings.layer_names import name_of
from restshape.shape.drawings.loose_curve import Curve
from restshape.shape.drawings.named_points import chain_of_curve
from restshape.shape.drawings.unordered_curves import shape_data
from restshape.shape.patterns.pattern import PatternPiece


@dataclass
class Loops:
    """Curves by what they close.

    Args:
        groups: the curves of each outermost loop, with those of all loops inside it.
        around: how many of each group, the first ones, are the outermost loop.
        open: curves that close no loop.
    """

    groups: list[list[Curve]] = field(default_factory=list)
    around: list[int] = field(default_factory=list)
    open: list[Curve] = field(default_factory=list)


def loops_of(curves: Sequence[Curve]) -> Loops:
    """The loops that curves close, each outermost one with those inside it, in the order of the curves."""
    if not curves:
        return Loops()
    size = _size(curves)
    whole, _ = cut_closed(list(curves), size, 0.0)
    closed, opened = _closed(whole, size)
    borders = [np.concatenate([chain_of_curve(curve) for curve in loop]) for loop in closed]
    edges = [[chain_of_curve(curve) for curve in loop] for loop in closed]
    inside = [
        [
            k
            for k in range(len(closed))
            if k != i and _box_within(borders[i], borders[k]) and is_in(borders[i][0], edges[k])
        ]
        for i in range(len(closed))
    ]
    found = Loops(open=opened)
    for i, loop in enumerate(closed):
        # A loop in a hole is inside twice: it is a piece by itself.
        if len(inside[i]) % 2 == 0:
            own = [j for j in range(len(closed)) if i in inside[j] and len(inside[j]) == len(inside[i]) + 1]
            found.groups.append([*loop, *(curve for j in own for curve in closed[j])])
            found.around.append(len(loop))
    return found


def pieces_of(
    loops: Loops, names: Sequence[str], where: str, points: Mapping[str, Reals], grains: Sequence[tuple[Reals, float]]
) -> tuple[list[PatternPiece], int]:
    """Pieces of loops, and how many of the points are in none of them.

    Args:
        loops: of curves.
        names: for the pieces, by their places; "": one from the names of its curves, else ``piece1``, ...
        where: the file, for messages.
        points: (2,) by name [m].
        grains: a place (2,) [m] and the angle [rad] of each line of a grain.
    """
    found: list[PatternPiece] = []
    taken: set[str] = set()
    placed = 0
    for number, (group, around) in enumerate(zip(loops.groups, loops.around)):
        name = _free((names[number] if number < len(names) else "") or _name(group[:around]) or "piece", taken)
        own = [_own(one, name) for one in group]
        tables, _ = shape_data(own, where, 0.0, points)
        placed += len(points.keys() & {*table_in(tables, "vertices"), *table_in(tables, "points")})
        border = [chain_of_curve(curve) for curve in group[:around]]
        grain = next((angle for place, angle in grains if is_in(place, border)), None)
        found.append(PatternPiece(name, {key: table for key, table in tables.items() if table}, grain=grain))
    return found, len(points) - placed


def _closed(curves: list[Curve], size: float) -> tuple[list[list[Curve]], list[Curve]]:
    """Loops of curves that meet end to end, and the curves that are in none; those within one joint are in neither."""
    starts, stops = (np.array([curve.points[end] for curve in curves]) for end in (0, -1))
    ends = joints(starts, stops, size).ends
    long = [i for i, (start, stop) in enumerate(ends) if start != stop]
    at: dict[int, list[int]] = {}
    for i in long:
        for vertex in ends[i]:
            at.setdefault(vertex, []).append(i)
    loops, opened, left = [], [], dict.fromkeys(long)
    while left:
        waiting, own = [next(iter(left))], []
        while waiting:
            i = waiting.pop()
            if i in left:
                del left[i]
                own.append(i)
                waiting += [j for vertex in ends[i] for j in at[vertex]]
        whole = [curves[i] for i in sorted(own)]
        if all(len(at[vertex]) == 2 for i in own for vertex in ends[i]):
            loops.append(whole)
        else:
            opened += whole
    return loops, opened


def _size(curves: Sequence[Curve]) -> float:
    return float(np.hypot(*np.ptp(np.concatenate([curve.points for curve in curves]), axis=0)))


def _box_within(inner: Reals, outer: Reals) -> bool:
    return bool((inner.min(axis=0) >= outer.min(axis=0)).all() and (inner.max(axis=0) <= outer.max(axis=0)).all())


def is_in(place: Reals, border: Sequence[Reals]) -> bool:
    """Whether a place (2,) is inside of a closed border of chains (m, 2), by the parity of crossings."""
    a, b = (np.concatenate([chain[part] for chain in border]) for part in (slice(-1), slice(1, None)))
    crosses = (a[:, 1] > place[1]) != (b[:, 1] > place[1])
    (ax, ay), (bx, by) = a[crosses].T, b[crosses].T
    return bool(np.count_nonzero(place[0] < ax + (place[1] - ay) / (by - ay) * (bx - ax)) % 2)


def place_in(border: Sequence[Reals]) -> Reals:
    """A place (2,) inside of a closed border of chains (m, 2), away from it."""
    a, b = (np.concatenate([chain[part] for chain in border]) for part in (slice(-1), slice(1, None)))
    heights = np.unique(a[:, 1])
    gap = int(np.diff(heights).argmax())
    y = 0.5 * (heights[gap] + heights[gap + 1])
    crosses = (a[:, 1] > y) != (b[:, 1] > y)
    (ax, ay), (bx, by) = a[crosses].T, b[crosses].T
    x = np.sort(ax + (y - ay) / (by - ay) * (bx - ax))
    # Between the first two crossings, the next two, and so on, the line is inside.
    widest = 2 * int((x[1::2] - x[::2]).argmax())
    return np.array([0.5 * (x[widest] + x[widest + 1]), y])


def _name(around: list[Curve]) -> str:
    """The name that all curves around a piece have: that of their group, else of their layer; "": none."""
    for texts in ({curve.loop for curve in around}, {curve.label for curve in around}):
        if len(texts) == 1 and "" not in texts:
            return next(iter(texts))
    return ""


def _free(name: str, taken: set[str]) -> str:
    """A name for a piece that no other one has."""
    stem = name_of(name).replace(".", "_") or "piece"
    number, free = 1, "piece1" if stem == "piece" else stem
    while free in taken:
        number += 1
        free = f"{stem}{number}" if stem == "piece" else f"{stem}_{number}"
    taken.add(free)
    return free


def _own(curve: Curve, piece: str) -> Curve:
    """A curve of a piece with the names that it has within that."""
    region = curve.region and (_part(curve.region, piece) or curve.region)
    return replace(curve, label=_part(curve.label, piece), loop=_part(curve.loop, piece), region=region)


def _part(text: str, piece: str) -> str:
    """A name of a part of a piece: without the piece's own before it, and without one that is the piece's."""
    return "" if text == piece else text.removeprefix(f"{piece}.")
