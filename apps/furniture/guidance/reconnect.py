"""Suggestions that bring lost joints and feet back (figure 6.7a of the thesis)."""

from dataclasses import dataclass
from itertools import combinations as choose

import numpy as np
from restshape_apps.furniture.guidance.opening import Opening
from restshape_apps.furniture.physics.furniture import ALL, LOST, Furniture
from restshape_apps.furniture.physics.plank_findings import BEHIND, LENGTH, SLANT
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_apps.furniture.shape.planks import Joint

from restshape.guidance.force_space import LONGEST

SAMPLES = 41
INSIDE = 0.1
"""Where in its range a suggestion is shown."""

NARROW = 1e-3
"""Width of a range that is no more than what tolerances leave."""

PLACES = np.array([0.0, 0.001, 0.01, 0.03, INSIDE, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.97, 0.99, 0.999, 1.0])
"""Where in the range in which all is closed the full test is made."""

STEPS = 12
"""Least squares steps towards closed joints, at most."""

DIFFERENCE = 1e-6
CLOSED = 1e-8
"""Openings [m] that count as closed: a foot or a flush end has no range, and must be met."""

PROMISING = 0.5
"""What is left of the openings by their derivatives where a pair of modes is tried, at most."""

PAIRS = 200
"""Pairs of modes that are tried, at most, those that leave least first."""


@dataclass(frozen=True)
class Reconnection:
    """A mode, or two, that close all joints and feet again.

    Args:
        mode: what it does, in words.
        direction: (n, 8) change of the design parameters by a unit of t.
        t: where it is shown.
        span: range of t around it where the full test finds no flaw that is not among `flaws`.
        flaws: what it still finds where the way is shown.
    """

    mode: str
    direction: np.ndarray
    t: float
    span: tuple[float, float]
    flaws: int


@dataclass(frozen=True)
class Reconnections:
    """What was found, how many modes and pairs were tried and places tested in full, and why none was found."""

    found: tuple[Reconnection, ...]
    tried: int
    tested: int
    why: str


def reconnect(furniture: Furniture, shown: int = 8) -> Reconnections:
    """Ways to bring lost joints and feet back by a move, turn or length of one of their planks, the shortest first.

    Where no single one does, two at once are looked for. A way may leave other flaws, which its `flaws` report; those
    with none come before the others.
    """
    piece, lost = furniture.piece, _lost(furniture)
    modes = DesignModes.of(piece, [(plank, freedom) for plank in sorted(lost) for freedom in range(8)])
    search = _Closing(furniture, modes)
    found = search.single() or search.pairs()
    furniture.test()
    order = sorted(found, key=lambda one: (one.flaws != 0, one.t))
    names = ", ".join(piece.planks[plank].name for plank in sorted(lost))
    why = f"no move, turn or length of {names}, alone or two at once, closes all joints and feet within reach"
    return Reconnections(tuple(order[:shown]), search.tried, search.tested, "" if found else why)


def _lost(furniture: Furniture) -> set[int]:
    """Planks of lost joints and feet, and those whose ends cannot be closed."""
    geometry, piece = furniture.geometry(), furniture.piece
    lost = {plank for k, fault in enumerate(geometry.joint_faults) if fault for plank in _joined(piece.joints[k])}
    lost |= {piece.feet[k].plank for k, fault in enumerate(geometry.foot_faults) if fault}
    faults = furniture.test().found.faults
    lost |= {where for fault, where in faults if fault == LENGTH}
    ends = {divmod(where, 4) for fault, where in faults if fault in (SLANT, BEHIND)}
    lost |= {plank for joint in piece.joints if (joint.i, joint.side) in ends for plank in _joined(joint)}
    return lost | {foot.plank for foot in piece.feet if (foot.plank, foot.side) in ends}


def _joined(joint: Joint) -> tuple[int, int]:
    return joint.i, joint.j


class _Closing:
    """A search for changes that close all joints and feet of a piece."""

    def __init__(self, furniture: Furniture, modes: DesignModes) -> None:
        self.furniture, self.modes, self.opening = furniture, modes, Opening(furniture)
        self.tried = self.tested = 0

    def single(self) -> list[Reconnection]:
        """Ways of one mode: found by samples both ways, or, where only one place will do, by least squares."""
        found = []
        for number in range(len(self.modes)):
            some = np.array([number])
            self.tried += 1
            here = [one for sign in (1.0, -1.0) if (one := self._along(some, np.array([sign])))]
            if not here and (y := self._closed(some)) is not None:
                here = [one for one in [self._along(some, np.sign(y), abs(float(y[0])))] if one]
            found += here
        return found

    def pairs(self) -> list[Reconnection]:
        """Ways of two modes, for those pairs that close most by derivatives."""
        r, J = self._derivative(np.arange(len(self.modes)), np.zeros(len(self.modes)))
        left = []
        for some in choose(range(len(self.modes)), 2):
            y, *_ = np.linalg.lstsq(J[:, some], -r, rcond=1e-9)
            rest = float(np.linalg.norm(r + J[:, some] @ y) / max(float(np.linalg.norm(r)), 1e-300))
            if rest < PROMISING and np.linalg.norm(y) < 2.0 * LONGEST:
                left.append((rest, some))
        found = []
        for _, some in sorted(left)[:PAIRS]:
            self.tried += 1
            if (y := self._closed(np.array(some))) is not None and np.abs(y).min() > CLOSED:
                length = float(np.linalg.norm(y))
                if one := self._along(np.array(some), y / length, length):
                    found.append(one)
        return found

    def _closed(self, some: np.ndarray) -> np.ndarray | None:
        """The change (k,) of a few modes at which nothing is open, by Gauss and Newton from no change."""
        y, before = np.zeros(len(some)), np.inf
        for _ in range(STEPS):
            r, J = self._derivative(some, y)
            size = float(np.linalg.norm(r))
            if size <= CLOSED:
                return y if y.any() else None
            if not size < before:
                return None
            y, before = y + np.linalg.lstsq(J, -r, rcond=1e-9)[0], size
            if not np.linalg.norm(y) <= LONGEST:
                return None
        return None

    def _derivative(self, some: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Openings (r,) at a change of a few modes, and their derivatives (r, k) by differences."""
        base = self.modes.direction(some, y)
        r = self.opening.at(base)
        steps = (self.modes.direction(np.array([k]), np.array([DIFFERENCE])) for k in some)
        return r, np.stack([(self.opening.at(base + step) - r) / DIFFERENCE for step in steps], axis=1)

    def _along(self, some: np.ndarray, parts: np.ndarray, known: float | None = None) -> Reconnection | None:
        """The way along a direction from the nearest place that closes all, or from a known one, to where they open."""
        direction = self.modes.direction(some, parts)
        t = np.linspace(0.0, LONGEST, SAMPLES)
        t = t if known is None else np.unique(np.append(t, known))
        good = self.furniture.kernel.scan(direction, t, LOST)[0] == 0
        self.tested += len(t)
        if good[0] or not good.any():
            return None
        first = int(np.argmax(good)) if known is None else int(np.searchsorted(t, known))
        if not good[first]:
            return None
        last = first + int(np.argmin(np.append(good[first:], False))) - 1
        left, right = self._end(direction, t, first, first - 1), t[last]
        if last + 1 < len(t):
            right = self._end(direction, t, last, last + 1)
        names = " + ".join(self.modes.names(some))
        return Reconnection(names, direction, *self._tested(direction, float(t[first]), float(left), float(right)))

    def _tested(
        self, direction: np.ndarray, met: float, left: float, right: float
    ) -> tuple[float, tuple[float, float], int]:
        """Where to show a way that is closed from `left` to `right`, its range by the full test, and its flaws."""
        if right - left < NARROW:
            # What must be met has no range to be inside of.
            return met, (left, right), self._flaws(direction, met)
        t = left + PLACES * (right - left)
        flaws = np.array([self._flaws(direction, place) for place in t])
        # The fewest flaws, and of those places the one that is nearest to the usual one.
        count = [bin(one).count("1") for one in flaws]
        best = min(range(len(t)), key=lambda k: (count[k], abs(PLACES[k] - INSIDE)))
        bearable = ALL & ~int(flaws[best])
        good = (flaws & bearable) == 0
        first = best - int(np.argmin(np.append(good[best::-1], False))) + 1
        last = best + int(np.argmin(np.append(good[best:], False))) - 1
        if first > 0:
            left = self._end(direction, t, first, first - 1, bearable)
        if last + 1 < len(t):
            right = self._end(direction, t, last, last + 1, bearable)
        inside = left + INSIDE * (right - left)
        # Between places something narrow may hide.
        shown = next(place for place in (inside, t[best]) if not self._flaws(direction, place) & bearable)
        return float(shown), (left, right), self._flaws(direction, shown)

    def _flaws(self, direction: np.ndarray, t: float) -> int:
        """All flaws at a place of a way."""
        self.tested += 1
        return self.furniture.test(t * direction).flaws

    def _end(self, direction: np.ndarray, t: np.ndarray, good: int, bad: int, wanted: int = LOST) -> float:
        """The last place between two samples that has none of the flaws wanted; where all are closed."""
        end, _, tests = self.furniture.kernel.bisect(direction, t[good], t[bad], 1e-6, wanted)
        self.tested += tests
        return float(end)
