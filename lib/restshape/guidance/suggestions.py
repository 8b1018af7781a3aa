"""Suggestions that make an invalid piece stable and durable again, by combinations of few design modes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from restshape.guidance.force_space import (
    LONGEST,
    ForceSpace,
    Rays,
    combinations,
    durability_space,
    stability_space,
    whole_space,
)
from restshape.guidance.ranges import bisected
from restshape.guidance.relinearised import relinearised
from restshape.physics.furniture import ALL, LOST, OVERLAPPING, UNSTABLE, Furniture
from restshape.shape.design_modes import DesignModes
from restshape.shape.planks import Piece

SHOWN = 8
TRIALS = 24
"""Combinations of several modes that are tested in full at most."""

KEPT = 2
"""Combinations kept of each number of modes and leading mode; 0 keeps all."""

INSIDE = np.array([0.03, 0.15, 0.4, 0.8])
"""Where along the predicted span a combination is tested."""

BEYOND = np.array([1.15, 1.5])
"""And beyond where it is entered, for a prediction that falls short."""

MENDED = 4
"""Combinations of several modes whose direction is mended where they are, at most, in one search."""

AFTER = np.array([1.0, 2.0, 3.0]) / 3.0
"""Where between the predicted end and the longest step the range is followed further."""

SPAN_TOLERANCE = 1e-2
"""Of the ends of a suggestion's range, in parts of the longest step."""

REPRESENTED = 0.1
"""Where in its range a suggestion is shown."""


@dataclass(frozen=True)
class Suggestion:
    """A way to make the piece valid: slide t along a direction.

    Args:
        modes: numbers of the modes it combines.
        parts: unit direction in them.
        direction: (n, 8) change of the design parameters by a unit of t.
        t: where it is shown.
        span: range of t around it where the full test holds, up to `SPAN_TOLERANCE`.
        words: what each mode does.
        valid: the full test holds; else the piece is stable, but a joint still breaks.
    """

    modes: tuple[int, ...]
    parts: tuple[float, ...]
    direction: np.ndarray
    t: float
    span: tuple[float, float]
    words: tuple[str, ...]
    valid: bool

    @property
    def gamma(self) -> np.ndarray:
        """Design parameters (n, 8) of what is shown."""
        return self.t * self.direction

    def piece(self, furniture: Furniture) -> Piece:
        """The piece that is shown."""
        return furniture.moved(self.gamma)


@dataclass(frozen=True)
class Suggestions:
    """What a search found.

    Args:
        found: at most `SHOWN`, the most different and widest first.
        tried: combinations tried of each number of modes.
        led: combinations kept that lead into the box.
        tested: combinations tested in full.
        modes: that were combined.
        mended: combinations whose direction was looked for again where the first one had led.
    """

    found: tuple[Suggestion, ...]
    tried: tuple[int, ...]
    led: int
    tested: int
    modes: DesignModes
    mended: int = 0


def suggest(
    furniture: Furniture,
    most: int = 3,
    shown: int = SHOWN,
    trials: int = TRIALS,
    kept: int = KEPT,
    mended: int = MENDED,
) -> Suggestions:
    """Suggestions for a piece that falls or has a weak joint; none for one that is valid.

    Stability comes first: where the piece is weak too and nothing makes it both stable and durable, suggestions that
    make it stable are given, and say so.

    Args:
        furniture: the model of the piece.
        most: modes that are combined at most; `forecast` tells what more of them cost.
        shown: suggestions at most.
        trials: combinations of several modes tested in full at most.
        kept: rays kept for each number of modes and leading mode, the widest; 0 keeps all.
        mended: combinations at most whose direction is looked for again where it failed.
    """
    verdict = furniture.test()
    modes = DesignModes.of(furniture.piece, furniture.kernel.freedoms())
    if verdict.valid or verdict.flaws & (LOST | OVERLAPPING) or not len(modes):
        return Suggestions((), (), 0, 0, modes)
    unstable = bool(verdict.flaws & UNSTABLE)
    space = stability_space(furniture, modes) if unstable else durability_space(furniture, modes)
    search = Search(furniture, modes, space, trials, kept, mended)
    found = search.run(most, shown, ALL)
    if unstable and len(found) < shown and most > 1:
        found = _with_joints(search, found, most, shown)
    if unstable and not found:
        found = [replace(one, valid=False) for one in search.run(most, shown, LOST | OVERLAPPING | UNSTABLE)]
    furniture.test()
    return Suggestions(tuple(found), search.tried, search.led, search.tested, modes, search.mended)


def _with_joints(search: Search, found: list[Suggestion], most: int, shown: int) -> list[Suggestion]:
    """What was found for a piece that falls, and combinations of modes that keep its joints durable besides."""
    search.furniture.test()
    space = whole_space(search.furniture, search.modes)
    again = Search(search.furniture, search.modes, space, search.trials, search.kept, search.mends - search.mended)
    known = [set(one.modes) for one in found]
    more = again.run(most, shown, ALL, [one.modes[0] for one in found if len(one.modes) == 1])
    search.led, search.tested, search.mended = (
        a + b for a, b in zip((search.led, search.tested, search.mended), (again.led, again.tested, again.mended))
    )
    search.tried = tuple(a + b for a, b in zip(search.tried, again.tried))
    return (found + [one for one in more if set(one.modes) not in known])[:shown]


class Search:
    """One search in the force space of a piece.

    Args:
        furniture, modes: the piece and what may change.
        space: its forces.
        trials, kept, mends: as `trials`, `kept` and `mended` of `suggest`.
    """

    def __init__(
        self,
        furniture: Furniture,
        modes: DesignModes,
        space: ForceSpace,
        trials: int = TRIALS,
        kept: int = KEPT,
        mends: int = MENDED,
    ) -> None:
        self.furniture, self.modes, self.space = furniture, modes, space
        self.trials, self.kept, self.mends = trials, kept, mends
        self.tried: tuple[int, ...] = ()
        self.led = self.tested = self.mended = 0

    def run(self, most: int, shown: int, wanted: int, known: Sequence[int] = ()) -> list[Suggestion]:
        """Suggestions of at most `most` modes, tested for the flaws wanted; none holds a mode of `known`."""
        if not len(self.space.h):
            return []
        single = combinations(self.space, most=1)
        alone = [self.confirmed(*ray, wanted) for ray in _each(single) if ray[0][0] not in known]
        barred = np.zeros(len(self.modes), dtype=bool)
        barred[[*known, *(one.modes[0] for one in alone if one)]] = True
        self.tried, self.led = single.tried, len(single.modes)
        found = [one for one in alone if one]
        if most > 1:
            several = combinations(self.space, most=most, least=2, barred=barred, keep=self.kept)
            self.tried, self.led = self.tried + several.tried[1:], self.led + len(several.modes)
            found = self._with(found, several, shown, wanted)
        return [found[k] for k in _different(*self._numbers(found), shown)]

    def _with(self, found: list[Suggestion], rays: Rays, shown: int, wanted: int) -> list[Suggestion]:
        """What was found and those of further rays that the full test confirms, the most different first."""
        each = list(_each(rays))
        vectors = np.zeros((len(each), len(self.modes)))
        for k, (modes, parts, _) in enumerate(each):
            vectors[k, modes] = parts
        widths = rays.spans[:, 1] - rays.spans[:, 0]
        for k in _different(vectors, widths, self.trials):
            if len(found) >= 2 * shown:
                break
            if one := self.confirmed(*each[k], wanted) or self._mended(*each[k], wanted):
                found.append(one)
        return found

    def _mended(self, modes: np.ndarray, parts: np.ndarray, span: np.ndarray, wanted: int) -> Suggestion | None:
        """The suggestion along a direction that was looked for again where the first one enters the box."""
        if self.mended >= self.mends:
            return None
        self.mended += 1
        end = relinearised(self.furniture, self.modes, modes, float(span[0]) * parts, wanted)
        if end is None:
            return None
        length = float(np.linalg.norm(end))
        return self.confirmed(modes, end / length, np.array([length, 1.5 * length]), wanted, length)

    def _numbers(self, found: list[Suggestion]) -> tuple[np.ndarray, np.ndarray]:
        vectors, widths = np.zeros((len(found), len(self.modes))), np.zeros(len(found))
        for k, one in enumerate(found):
            vectors[k, list(one.modes)], widths[k] = one.parts, one.span[1] - one.span[0]
        return vectors, widths

    def confirmed(
        self, modes: np.ndarray, parts: np.ndarray, span: np.ndarray, wanted: int, known: float = 0.0
    ) -> Suggestion | None:
        """The suggestion along a ray, or None if the full test holds nowhere that it is tried; `known` is one place."""
        self.tested += 1
        direction = self.modes.direction(modes, parts)
        enters, leaves = span
        t = np.unique(np.concatenate([[known], enters + INSIDE * (leaves - enters), enters * BEYOND]))
        t = np.concatenate([[0.0], t[(t > 0.0) & (t <= LONGEST)]])
        # The piece as it is has a flaw that is wanted away.
        first = next((k for k in range(1, len(t)) if self._good(direction, t[k : k + 1], wanted)[0]), 0)
        if not first:
            return None
        after = leaves + AFTER * (LONGEST - leaves)
        t = np.concatenate([t, after[after > t[-1]]])
        good = self._good(direction, t[first + 1 :], wanted)
        last = first + int(np.argmin(np.append(good, False)))
        left, _ = bisected(
            self.furniture, direction, t[[first - 1]], t[[first]], np.array([False]), SPAN_TOLERANCE * LONGEST, wanted
        )
        end = t[last]
        if last + 1 < len(t):
            end = bisected(
                self.furniture, direction, t[[last]], t[[last + 1]], np.array([True]), SPAN_TOLERANCE * LONGEST, wanted
            )[0][0]
        shown = self._shown(direction, float(left[0]), float(end), float(t[first]), wanted)
        numbers = tuple(int(k) for k in modes)
        words = self.modes.names(modes)
        return Suggestion(
            numbers, tuple(map(float, parts)), direction, shown, (float(left[0]), float(end)), words, True
        )

    def _shown(self, direction: np.ndarray, left: float, right: float, tested: float, wanted: int) -> float:
        t = left + REPRESENTED * (right - left)
        return t if self._good(direction, np.array([t]), wanted)[0] else tested

    def _good(self, direction: np.ndarray, t: np.ndarray, wanted: int) -> np.ndarray:
        return self.furniture.kernel.scan(direction, t, wanted)[0] == 0


def _each(rays: Rays) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Modes, parts and span of each ray."""
    for modes, parts, span in zip(rays.modes, rays.parts, rays.spans):
        used = modes >= 0
        yield modes[used], parts[used], span


def _different(vectors: np.ndarray, widths: np.ndarray, count: int) -> list[int]:
    """An order of directions (k, m): the widest first, then what is wide and far from all before."""
    if not len(vectors):
        return []
    order, far = [], np.ones(len(vectors))
    score = widths / max(widths.max(), 1e-300)
    while len(order) < min(count, len(vectors)):
        merit = far * (0.25 + score)
        merit[order] = -1.0
        order.append(int(np.argmax(merit)))
        far = np.minimum(far, 1.0 - vectors @ vectors[order[-1]])
    return order
