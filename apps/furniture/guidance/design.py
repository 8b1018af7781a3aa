"""A piece between two edits, with its model and what guidance finds of it, each found once."""

# More than 15 modules: a design is tested in every way that guidance knows.

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from textwrap import shorten
from time import perf_counter

import numpy as np
from restshape_apps.furniture.guidance import amounts
from restshape_apps.furniture.guidance.connecting import Connection, connections
from restshape_apps.furniture.guidance.force_space import durability_space
from restshape_apps.furniture.guidance.preferences import kept_modes, preserved, way_of_material
from restshape_apps.furniture.guidance.quantity_limits import violated_limits
from restshape_apps.furniture.guidance.reconnect import Reconnection, reconnect
from restshape_apps.furniture.guidance.remedies import Remedy, Setting, remedies
from restshape_apps.furniture.guidance.suggestions import Combinations, suggest
from restshape_apps.furniture.guidance.support_planks import FLOOR, SupportPlank, support_planks
from restshape_apps.furniture.physics import plank_findings
from restshape_apps.furniture.physics.furniture import (
    ALL,
    APART,
    DOUBTFUL,
    LOST,
    OVERLAPPING,
    UNSTABLE,
    WEAK,
    Furniture,
    TestResult,
)
from restshape_apps.furniture.physics.plank_phrases import phrases
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_apps.furniture.shape.planks import FREEDOMS, Piece, joints_near

from restshape.findings import Finding
from restshape.guidance.combination_search import REPRESENTED, Combination
from restshape.guidance.force_space import LONGEST
from restshape.guidance.ranges import Ranges, predicted_ends, valid_ranges
from restshape.scene.model import Quantity

REACH = LONGEST
"""How far a parameter is looked at on both sides, in parts of the piece's size, or in rad."""

MOST_FREEDOMS = 5
"""Freedoms that a search can combine."""

MORE_DIGITS = 6

TRIED = 1e-3
"""Change [m or rad] of a fixed parameter by which it is found which joint or foot would open."""

REST = 160
"""Letters at most of what a suggestion leaves wrong."""

DOUBTS, NARROW = 48, 1e-4
"""Places of a valid range where doubts are looked for, and the least part of the way that is shown as doubtful."""

FASTENING = "closer fasteners ([fastener] spacing), stronger ones or a lighter load"
"""What else helps a weak joint."""


@dataclass(frozen=True)
class Guidance:
    """How much guidance is asked for.

    Args:
        ranges: valid ranges of the parameter under the hand.
        suggestions: shown at most; 0 looks for none.
        freedoms: of the design that a suggestion changes at most.
        keep: what no suggestion changes, as in `[effects.guidance]`.
        quantities: of the scene, whose limits suggestions are to obey.
    """

    ranges: bool = True
    suggestions: int = 8
    freedoms: int = 3
    keep: tuple[str, ...] = ()
    quantities: Mapping[str, Quantity] = field(default_factory=dict)


@dataclass(frozen=True)
class Suggestion:
    """A suggestion of any kind.

    Args:
        words: what it does where it is shown, with amounts.
        direction: (n, 8) change of the design parameters by a unit of t; None: it is another piece.
        t: where it is shown: how far its leading parameter, which `words` names first, is changed [m or rad].
        span: valid range of t around it.
        valid: the full test holds there; else `rest` shows what is still wrong.
        piece: with one more plank; None where planks move.
        unit: of t, "m" or "rad"; empty for a piece.
        name: which parameters it changes.
        beyond: the range may go on past what was looked at, at both ends.
        rest: what is still wrong where it is shown; empty where it is valid.
        doubt: what is doubtful where it is valid; empty where nothing is.
        setting: key of the scene and its value, of what is no other drawing; None elsewhere.
    """

    words: str
    direction: np.ndarray | None
    t: float
    span: tuple[float, float]
    valid: bool
    piece: Piece | None = None
    unit: str = ""
    name: str = ""
    beyond: tuple[bool, bool] = (False, False)
    rest: str = ""
    doubt: str = ""
    setting: Setting | None = None

    @classmethod
    def along(
        cls, piece: Piece, direction: np.ndarray, t: float, span: tuple[float, float], open_: bool, valid: bool
    ) -> Suggestion:
        """The suggestion along a direction (n, 8), t and its range in any unit; `open_`: the range may go on."""
        leading = amounts.parameters(piece, direction)[0]
        scale = abs(float(direction[leading]))
        words, name = amounts.in_words(piece, t * direction), amounts.named(piece, direction)
        span = span[0] * scale, span[1] * scale
        unit = amounts.unit_of(leading[1])
        return cls(words, direction / scale, t * scale, span, valid, None, unit, name, (False, open_))

    @classmethod
    def of(cls, one: Connection) -> Suggestion:
        """The suggestion that joins a part to the rest."""
        return cls(one.words, None, 1.0, (0.0, 1.0), one.flaws == 0, one.piece, name="a part joined")

    @classmethod
    def by(cls, one: Remedy) -> Suggestion:
        """The suggestion of other fasteners or thicker planks."""
        return cls(one.words, None, 1.0, (0.0, 1.0), True, one.piece, name=one.name, setting=one.setting)

    @property
    def kind(self) -> str:
        """What kind of change it leads with: a move, a turn, a length, or a plank."""
        return self.name.partition(": ")[2].partition(" ")[0] if self.direction is not None else self.name

    @property
    def range_words(self) -> str:
        """Its range, for people: how far its leading parameter may be changed; empty for a piece."""
        if not self.unit:
            return ""
        low, high = (amounts.amount(end, self.unit) for end in self.span)
        others = ", the others in proportion" if np.count_nonzero(self.direction) > 1 else ""
        what = "valid" if self.valid else "nothing more is wrong"
        return f"{what} from {low} to {high}{' or beyond' if self.beyond[1] else ''}{others}"

    @property
    def summary(self) -> str:
        """What it does, and its range."""
        doubt = f"holds, but {self.doubt}" if self.doubt else ""
        parts = (self.words, self.range_words, f"still wrong: {self.rest}" if self.rest else "", doubt)
        return "; ".join(filter(None, parts))


@dataclass(frozen=True)
class SuggestionList:
    """What was found for an invalid piece: suggestions, combinations tried, full tests, and the time taken [s].

    `why` shows why there are none.
    """

    found: tuple[Suggestion, ...] = ()
    tried: int = 0
    tested: int = 0
    seconds: float = 0.0
    why: str = ""


@dataclass(frozen=True, eq=False)
class DesignDirection:
    """A parameter under the hand: design parameters t times `direction` of a design.

    Args:
        design: that it changes.
        direction: (n, 8).
        name: for people.
        low, high: how far it is looked at.
        subject: what is under the hand, without the direction in which it goes.
        expected: where ends of its range are known to be.
    """

    design: Design
    direction: np.ndarray
    name: str
    low: float
    high: float
    subject: str = ""
    expected: tuple[float, ...] = ()

    @property
    def unit(self) -> str:
        """The unit of the parameter, "m" or "rad"."""
        return amounts.unit_of(amounts.parameters(self.design.piece, self.direction)[0][1])

    @cached_property
    def ranges(self) -> Ranges:
        """Where the piece is valid along it."""
        return self.design.valid_along(self)

    @cached_property
    def doubtful(self) -> tuple[tuple[float, float], ...]:
        """The parts of its ranges where moments that do not count overload a joint."""
        return self.design.doubtful_along(self)


@dataclass(eq=False)
class Design:
    """A piece as it is between two edits.

    Args:
        piece: with closed joints, as far as they can be closed.
        guidance: how much is asked for.

    Raises:
        UserError: the piece cannot be had.
    """

    piece: Piece
    guidance: Guidance = field(default_factory=Guidance)

    def __post_init__(self) -> None:
        self.furniture = Furniture(self.piece)

    @classmethod
    def closed(cls, piece: Piece, guidance: Guidance) -> Design:
        """The design of a piece whose joints are as they were drawn."""
        return cls(Furniture(piece).moved(), guidance)

    def moved(self, gamma: np.ndarray) -> Design:
        """The design at design parameters (n, 8)."""
        return Design(self.furniture.moved(gamma), self.guidance)

    @cached_property
    def freedoms(self) -> frozenset[tuple[int, int]]:
        """Plank and number of each design parameter that is valid."""
        found = frozenset((int(p), int(f)) for p, f in self.furniture.kernel.freedoms())
        self.furniture.test()
        return found

    def why_fixed(self, plank: int, number: int | None) -> str:
        """Why a plank cannot change a design parameter, None: be moved; and what of it can be changed instead."""
        verb = "move" if number is None else _verb(FREEDOMS[number])
        why = f"{self.piece.planks[plank].name} cannot {verb}: its joints and feet would not stay closed"
        for sign in (1.0, -1.0) if number is not None else ():
            gamma = np.zeros((len(self.piece.planks), 8))
            gamma[plank, number] = sign * TRIED
            result = self.furniture.test(gamma)
            if result.flaws & LOST:
                why += f" ({'; '.join(phrases([one for one in result.findings if one.kind == plank_findings.LOST]))})"
                break
        self.furniture.test()
        free = [FREEDOMS[k] for k in range(8) if (plank, k) in self.freedoms]
        return f"{why}; free: {', '.join(free) if free else 'nothing of it'}"

    def way(self, direction: np.ndarray, name: str, subject: str = "") -> DesignDirection:
        """The way along a direction (n, 8), looked at as far as suggestions go: `REACH` in sizes and radians."""
        sizes, turns = direction[:, [0, 1, 2, 6, 7]] / self.piece.size, direction[:, 3:6]
        reach = REACH / float(np.hypot(np.linalg.norm(sizes), np.linalg.norm(turns)))
        return DesignDirection(self, direction, name, -reach, reach, subject or name)

    def followed(self, suggestion: Suggestion) -> DesignDirection:
        """The way along a suggestion, whose range has the ends that it was reported with."""
        return replace(self.way(suggestion.direction, suggestion.name), expected=suggestion.span)

    def parameter(self, plank: int, number: int) -> DesignDirection:
        """The way along one design parameter, in m or rad."""
        direction = np.zeros((len(self.piece.planks), 8))
        direction[plank, number] = 1.0
        return self.way(direction, f"{self.piece.planks[plank].name}: {FREEDOMS[number]}")

    def valid_along(self, way: DesignDirection) -> Ranges:
        """Where the piece is valid along a way, with ends that the force space predicts as hints."""
        return valid_ranges(self.furniture.kernel, way.direction, way.low, way.high, hints=self.hints(way), wanted=ALL)

    def doubtful_along(self, way: DesignDirection) -> tuple[tuple[float, float], ...]:
        """The parts of a way's valid ranges where moments that do not count overload a joint."""
        found: list[tuple[float, float]] = []
        for low, high in way.ranges.intervals.tolist():
            ranges = self._sure(way.direction, low, high)
            marks = [low, *ranges.intervals.ravel().tolist(), high]
            found += [
                pair for pair in zip(marks[::2], marks[1::2]) if pair[1] - pair[0] > NARROW * (way.high - way.low)
            ]
        return tuple(found)

    def _sure(self, direction: np.ndarray, low: float, high: float) -> Ranges:
        """Where a piece that is valid along a direction (n, 8) is beyond doubt."""
        wanted = ALL | DOUBTFUL
        return valid_ranges(self.furniture.kernel, direction, low, high, samples=DOUBTS, tolerance=1e-4, wanted=wanted)

    def hints(self, way: DesignDirection) -> np.ndarray:
        """Parameters of a way where ends of its ranges are expected, by the derivative at the piece as it is."""
        self.furniture.kernel.forget()
        result = self.furniture.test()
        hints = np.array(way.expected)
        used = np.argwhere(way.direction != 0.0)
        if not result.flaws & LOST and len(self.piece.joints) and len(used):
            modes = DesignModes.of(self.piece, [tuple(one) for one in used.tolist()])
            units = np.array([modes.directions[k].reshape(-1, 8)[p, f] for k, (p, f) in enumerate(used)])
            parts = np.array([way.direction[p, f] for p, f in used]) / units
            hints = np.append(hints, predicted_ends(durability_space(self.furniture, modes), parts))
        return hints

    @cached_property
    def suggestion_list(self) -> SuggestionList:
        """Suggestions for a piece that is not valid; none for one that is."""
        most, start = self.guidance.suggestions, perf_counter()
        self.furniture.kernel.forget()
        flaws = self.furniture.test().flaws
        if not flaws or not most:
            return SuggestionList()
        if flaws & LOST:
            search = reconnect(self.furniture, most)
            found = [self._along(one, one.span[1] >= LONGEST, one.flaws == 0) for one in search.found]
            tried, tested, why = search.tried, search.tested, search.why
        elif flaws & APART:
            found = [Suggestion.of(one) for one in connections(self.piece, most)]
            tried, tested, why = 0, len(found), "no move of a part joins it to the rest: draw a plank between them"
        elif flaws & OVERLAPPING or not flaws & (UNSTABLE | WEAK):
            found, tried, tested = [], 0, 0
            why = "planks overlap: move them apart" if flaws & OVERLAPPING else "no equilibrium was found"
        elif flaws & UNSTABLE and not self.piece.feet:
            found, tried, tested = [], 0, 0
            why = "nothing stands on the floor: draw a plank that does, or connect one that is near it"
        else:
            searches = self._combined(most)
            found = [self._along(one, one.beyond, one.valid) for each in searches for one in each.found]
            tried, tested = (sum(counts) for counts in zip(*((sum(one.tried), one.tested) for one in searches)))
            why = self._why_none(searches[-1])
            why += f"; {FASTENING} may help" if flaws & WEAK else ""
            if flaws & WEAK and not flaws & UNSTABLE:
                supports = [self._supported(one) for one in support_planks(self.furniture)][:most]
                others = [Suggestion.by(one) for one in remedies(self.piece, self._obeys)]
                found = [*found[: max(most - len(supports) - len(others), 0)], *supports, *others]
        judged = [self._with_doubt(self._with_rest(one)) for one in _distinct(self.piece, found)]
        found = self._ordered([self._with_limits(one) for one in judged])[:most]
        self.furniture.test()
        return SuggestionList(tuple(found), tried, tested, perf_counter() - start, "" if found else why)

    def _combined(self, most: int) -> list[Combinations]:
        """Searches for combinations, first of those that keep the piece level and symmetric, until some are found."""
        searches, count = [], 0
        for modes in kept_modes(self.furniture, self.guidance.keep):
            searches.append(suggest(self.furniture, self.guidance.freedoms, most, modes=modes))
            # What holds in part only keeps nothing worth keeping.
            count += sum(one.valid for one in searches[-1].found)
            if count:
                break
        return searches

    def _ordered(self, found: list[Suggestion]) -> list[Suggestion]:
        """Suggestions by what they leave wrong or doubtful, what they keep, and how far material goes; of each kind the
        first comes before the others."""
        keys = {id(one): self._rank(one) for one in found}
        order = sorted(found, key=lambda one: keys[id(one)])
        seen: Counter[tuple] = Counter()
        places = []
        for one in order:
            kind = (*keys[id(one)][:3], one.kind)
            places.append((*keys[id(one)][:3], seen[kind]))
            seen[kind] += 1
        return [one for _, one in sorted(zip(places, order), key=lambda pair: pair[0])]

    def _rank(self, one: Suggestion) -> tuple[bool, bool, int, float]:
        if one.setting is not None:
            # The drawing stays, and the hand that drew it may want to change that first.
            return False, bool(one.doubt), 0, self.piece.size
        after = one.piece or self.furniture.moved(one.t * one.direction)
        if len(after.planks) == len(self.piece.planks):
            lost = preserved(self.piece, after).count(False)
        else:
            lost = 0 if preserved(self.piece, replace(after, planks=after.planks[: len(self.piece.planks)]))[0] else 1
        return not one.valid, bool(one.doubt), lost, round(way_of_material(self.piece, after), 9)

    def _with_rest(self, one: Suggestion) -> Suggestion:
        """The suggestion with what is still wrong where it is shown."""
        if one.valid:
            return one
        if one.piece is not None:
            words = Furniture(one.piece).test().words
        else:
            gamma = one.t * one.direction
            words = phrases(findings_at(self.furniture, self.furniture.test(gamma), gamma))
            self.furniture.test()
        return replace(one, rest=shorten("; ".join(words), REST, placeholder=" ..."))

    def _with_doubt(self, one: Suggestion) -> Suggestion:
        """The suggestion where it is beyond doubt if it is so anywhere in its range; else with what is doubtful."""
        if not one.valid:
            return one
        if one.piece is not None:
            return replace(one, doubt=self._doubt(Furniture(one.piece).test()))
        result = self.furniture.test(one.t * one.direction)
        if not result.doubts:
            return one
        low, high = one.span
        intervals = self._sure(one.direction, low, high).intervals if high > low else np.zeros((0, 2))
        if not len(intervals):
            return replace(one, doubt=self._doubt(result))
        left, right = intervals[int(np.argmin(np.abs(intervals - one.t).min(axis=1)))].tolist()
        t = left + REPRESENTED * (right - left)
        words = amounts.in_words(self.piece, t * one.direction)
        return replace(one, t=t, span=(left, right), words=words, beyond=(False, one.beyond[1] and right >= high))

    def _obeys(self, piece: Piece) -> bool:
        return not violated_limits(piece, self.guidance.quantities)

    def _with_limits(self, one: Suggestion) -> Suggestion:
        """The suggestion with the limits of quantities that it violates, which make it doubtful too."""
        if not (one.valid and self.guidance.quantities):
            return one
        after = one.piece or self.furniture.moved(one.t * one.direction)
        words = phrases(violated_limits(after, self.guidance.quantities))
        doubt = "; ".join(filter(None, [one.doubt, *words]))
        return replace(one, doubt=shorten(doubt, REST, placeholder=" ..."))

    @staticmethod
    def _doubt(result: TestResult) -> str:
        return shorten("; ".join(phrases(result.doubts)), REST, placeholder=" ...")

    def _along(self, one: Combination | Reconnection, open_: bool, valid: bool) -> Suggestion:
        return Suggestion.along(self.piece, one.direction, one.t, one.span, open_, valid)

    def _why_none(self, search: Combinations) -> str:
        """Why a search of combinations found nothing."""
        if not len(search.modes):
            return "no plank can move, turn or change its length without opening a joint"
        few, tried = self.guidance.freedoms, sum(search.tried)
        if not tried:
            return "nothing tells how far it is from standing: its contacts lie on several planes"
        what = f"{tried} combinations of at most {few} freedoms tried"
        if not search.led:
            more = f"; effects.guidance.freedoms may be up to {MOST_FREEDOMS}" if few < MOST_FREEDOMS else ""
            return f"{what}, none leads to where it holds{more}"
        return f"{what}, {search.led} lead to where it should hold, but none of {search.tested} tested in full does"

    def _supported(self, board: SupportPlank) -> Suggestion:
        first, other = ("the floor" if k == FLOOR else self.piece.planks[k].name for k in board.between)
        plank = board.piece.planks[-1]
        long, wide = (amounts.amount(float(size), "m") for size in plank.size[:2])
        place = ", ".join(f"{1e3 * x:.0f}" for x in plank.centre)
        words = f"a plank of {long} by {wide} between {first} and {other}, its middle at ({place}) mm"
        words += f", its length {amounts.along(plank.axes[:, 0])}, its width {amounts.along(plank.axes[:, 1])}"
        if len({round(float(one.size[2]), 9) for one in self.piece.planks}) > 1:
            words += f", {amounts.amount(float(plank.size[2]), 'm')} thick"
        if len({one.wood for one in self.piece.planks}) > 1:
            words += f", of {plank.wood}"
        third = self.piece.planks[board.third]
        if joints_near((third, plank), self.piece.reach):
            # Drawn there by hand it would be.
            words += f", not joined to {third.name} beside it"
        return Suggestion(words, None, 1.0, (0.0, 1.0), board.result.valid, board.piece, name="a support plank")


def findings_at(furniture: Furniture, result: TestResult, gamma: np.ndarray) -> tuple[Finding, ...]:
    """What is wrong at design parameters (n, 8), with distances as they are there."""
    moved = gamma.any() and result.flaws & (LOST | APART | UNSTABLE)
    return (replace(result, piece=furniture.moved(gamma)) if moved else result).findings


def _verb(parameter: str) -> str:
    """What a plank does when a parameter of it changes."""
    kind, _, axis = parameter.partition(" ")
    return f"become longer along its {axis}" if kind == "length" else f"{kind} {axis}".strip()


def _distinct(piece: Piece, found: list[Suggestion]) -> list[Suggestion]:
    """The suggestions, with more digits where words are the same; what still reads the same is the same."""
    said = Counter(one.words for one in found)
    distinct: dict[str, Suggestion] = {}
    for one in found:
        if said[one.words] > 1 and one.direction is not None:
            one = replace(one, words=amounts.in_words(piece, one.t * one.direction, MORE_DIGITS))
        distinct.setdefault(one.words, one)
    return list(distinct.values())
