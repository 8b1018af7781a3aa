"""A search for combinations of few freedoms that make a design valid: rays in force space, then the full test."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations as choose

import numpy as np

from restshape.guidance.force_space import LONGEST, combinations
from restshape.guidance.searchable_design import SearchableDesign
from restshape.guidance.valid_interval_search import may_alone, nearest_valid, places_within, stretch

INSIDE = np.array([0.03, 0.15, 0.4, 0.8])
"""Where along the predicted span a combination is tested."""

BEYOND = np.array([1.15, 1.5])
"""And beyond where it is entered, for a prediction that falls short."""

AFTER = np.array([1.0, 2.0, 3.0]) / 3.0
"""Where between the predicted end and the longest step the range is followed further."""

ONWARD = np.array([0.15, 0.4])
"""Where along the span of a single mode that fails another mode is looked for."""

NEXT = 2
"""Such modes that are tested at each of those places."""

COARSE = 5e-3
"""How well ends are known by which suggestions are compared."""

FINE = 1e-6
"""How well ends of those are known that are shown."""

REPRESENTED = 0.1
"""Where in its range a suggestion is shown."""

WITHOUT = (0.0, 0.5, 1.0)
"""Where in the range of a combination it is tested with modes left out."""


@dataclass(frozen=True)
class Combination:
    """A way to make a design valid: slide t along a direction.

    Args:
        modes: numbers of the modes it combines.
        parts: unit direction in them.
        direction: change of the design parameters by a unit of t.
        t: where it is shown.
        span: range of t around it where the full test holds; one that ends at `LONGEST` may go on.
        outside: invalid parameters next to both ends; the end itself where it may go on.
        words: what each mode does.
        valid: the full test holds; else it does for some flaws only.
    """

    modes: tuple[int, ...]
    parts: tuple[float, ...]
    direction: np.ndarray
    t: float
    span: tuple[float, float]
    outside: tuple[float, float]
    words: tuple[str, ...]
    valid: bool

    @property
    def gamma(self) -> np.ndarray:
        """Change of the design parameters to what is shown."""
        return self.t * self.direction

    @property
    def beyond(self) -> bool:
        """Whether its range may go on past the longest step."""
        return self.span[1] >= LONGEST


@dataclass(frozen=True)
class Limits:
    """How much a search may do.

    Args:
        trials: combinations of several modes tested in full at most.
        kept: rays kept for each number of modes and leading mode, the widest; 0 keeps all.
        glances: places at one of which a combination of several modes must hold to be looked at closely; 0: all are.
        mended: combinations that fail whose direction is looked for again in vain, at most; one less where single
            modes hold.
        continued: single modes that fail from which another mode is looked for, at most.
    """

    trials: int = 16
    kept: int = 4
    glances: int = 2
    mended: int = 1
    continued: int = 4


class Search:
    """One search in the force space of a design.

    Args:
        searched: the design and what may change.
        wanted: flaws that count.
        limits: how much it may do.
        alone: numbers of freedoms whose whole way has been looked along before, for the same flaws.

    Attributes:
        tried: combinations tried of each number of freedoms.
        led: combinations taken up that lead into the box.
        tested, mended: tested in full; directions that were looked for again, and of them `vain` for nothing.
        simple: single freedoms hold.
    """

    def __init__(
        self, searched: SearchableDesign, wanted: int, limits: Limits, alone: frozenset[int] = frozenset()
    ) -> None:
        self.searched, self.test, self.modes = searched, searched.test, searched.modes
        self.wanted, self.limits = wanted, limits
        self.space = searched.space()
        self.tried: tuple[int, ...] = ()
        self.led = self.tested = self.mended = self.vain = 0
        self.alone, self.simple = alone, False
        self._seen: dict[tuple[int, ...], Combination | None] = {}

    def run(self, most: int, shown: int, known: Sequence[tuple[int, ...]] = ()) -> list[Combination]:
        """Suggestions of at most `most` modes, the most different first; none holds a combination of `known`.

        One number of modes comes after the other: what the full test confirms bars what holds it from then on.
        """
        if not len(self.space.h):
            return []
        found: dict[tuple[int, ...], Combination] = {}
        for count in range(1, most + 1):
            rays = combinations(self.space, count, count, [*known, *found], self.limits.kept if count > 1 else 0)
            self.tried, self.led = (*self.tried, rays.tried[-1]), self.led + len(rays.modes)
            for one in self._of(list(rays.each()), count, most, shown):
                found[one.modes] = one
            if count == 1:
                found |= self._interval_search(known, found)
                self.simple = any(len(modes) == 1 for modes in (*known, *found))
        if most > 1 and len(found) < shown:
            self._continue(found, known)
        least = [one for one in found.values() if not any(set(modes) < set(one.modes) for modes in found)]
        order = most_different(*self._numbers(least), shown)
        places = places_within(self.searched.parts, len(order))
        return [self._finer(least[k], places) for k in order]

    def _of(self, rays: list, count: int, most: int, shown: int) -> list[Combination]:
        """Those of the rays of one number of modes that hold: all single ones are tested, some of the others."""
        if count == 1:
            # Few enough to be shown all are looked at as closely at once.
            tolerance = FINE if len(rays) <= shown else COARSE
            return [one for ray in rays if (one := self._tested(*ray, tolerance))]
        found: list[Combination] = []
        vectors, widths = np.zeros((len(rays), len(self.modes))), np.zeros(len(rays))
        for k, (modes, parts, span) in enumerate(rays):
            vectors[k, modes], widths[k] = parts, span[1] - span[0]
        several = sum(len(modes) > 1 for modes in self._seen)
        room = max(self.limits.trials - several, 0) // (most - count + 1)
        for k in most_different(vectors, widths, room):
            one = self._tested(*rays[k]) or self._mended(*rays[k])
            found += self._least(one) if one else []
            if len(found) >= shown:
                break
        return found

    def _interval_search(
        self, known: Sequence[tuple[int, ...]], found: dict[tuple[int, ...], Combination]
    ) -> dict[tuple[int, ...], Combination]:
        """Single modes that hold away from where derivatives lead, both ways."""
        more: dict[tuple[int, ...], Combination] = {}
        able = may_alone(self.space)
        left = [k for k in able if k not in self.alone and (k,) not in found and (k,) not in known]
        self.alone |= able.keys()
        still = self.modes.direction(np.zeros(0, dtype=int), np.zeros(0))
        flaws = int(self.test.scan(still, np.zeros(1), self.wanted)[0][0])
        for k in left:
            mode = np.array([k])
            direction = self.modes.direction(mode, np.ones(1))
            pair = nearest_valid(self.test, direction, able[k], flaws, self.wanted)
            if pair:
                bad, good = map(abs, pair)
                one = self.confirmed(mode, np.sign(pair[1:]), np.array([good, good]), (bad, good))
                more |= {(k,): one} if one else {}
        return more

    def _tested(
        self, modes: np.ndarray, parts: np.ndarray, span: np.ndarray, tolerance: float = COARSE
    ) -> Combination | None:
        """The suggestion along a ray, or None, kept for when it is asked for again."""
        key = tuple(int(k) for k in modes)
        if key not in self._seen:
            self._seen[key] = self.confirmed(modes, parts, span, tolerance=tolerance)
        return self._seen[key]

    def _least(self, one: Combination) -> list[Combination]:
        """The smaller combinations within one that hold too, which are simpler; without any, itself."""
        for count in range(1, len(one.modes)):
            pairs = [(self._without(one, modes), modes) for modes in choose(one.modes, count)]
            smaller = [less or (self._alone(modes) if count > 1 else None) for less, modes in pairs]
            if any(smaller):
                return [each for each in smaller if each]
        return [one]

    def _without(self, one: Combination, modes: tuple[int, ...]) -> Combination | None:
        """The suggestion along the same direction, with all but some of its modes left out, if it holds."""
        parts = np.array([one.parts[one.modes.index(k)] for k in modes])
        length = float(np.linalg.norm(parts))
        places = length * (one.span[0] + np.array(WITHOUT) * (one.span[1] - one.span[0]))
        good = self._good(self.modes.direction(np.array(modes), parts / length), places)
        if not good.any():
            return None
        t = float(places[np.argmax(good)])
        return self.confirmed(np.array(modes), parts / length, np.array([t, t]), (t,))

    def _alone(self, modes: tuple[int, ...]) -> Combination | None:
        """The suggestion along the ray of a combination, if it leads into the box and holds."""
        if modes in self._seen:
            return self._seen[modes]
        K, space = np.ascontiguousarray(self.space.K[list(modes)]), self.space
        ray = next(combinations(replace(space, K=K), len(modes), len(modes)).each(), None)
        return None if ray is None else self._tested(np.array(modes)[ray[0]], *ray[1:])

    def _mended(self, modes: np.ndarray, parts: np.ndarray, span: np.ndarray) -> Combination | None:
        """The suggestion along a direction that was looked for again where the first one enters the box."""
        if self.vain >= self.limits.mended - self.simple:
            return None
        self.mended += 1
        end = self.searched.relinearised(modes, float(span[0]) * parts, self.wanted)
        one = None if end is None else self._to(modes, end)
        self.vain += one is None
        return one

    def _to(self, modes: np.ndarray, end: np.ndarray) -> Combination | None:
        """The suggestion along the line to a change (k,) of modes, which may be valid."""
        length = float(np.linalg.norm(end))
        return self.confirmed(modes, end / length, np.array([length, 1.5 * length]), (length,), FINE)

    def _continue(self, found: dict[tuple[int, ...], Combination], known: Sequence[tuple[int, ...]]) -> None:
        """Add what one more mode makes valid, by the forces at places that a single mode that fails has led to."""
        single = combinations(self.space, 1, 1, [*known, *found])
        failed = sorted(single.each(), key=lambda ray: ray[2][0] - ray[2][1])[: self.limits.continued]
        for modes, parts, span in failed:
            for t in span[0] + ONWARD * (span[1] - span[0]):
                ways = self._onward(modes, t * parts, [*known, *found])
                here = [one for both, end in ways if (one := self._to(both, end))]
                found |= {less.modes: less for one in here for less in self._least(one)}
                if here:
                    break

    def _onward(self, modes: np.ndarray, start: np.ndarray, barred: Sequence[tuple[int, ...]]) -> list:
        """A mode and one more, with how far (2,) to go in both, by derivatives where the first has gone."""
        space = self.searched.space_after(self.modes.direction(modes, start))
        if space is None or not np.isfinite(space.K).all():
            return []
        # What works with the first mode, or alone, has been found.
        rest = [set(one) - {int(modes[0])} for one in barred]
        done = {(k,) for one in rest if len(one) == 1 for k in one} | {(int(modes[0]),)}
        rays = combinations(space, 1, 1, list(done))
        widest = sorted(rays.each(), key=lambda ray: ray[2][0] - ray[2][1])[:NEXT]
        ways = []
        for more, parts, span in widest:
            both = np.array([modes[0], more[0]])
            far = parts[0] * (span[0] + INSIDE[1] * (span[1] - span[0]))
            order = np.argsort(both)
            ways.append((both[order], np.array([start[0], far])[order]))
        return ways

    def _numbers(self, found: list[Combination]) -> tuple[np.ndarray, np.ndarray]:
        vectors, widths = np.zeros((len(found), len(self.modes))), np.zeros(len(found))
        for k, one in enumerate(found):
            vectors[k, list(one.modes)], widths[k] = one.parts, one.span[1] - one.span[0]
        return vectors, widths

    def confirmed(
        self,
        modes: np.ndarray,
        parts: np.ndarray,
        span: np.ndarray,
        known: tuple[float, ...] = (),
        tolerance: float = COARSE,
    ) -> Combination | None:
        """The suggestion along a ray, or None if the full test holds nowhere that it is tried; `known` are places.

        Ends of its range are found up to `tolerance`.
        """
        self.tested += 1
        direction = self.modes.direction(modes, parts)
        enters, leaves = span
        if not known and len(modes) > 1 and self.limits.glances:
            places = enters + INSIDE[1 : 1 + self.limits.glances] * (leaves - enters)
            if not self._good(direction, places).any():
                return None
        t = np.unique(np.concatenate([known, enters + INSIDE * (leaves - enters), enters * BEYOND]))
        t = np.concatenate([[0.0], t[(t > 0.0) & (t <= LONGEST)]])
        # The design as it is has a flaw that is wanted away.
        first = next((k for k in range(1, len(t)) if self._good(direction, t[k : k + 1])[0]), 0)
        if not first:
            return None
        after = leaves + AFTER * (LONGEST - leaves)
        t = np.concatenate([t, after[after > t[-1]]])
        good = self._good(direction, t[first + 1 :])
        last = first + int(np.argmin(np.append(good, False)))
        left = self._end(direction, float(t[first]), float(t[first - 1]), tolerance)
        right = float(t[last]), float(t[last])
        if last + 1 < len(t):
            right = self._end(direction, float(t[last]), float(t[last + 1]), tolerance)
        span, outside = (left[0], right[0]), (left[1], right[1])
        shown = self._shown(direction, span, float(t[first]))
        numbers = tuple(int(k) for k in modes)
        names = self.modes.names(modes)
        return Combination(numbers, tuple(map(float, parts)), direction, shown, span, outside, names, True)

    def _finer(self, one: Combination, places: int) -> Combination:
        """The same with its range looked at more closely, and the ends of that as they are shown."""
        span, bad = stretch(self.test, one.direction, one.span, one.t, self.wanted, places)
        outside = tuple(out if cut is None else cut for out, cut in zip(one.outside, bad))
        one = replace(one, span=span, outside=(outside[0], outside[1]))
        if all(abs(end - out) <= FINE for end, out in zip(one.span, one.outside)):
            return one
        ends = [self._end(one.direction, *pair, FINE) for pair in zip(one.span, one.outside)]
        span, outside = (ends[0][0], ends[1][0]), (ends[0][1], ends[1][1])
        return replace(one, t=self._shown(one.direction, span, one.t), span=span, outside=outside)

    def _end(self, direction: np.ndarray, good: float, bad: float, tolerance: float) -> tuple[float, float]:
        """The last valid and the first invalid parameter between a valid and an invalid one, or those if they agree.

        If what is wrong beyond needs no forces, that alone is bisected, for the full test takes long just before a
        design fails. It must hold at the end that is found, or where a bracket is narrow already half way to it.
        """
        if abs(bad - good) <= tolerance:
            return good, bad
        if abs(bad - good) > COARSE > tolerance:
            good, bad = self._end(direction, good, bad, COARSE)
        flaws = int(self.test.scan(direction, np.array([bad]), self.searched.forceless & self.wanted)[0][0])
        if flaws:
            ends = self.test.bisect(direction, good, bad, tolerance, flaws)[:2]
            place = ends[0] if abs(bad - good) > COARSE else 0.5 * (good + ends[0])
            if self._good(direction, np.array([place]))[0]:
                return ends
        return self.test.bisect(direction, good, bad, tolerance, self.wanted)[:2]

    def _shown(self, direction: np.ndarray, span: tuple[float, float], tested: float) -> float:
        t = span[0] + REPRESENTED * (span[1] - span[0])
        return t if self._good(direction, np.array([t]))[0] else tested

    def _good(self, direction: np.ndarray, t: np.ndarray) -> np.ndarray:
        return self.test.scan(direction, t, self.wanted)[0] == 0


def most_different(vectors: np.ndarray, widths: np.ndarray, count: int) -> list[int]:
    """An order of directions (k, m): the widest first, then what is wide and far from all before."""
    if not len(vectors):
        return []
    order: list[int] = []
    far = np.ones(len(vectors))
    score = widths / max(widths.max(), 1e-300)
    while len(order) < min(count, len(vectors)):
        merit = far * (0.25 + score)
        merit[order] = -1.0
        order.append(int(np.argmax(merit)))
        far = np.minimum(far, 1.0 - vectors @ vectors[order[-1]])
    return order
