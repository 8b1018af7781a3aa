"""Places of a bar that a rasp may work on: stretches of its outline, and strips underneath."""

from dataclasses import dataclass

import numpy as np

NEGLIGIBLE = 0.02
"""Places are left out that do less to the first tone than this share of what the strongest of their face does."""
SHORTEST = 3.0
"""Facets that a stretch or a strip is long at least: the mesh shows no shorter one."""

ALIKE = 0.05
"""Share by which lengths and cents of places that mirror each other differ at most, on a mesh that does not."""


@dataclass(frozen=True, eq=False)
class Place:
    """Where material may come off, and in which profile.

    Args:
        where: in words, such as "edge top" or "underneath".
        underneath: it is on the lower face, else on the outline.
        ends: (2, 2) [m] where it begins and ends in the plane.
        mark: (2, 2) where the depth is largest, the middle of what is underneath [m], and the direction out of the bar.
        length: [m] of the stretch, or of the strip along the bar.
        profile: in words, how the depth goes from one end to the other.
        motion: (n, 2) displacements of the corners of the plane mesh a unit of depth; 0 of what is underneath.
        off: (n,) thickness taken off at them a unit of depth; 0 of the outline.
        volume: [m^3/m] that comes off a unit of depth.
        cents: (modes,) [cents/m] by which the tones go up a unit of depth, by derivatives.
        limit: [m] the largest depth.
    """

    where: str
    underneath: bool
    ends: np.ndarray
    mark: np.ndarray
    length: float
    profile: str
    motion: np.ndarray
    off: np.ndarray
    volume: float
    cents: np.ndarray
    limit: float

    @property
    def words(self) -> str:
        """Where it is; of what is closed without ends."""
        if self.closed:
            return self.where
        return "{}, ({}) to ({}) mm".format(self.where, *self.ends_in_millimetres)

    @property
    def closed(self) -> bool:
        """Whether it ends where it begins."""
        return bool((self.ends[0] == self.ends[1]).all())

    @property
    def ends_in_millimetres(self) -> list[str]:
        """Both ends, for people; none of what is closed."""
        if self.closed:
            return ["", ""]
        return [f"{x:.0f}, {y:.0f}" for x, y in np.round(1e3 * self.ends) + 0.0]


def stretches(s: np.ndarray, values: np.ndarray) -> list[tuple[float, float]]:
    """Where values (m,) at ascending places s (m,) are of one sign: begin and end, zeros found linearly between."""
    smooth = values.astype(float)
    for _ in range(2):
        padded = np.concatenate([smooth[:1], smooth, smooth[-1:]])
        smooth = 0.25 * padded[:-2] + 0.5 * padded[1:-1] + 0.25 * padded[2:]
    turns = np.flatnonzero(np.sign(smooth[:-1]) * np.sign(smooth[1:]) < 0.0)
    share = smooth[turns] / (smooth[turns] - smooth[turns + 1])
    bounds = np.concatenate([s[:1], s[turns] + share * (s[turns + 1] - s[turns]), s[-1:]])
    return list(zip(bounds[:-1].tolist(), bounds[1:].tolist()))


def profile(s: np.ndarray, begin: float, end: float, over: tuple[bool, bool]) -> np.ndarray:
    """Depths (m,) at places s (m,), 1 at most: level where the rasp goes over the end, else running out to nothing.

    Args:
        s: along the outline or the bar [m].
        begin, end: of the stretch [m].
        over: whether the rasp goes over either end.
    """
    t = np.clip((s - begin) / (end - begin), 0.0, 1.0)
    inside = (s >= begin - 1e-9 * (end - begin)) & (s <= end + 1e-9 * (end - begin))
    depth = {
        (True, True): np.ones_like(t),
        (True, False): np.cos(0.5 * np.pi * t) ** 2,
        (False, True): np.sin(0.5 * np.pi * t) ** 2,
        (False, False): np.sin(np.pi * t) ** 2,
    }[over]
    return np.where(inside, depth, 0.0)


def profile_words(over: tuple[bool, bool]) -> str:
    """How a profile goes, in words."""
    return {
        (True, True): "even",
        (True, False): "most at its start",
        (False, True): "most at its end",
        (False, False): "most midway",
    }[over]


def worth_it(places: list[Place]) -> list[Place]:
    """The places that do something beside others of their face."""
    kept = []
    for underneath in (False, True):
        own = [place for place in places if place.underneath == underneath]
        most = max((abs(float(place.cents[0])) for place in own), default=0.0)
        kept += [place for place in own if abs(float(place.cents[0])) >= NEGLIGIBLE * most and place.limit > 0.0]
    return kept


def strongest_first(places: list[Place]) -> list[Place]:
    """The places, those first that move the first tone the most."""
    return sorted(places, key=lambda place: -abs(float(place.cents[0])))


def alike(places: list[Place]) -> list[list[Place]]:
    """Groups of places that do the same over the same length, as those do that mirror each other."""
    groups: list[list[Place]] = []
    for place in places:
        for group in groups:
            first = group[0]
            same = (
                first.underneath == place.underneath
                and abs(first.length - place.length) <= ALIKE * first.length
                and np.abs(first.cents - place.cents).max() <= ALIKE * np.abs(first.cents).max()
            )
            if same:
                group.append(place)
                break
        else:
            groups.append([place])
    return groups
