"""Ways to rasp a bar to its tone, each confirmed by solves on the rasped bar."""

from dataclasses import dataclass

import numpy as np
from restshape_apps.metallophone.rasping.places import Place, alike
from restshape_apps.metallophone.rasping.rasped_bar import RaspedBar

from restshape.errors import ReplayProblem

REACHED = 0.5
"""Cents that a tone, and a ratio that is kept, may be off at most."""
AIMED = 0.02
"""Cents within which solves go no further."""
MOST_SOLVES = 8
HOPE = 1.5
"""Where even that many times the linear change at the largest depth does not reach the tone, no solve is spent."""
THINNEST = 1e-6
"""Depths [m] below this are none."""
MISSED = 1e3
"""Price of a cent that is missed, over that of the dearest cent of material that could be taken off."""


@dataclass(frozen=True, eq=False)
class Way:
    """Material off some places.

    Args:
        name: in words.
        places: where; depths: (m,) [m].
        linear: (modes,) cents by derivatives: of the first tone, and of the ratios of the others to it.
        solved: (modes,) the same by a solve; off: (modes,) [cents] by which they miss what is wanted.
        volume: [m^3] that comes off.
    """

    name: str
    places: list[Place]
    depths: np.ndarray
    linear: np.ndarray
    solved: np.ndarray
    off: np.ndarray

    @property
    def volume(self) -> float:
        """Material [m^3] that comes off."""
        return float(sum(place.volume * depth for place, depth in zip(self.places, self.depths)))

    def reached(self, kept: int) -> bool:
        """Whether the tone, and the first `kept` ratios, are as wanted."""
        return bool(np.abs(self.off[: 1 + kept]).max() <= REACHED)


@dataclass(frozen=True, eq=False)
class Aim:
    """What rasping is to do.

    Args:
        bar: solves.
        before: (modes,) [Hz] its frequencies in the model: of the first tone, and of modes whose ratio is looked at.
        wanted: (1 + kept,) cents: of the first tone, and of the first ratios, 0 to keep them.
    """

    bar: RaspedBar
    before: np.ndarray
    wanted: np.ndarray

    def rates(self, places: list[Place]) -> np.ndarray:
        """Cents (modes, m) a metre of depth off places: of the first tone, and of the ratios."""
        cents = np.array([place.cents for place in places]).T
        return np.vstack([cents[:1], cents[1:] - cents[:1]])

    def solved(self, places: list[Place], depths: np.ndarray) -> np.ndarray:
        """The same (modes,) cents by a solve with depths (m,) [m].

        Raises:
            ReplayProblem: the bar or its mesh does not allow as much.
        """
        cents = 1200.0 * np.log2(self.bar.frequencies(places, depths) / self.before)
        return np.concatenate([cents[:1], cents[1:] - cents[:1]])

    def way(self, name: str, places: list[Place], depths: np.ndarray, solved: np.ndarray) -> Way:
        """A way that has been solved for."""
        off = np.zeros_like(solved)
        off[: len(self.wanted)] = solved[: len(self.wanted)] - self.wanted
        return Way(name, places, depths, self.rates(places) @ depths, solved, off)


def same_depth(aim: Aim, name: str, places: list[Place]) -> Way | None:
    """The same depth off all places, to the tone; None where that is out of reach.

    The depth is found by secants from the linear one, a solve each.

    Args:
        aim: of the first tone; ratios go where they go.
        name: of the way.
        places: that move the tone the wanted way.
    """
    wanted, limit = float(aim.wanted[0]), aim.bar.most_alike(places)
    rate = float(aim.rates(places)[0].sum())
    if rate * wanted <= 0.0 or HOPE * rate * limit / wanted < 1.0:
        return None
    depth, last, best = min(wanted / rate, limit), (0.0, -wanted), None
    for _ in range(MOST_SOLVES):
        depths = np.full(len(places), depth)
        try:
            solved = aim.solved(places, depths)
        except ReplayProblem:
            return best
        best, miss = aim.way(name, places, depths, solved), float(solved[0]) - wanted
        if abs(miss) <= AIMED:
            return best
        slope = (miss - last[1]) / (depth - last[0])
        following = float(np.clip(depth - miss / slope, 0.0, limit)) if slope * rate > 0.0 else depth
        if following == depth:
            break
        depth, last = following, (depth, miss)
    return best if best is not None and best.reached(0) else None


def least_material(aim: Aim, name: str, places: list[Place]) -> Way | None:
    """The depths that take the least material to the tone, and keep ratios; or the nearest that the limits allow.

    Places that mirror each other get the same depth.

    A linear programme by the derivatives, set right by what a solve of its answer misses, until that is nothing.

    Args:
        aim: the tone, and ratios to keep.
        name: of the way.
        places: all that may be rasped.
    """
    if not places:
        return None
    programme, best, last = _Programme(aim.rates(places)[: len(aim.wanted)], places), None, np.full(len(places), np.nan)
    goal = aim.wanted.copy()
    for _ in range(MOST_SOLVES):
        depths = programme.depths(goal)
        used = np.flatnonzero(depths > THINNEST)
        if not len(used) or np.allclose(depths, last, rtol=0.0, atol=THINNEST):
            break
        last = depths
        chosen = [places[k] for k in used]
        try:
            way = aim.way(name, chosen, depths[used], aim.solved(chosen, depths[used]))
        except ReplayProblem:
            programme.limits *= 0.7
            continue
        miss = way.off[: len(goal)]
        if best is None or np.abs(miss).max() < np.abs(best.off[: len(goal)]).max():
            best = way
        if np.abs(miss).max() <= AIMED:
            break
        # The tone by chords, for the thinner a bar is the more a tenth does; ratios by what they miss.
        if way.solved[0] * way.linear[0] > 0.0:
            goal[0] = aim.wanted[0] * way.linear[0] / way.solved[0]
        goal[1:] -= miss[1:]
    return best


class _Programme:
    """The linear programme for depths: the least material, each group of places that mirror each other alike.

    Args:
        rates: (k, m) cents a metre of depth off each place.
        places: (m,) of them.

    Attributes:
        limits: (g,) [m] largest depths of the groups.
    """

    def __init__(self, rates: np.ndarray, places: list[Place]) -> None:
        groups, below = alike(places), [place for place in places if place.underneath]
        # Which group (m, g) a place is in.
        self._member = np.array([[float(any(place is one for one in group)) for group in groups] for place in places])
        self._rates = rates @ self._member
        self._volumes = np.array([place.volume for place in places]) @ self._member
        self.limits = np.array([min(place.limit for place in group) for group in groups])
        # What lies over each other underneath, where one of them is deepest, takes no more than one of them may.
        off = np.array([[other.off[np.argmax(place.off)] for other in places] for place in below])
        self._over = off.reshape(len(below), len(places)) @ self._member
        self._most = np.array([place.limit for place in below])

    def depths(self, goal: np.ndarray) -> np.ndarray:
        """Depths (m,) [m] off the places that reach a goal (k,) [cents] by the rates, or come as near as they can."""
        from scipy.optimize import linprog

        # In units of the limits and of the volume at these, so that numbers are near 1.
        scale = max(float(np.abs(goal).max()), 1.0)
        steps, costs = self._rates * self.limits / scale, self._volumes * self.limits / (self._volumes @ self.limits)
        price = MISSED * float((costs / np.maximum(np.abs(steps).max(axis=0), 1e-9)).max())
        count = len(goal)
        missing = np.zeros((len(self._over), 2 * count))
        found = linprog(
            np.concatenate([costs, np.full(2 * count, price)]),
            A_ub=np.hstack([self._over * self.limits, missing]),
            b_ub=self._most,
            A_eq=np.hstack([steps, np.eye(count), -np.eye(count)]),
            b_eq=goal / scale,
            bounds=[(0.0, 1.0)] * len(costs) + [(0.0, None)] * (2 * count),
        )
        return self._member @ (self.limits * found.x[: len(costs)])
