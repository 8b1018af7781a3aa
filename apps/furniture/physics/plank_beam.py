"""A plank as a beam along one of its sides: what acts on it, its moments and deflection, and a floor under it."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import sqrt

import numpy as np

NODES = 81
"""Places at which a floor pushes a plank that lies on it."""


@dataclass(frozen=True)
class Line:
    """Where a plank's beam runs.

    Args:
        centre, along, normal: (3,) its middle [m], its direction, and the way in which it bends.
        length: [m].
    """

    centre: np.ndarray
    along: np.ndarray
    normal: np.ndarray
    length: float


@dataclass(frozen=True)
class Action:
    """What acts on a plank at a joint, a foot or a load.

    Args:
        at: (3,) its middle [m].
        span: length along the beam over which it is spread [m].
        force, couple: (3,) [N], [N m].
        holds: whether it supports the plank.
        straight: length along the beam over which it holds the plank straight, if it supports it [m].
    """

    at: np.ndarray
    span: float
    force: np.ndarray
    couple: np.ndarray
    holds: bool = False
    straight: float = 0.0


@dataclass(frozen=True)
class Actions:
    """What acts on a beam.

    Args:
        place: (k,) middles from the beam's own [m].
        span: (k,) lengths along the beam over which each is spread, with a density that runs straight [m].
        force: (k,) along the normal [N].
        couple: (k,) about along x normal [N m].
        holds: (k,) whether it supports the beam, as a joint with a leg does, or loads it.
        own: a force spread evenly over the length [N/m].
        length: of the beam [m].
        straight: (k,) lengths over which supports that run along the beam hold it straight [m]; none where empty.
    """

    place: np.ndarray
    span: np.ndarray
    force: np.ndarray
    couple: np.ndarray
    holds: np.ndarray
    own: float
    length: float
    straight: np.ndarray = field(default_factory=lambda: np.zeros(0))

    @classmethod
    def on(cls, line: Line, rows: Sequence[Action], own: float) -> "Actions":
        """Actions on a line, with a force of its own that is spread evenly [N/m]."""
        if not rows:
            return cls(*(np.zeros(0) for _ in range(4)), np.zeros(0, dtype=bool), own, line.length)
        at, force, couple = (np.array([getattr(row, name) for row in rows]) for name in ("at", "force", "couple"))
        holds = np.array([row.holds for row in rows])
        half, arms = line.length / 2, at - line.centre
        place = np.minimum(np.maximum(arms @ line.along, -half), half)
        # What is spread stays on the beam.
        most = 2 * (half - np.abs(place))
        span = np.minimum([row.span for row in rows], most)
        axis = cross(line.along, line.normal)
        # With moments of forces along the beam whose line misses its middle.
        m = couple @ axis + cross(arms - place[:, None] * line.along, force) @ axis
        straight = np.minimum([row.straight for row in rows], most)
        straight = np.where(holds if holds.any() else True, straight, 0.0)
        return cls(place, span, force @ line.normal, m, holds, own, line.length, straight)

    def stations(self, count: int) -> np.ndarray:
        """Places (s,) along the beam between which moments run smoothly [m]."""
        half = self.length / 2
        # The moment may jump at a place: there are stations on both sides of it.
        beside = 1e-9 * self.length
        ends = (self.place + sign * (self.span / 2 + beside) for sign in (-1.0, 1.0))
        straight = (one + sign * beside for one in self._straight_ends() for sign in (-1.0, 1.0))
        s = np.concatenate([np.linspace(-half, half, count), *ends, *straight])
        return np.unique(np.minimum(np.maximum(s, -half - beside), half + beside))

    def moments(self, s: np.ndarray) -> np.ndarray:
        """Bending moments (s,) at places, of all that acts before them [N m]."""
        point = self.span <= 1e-6 * self.length
        x = s[:, None] - self.place
        found = np.where(x > 0.0, self.force * x - self.couple, 0.0)
        span = np.where(point, 1.0, self.span)
        # Of a density force / span + slope t, from the start of the span up to t or its end.
        slope, t = 12.0 * self.couple / span**3, np.minimum(np.maximum(x, -span / 2), span / 2)
        square, cube = (t**2 - span**2 / 4) / 2, (t**3 + span**3 / 8) / 3
        spread = self.force / span * (x * (t + span / 2) - square) + slope * (x * square - cube)
        own = 0.5 * self.own * np.minimum(np.maximum(s + self.length / 2, 0.0), self.length) ** 2
        return np.where(point, found, spread).sum(axis=1) + own

    def straightened(self, s: np.ndarray) -> np.ndarray:
        """Whether supports that run along the beam hold it straight at places (s,) [m]."""
        first, last = self._straight_ends()
        return ((s[:, None] > first) & (s[:, None] < last)).any(axis=1)

    def _straight_ends(self) -> tuple[np.ndarray, np.ndarray]:
        """From where (m,) to where (m,) supports that run along the beam hold it straight [m]."""
        runs = self.straight > 0.0
        place, half = self.place[: len(runs)][runs], self.straight[runs] / 2
        return place - half, place + half

    def borne_across(self) -> "Actions | None":
        """The actions where supports that run along the beam bear nothing, and the others what these did; None without.

        A support along a part of the beam leaves that part of what it bears. Forces of supports balance the beam, and
        couples where all supports are at one place.
        """
        if not len(self.straight) or not self.straight.any():
            return self
        holds = self.holds if self.holds.any() else np.ones(len(self.holds), dtype=bool)
        part = self.straight / self.length
        bears = np.where(holds, 1.0 - part, 0.0)
        if bears.max() < 1e-9:
            return None
        force, couple = (1.0 - part) * self.force, (1.0 - part) * self.couple
        left = np.array([part @ self.force, part @ (self.force * self.place + self.couple)])
        # The least sum of squares, in which a couple counts a thousand times as much.
        turn = (1e-3 * self.length) ** 2
        square = bears @ (self.place**2 + turn)
        even, slope = np.linalg.solve([[bears.sum(), bears @ self.place], [bears @ self.place, square]], left)
        return replace(self, force=force + bears * (even + slope * self.place), couple=couple + bears * turn * slope)

    def constrained(self, across: bool = False) -> np.ndarray:
        """Places (h,) that support the beam [m]; where nothing does, as without feet, all that acts on it.

        `across`: without those that run along the beam, if there are others.
        """
        holds = self.holds if self.holds.any() else np.ones(len(self.holds), dtype=bool)
        if across and (holds & (self.straight == 0.0)).any():
            holds = holds & (self.straight == 0.0)
        place, span = self.place[holds], self.span[holds]
        return np.concatenate([place - span / 2, place + span / 2])

    def presses(self, up: float) -> bool:
        """Whether the beam presses all along on a floor under it, so that nothing bends it; `up` as of `on_floor`."""
        size = np.abs(self.force) + np.abs(self.couple) / self.length
        acts = size > 1e-9 * (size.sum() + abs(self.own) * self.length)
        place, span, force, couple = (one[acts] for one in (self.place, self.span, self.force, self.couple))
        if (span <= 1e-6 * self.length).any():
            return False
        half = self.length / 2
        ends = np.unique(np.concatenate([[-half, half], place - span / 2, place + span / 2]))
        # Densities run straight between ends.
        t = np.concatenate([0.999 * ends[:-1] + 0.001 * ends[1:], 0.001 * ends[:-1] + 0.999 * ends[1:]])
        t = t[:, None] - place
        density = np.where(np.abs(t) < span / 2, force / span + 12.0 * couple / span**3 * t, 0.0)
        return bool((up * (density.sum(axis=1) + self.own) <= 0.0).all())

    def on_floor(self, up: float) -> "Actions | None":
        """The actions with those of a rigid floor on which the beam lies, which holds it alone; None if none does.

        The floor pushes where the beam would go through it, and nowhere pulls: of all ways to balance what acts, that
        which leaves the least energy of bending.

        Args:
            up: 1 if the floor pushes along the normal, -1 if against it.
        """
        # Few planks lie on a floor, and SciPy's optimisers take 0.1 s to load, before the first frame of all others.
        from scipy.optimize import nnls

        half = self.length / 2
        scale = np.abs(self.force).sum() + abs(self.own) * self.length
        scale += np.abs(self.couple).sum() / self.length
        if scale == 0.0:
            return None
        ends = np.concatenate([self.place - self.span / 2, self.place + self.span / 2])
        nodes = np.unique(np.concatenate([np.linspace(-half, half, NODES), np.round(ends / half, 9) * half]))
        # Two points of Gauss between nodes: moments are quadratic there, and straight by one push.
        step, middle = np.diff(nodes), 0.5 * (nodes[1:] + nodes[:-1])
        s = np.concatenate([middle - step / sqrt(12.0), middle + step / sqrt(12.0)])
        weight = np.sqrt(np.tile(step, 2) / (2.0 * self.length))
        there = self.moments(s) / (scale * self.length)
        by_one = up * np.maximum(s[:, None] - nodes, 0.0) / self.length
        # What is left behind the far end, of force and moment, weighs as much as makes it nothing.
        stiff = 1e4
        force = (self.force.sum() + self.own * self.length) / scale
        behind = self.moments(np.array([half * (1 + 1e-9)])) / (scale * self.length)
        rows = np.vstack([weight[:, None] * by_one, np.full(len(nodes), stiff * up), stiff * up * (half - nodes)])
        rows[-1] /= self.length
        push, _ = nnls(rows, -np.concatenate([weight * there, [stiff * force], stiff * behind]))
        if abs(up * push.sum() + force) > 1e-5 or abs(rows[-1] @ push / stiff + behind[0]) > 1e-5:
            return None
        on, none = push > 1e-9, np.zeros(np.count_nonzero(push > 1e-9))
        return replace(
            self,
            place=np.concatenate([self.place, nodes[on]]),
            span=np.concatenate([self.span, none]),
            force=np.concatenate([self.force, up * scale * push[on]]),
            couple=np.concatenate([self.couple, none]),
            holds=np.concatenate([np.zeros(len(self.holds), dtype=bool), np.ones(len(none), dtype=bool)]),
            straight=np.zeros(0),
        )


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Cross products (..., 3) of vectors: of a few, NumPy's own takes several times as long, and `np.clip` too."""
    found = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for k, (i, j) in enumerate(((1, 2), (2, 0), (0, 1))):
        found[..., k] = a[..., i] * b[..., j] - a[..., j] * b[..., i]
    return found


def deflection(s: np.ndarray, curvature: np.ndarray, constrained: np.ndarray) -> np.ndarray:
    """The integral of a curvature twice, 0 at the outermost constraints; at a single one its slope is 0 too."""
    step = np.diff(s)
    slope = np.concatenate([[0.0], np.cumsum(0.5 * step * (curvature[1:] + curvature[:-1]))])
    # The curvature runs straight between stations.
    rise = slope[:-1] * step + step**2 * (curvature[:-1] / 3.0 + curvature[1:] / 6.0)
    w = np.concatenate([[0.0], np.cumsum(rise)])
    if not len(constrained):
        return w - np.interp(0.0, s, w)
    first, last = constrained.min(), constrained.max()
    w_first, w_last = np.interp([first, last], s, w)
    if last - first > 1e-9:
        return w - w_first - (w_last - w_first) / (last - first) * (s - first)
    return w - w_first - np.interp(first, s, slope) * (s - first)
