"""A piece between two edits, with its model and what guidance finds of it, each found once."""

# More than 15 modules: a design is tested in every way that guidance knows.

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from textwrap import shorten
from time import perf_counter

import numpy as np
from restshape_apps.furniture.guidance import amounts
from restshape_apps.furniture.guidance.clear_range import clear_ranges, complement
from restshape_apps.furniture.guidance.connecting import connections, same_place
from restshape_apps.furniture.guidance.doubt_mends import DoubtMends
from restshape_apps.furniture.guidance.doubts import depends, doubts, free
from restshape_apps.furniture.guidance.farthest import FARTHEST, NEAR
from restshape_apps.furniture.guidance.force_space import durability_space
from restshape_apps.furniture.guidance.lengthening import lengthenings
from restshape_apps.furniture.guidance.overlap_advice import overlap_advice
from restshape_apps.furniture.guidance.preferences import farthest_move, kept_modes, locked, shape_costs
from restshape_apps.furniture.guidance.quantity_limits import violated_limits
from restshape_apps.furniture.guidance.ranked import ranked
from restshape_apps.furniture.guidance.reconnect import Reconnection, reconnect
from restshape_apps.furniture.guidance.remedies import Thickened, as_thick, remedies
from restshape_apps.furniture.guidance.sliding_advice import why_slides
from restshape_apps.furniture.guidance.suggested import Suggestion, SuggestionList
from restshape_apps.furniture.guidance.suggestions import Combinations, suggest
from restshape_apps.furniture.guidance.support_planks import support_planks
from restshape_apps.furniture.guidance.weights_along import weights_along
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
from restshape_apps.furniture.physics.joint_compliance import ComplianceModels
from restshape_apps.furniture.physics.plank_phrases import phrases
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_apps.furniture.shape.free_ends import free_ends_at
from restshape_apps.furniture.shape.planks import FREEDOMS, Piece

from restshape.findings import Finding
from restshape.guidance.combination_search import REPRESENTED, Combination
from restshape.guidance.force_space import LONGEST, ForceSpace
from restshape.guidance.ranges import Ranges, predicted_ends, valid_ranges
from restshape.scene.model import Quantity

REACH = LONGEST
"""How far a parameter is looked at on both sides, in parts of the piece's size, or in rad."""

MOST_FREEDOMS = 5
"""Freedoms that a search can combine."""

TRIED = 1e-3
"""Change [m or rad] of a fixed parameter by which it is found which joint or foot would open."""

REST = 160
"""Letters at most of what a suggestion leaves wrong."""

FAR_WORDS = 90
"""Letters at most of what would mend a piece but goes too far."""

ADVICE = 3
"""Planks that overlap of which it is said what to do."""

DOUBTS, NARROW = 48, 1e-4
"""Places of a valid range where doubts are looked for, and the least part of it that is shown as doubtful."""

CLEAR = 0.02
"""Least part of the range of a suggestion that must be beyond doubt for the suggestion to be cut to it."""

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
        farthest: how far a suggestion moves any corner of a plank at most, in parts of the piece's longest side; None:
            `NEAR` where something as near holds, else `FARTHEST`.
        thickened: what gives all planks another thickness, as formulas of the scene have it.
        bending: whether planks bend, and may so be overloaded.
    """

    ranges: bool = True
    suggestions: int = 8
    freedoms: int = 3
    keep: tuple[str, ...] = ()
    quantities: Mapping[str, Quantity] = field(default_factory=dict)
    farthest: float | None = None
    thickened: Thickened = as_thick
    bending: bool = False


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

    @cached_property
    def unit(self) -> str:
        """The unit of the parameter, "m" or "rad"."""
        return amounts.unit_of(amounts.leading_parameter(self.design.piece, self.direction)[1])

    @cached_property
    def ranges(self) -> Ranges:
        """Where the piece is valid along it."""
        return self.design.valid_along(self)

    @cached_property
    def doubtful(self) -> tuple[tuple[float, float], ...]:
        """The parts of its ranges where it holds in doubt only."""
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
        self._spaces: dict[tuple[tuple[int, int], ...], tuple[np.ndarray, ForceSpace]] = {}

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

    def design_direction(self, direction: np.ndarray, name: str, subject: str = "") -> DesignDirection:
        """The design direction of (n, 8), looked at as far as suggestions go: `REACH` in sizes and radians."""
        sizes, turns = direction[:, [0, 1, 2, 6, 7]] / self.piece.size, direction[:, 3:6]
        reach = REACH / float(np.hypot(np.linalg.norm(sizes), np.linalg.norm(turns)))
        return DesignDirection(self, direction, name, -reach, reach, subject or name)

    def followed(self, suggestion: Suggestion) -> DesignDirection:
        """The design direction along a suggestion, whose range has the ends that it was reported with."""
        along = self.design_direction(suggestion.direction, suggestion.name)
        low, high = suggestion.span
        return replace(along, expected=suggestion.span, low=min(along.low, low), high=max(along.high, high))

    def parameter(self, plank: int, number: int) -> DesignDirection:
        """The design direction along one design parameter, in m or rad."""
        direction = np.zeros((len(self.piece.planks), 8))
        direction[plank, number] = 1.0
        return self.design_direction(direction, f"{self.piece.planks[plank].name}: {FREEDOMS[number]}")

    def valid_along(self, design_direction: DesignDirection) -> Ranges:
        """Where the piece is valid along a design direction, with ends that the force space predicts as hints."""
        return valid_ranges(
            self.furniture.kernel,
            design_direction.direction,
            design_direction.low,
            design_direction.high,
            hints=self.hints(design_direction),
            wanted=ALL,
        )

    def doubtful_along(self, design_direction: DesignDirection) -> tuple[tuple[float, float], ...]:
        """The parts of a direction's valid ranges where what does not count overloads a joint or a plank, an end is
        free, or compliances that nobody knows decide."""
        least, found = NARROW * (design_direction.high - design_direction.low), []
        # What is found depends on this direction alone, not on those before it.
        self._models.forget()

        def clear(t: float) -> bool:
            gamma = t * design_direction.direction
            if self._models.decide(gamma):
                return False
            raw = self.furniture.kernel.shape(gamma)
            if free_ends_at(self.piece, raw["centre"], raw["axes"], raw["size"]):
                return False
            return not self.guidance.bending or not violated_limits(self.furniture.moved(gamma), {}, True)

        for low, high in design_direction.ranges.intervals.tolist():
            sure = self._sure(design_direction.direction, low, high).intervals.tolist()
            found += complement(clear_ranges(clear, sure, least), low, high, least)
        return tuple(found)

    @cached_property
    def _models(self) -> ComplianceModels:
        return ComplianceModels(self.furniture)

    def _sure(self, direction: np.ndarray, low: float, high: float) -> Ranges:
        """Where a piece that is valid along a direction (n, 8) is beyond doubt."""
        wanted = ALL | DOUBTFUL
        return valid_ranges(self.furniture.kernel, direction, low, high, samples=DOUBTS, wanted=wanted)

    def hints(self, design_direction: DesignDirection) -> np.ndarray:
        """Parameters where ends of a direction's ranges are expected, by the derivative at the piece as it is."""
        self.furniture.kernel.forget()
        result = self.furniture.test()
        hints = np.array(design_direction.expected)
        used = np.argwhere(design_direction.direction != 0.0)
        if not result.flaws & LOST and len(self.piece.joints) and len(used):
            freedoms = tuple(map(tuple, used.tolist()))
            if freedoms not in self._spaces:
                # Frames of a drag differ in how far each freedom goes, not in which ones do.
                modes = DesignModes.of(self.piece, freedoms)
                units = np.array([modes.directions[k].reshape(-1, 8)[p, f] for k, (p, f) in enumerate(freedoms)])
                self._spaces[freedoms] = units, durability_space(self.furniture, modes)
            units, space = self._spaces[freedoms]
            parts = np.array([design_direction.direction[p, f] for p, f in freedoms]) / units
            hints = np.append(hints, predicted_ends(space, parts))
        return hints

    @cached_property
    def suggestion_list(self) -> SuggestionList:
        """Suggestions for a piece that is not valid, doubtful or beyond a limit; else none."""
        most, start = self.guidance.suggestions, perf_counter()
        self.furniture.kernel.forget()
        if not most:
            return SuggestionList()
        found, tried, tested, why = self._searched(self.furniture.test().flaws, most)
        unlocked = [one for one in _distinct(found) if self._unlocked(one)]
        why = f"what would mend it changes what is kept: {', '.join(self.guidance.keep)}" if found else why
        near = self._nearest([one for one in unlocked if self._near(self.after(one))])
        why = self._why_far(min(unlocked, key=self._move)) if unlocked else why
        judged = [self._with_doubt(self._with_rest(one)) for one in near]
        shown = [
            self._with_costs(self._with_weights(one))
            for one in ranked(self.piece, [(one, self.after(one)) for one in judged])[:most]
        ]
        self.furniture.test()
        return SuggestionList(tuple(shown), tried, tested, perf_counter() - start, "" if shown else why)

    def _searched(self, flaws: int, most: int) -> tuple[list[Suggestion], int, int, str]:
        """What a search for a piece with these flaws finds, what it tried and tested, and why it may find nothing."""
        if not flaws:
            asked = self.guidance
            mends = DoubtMends(
                self.furniture, asked.quantities, asked.keep, self._farthest, asked.thickened, asked.bending
            )
            found = mends.found()
            return found, mends.tried, mends.tests, mends.why() if mends.doubts else ""
        if flaws & LOST:
            search = reconnect(self.furniture, most)
            found = [self._along(one, one.span[1] >= LONGEST, one.flaws == 0) for one in search.found]
            tried, tested, why = search.tried, search.tested, search.why
        elif flaws & APART:
            ends, moves = lengthenings(self.piece), connections(self.piece, most)
            moves = tuple(one for one in moves if not any(same_place(one.piece, other.piece) for other in ends))
            found = [Suggestion.of(one) for one in (*ends, *moves)]
            why = self.advice or "no move of a part joins it to the rest: draw a plank between them"
            tried, tested = 0, len(found)
        elif flaws & OVERLAPPING or not flaws & (UNSTABLE | WEAK):
            found, tried, tested = [Suggestion.of(one) for one in lengthenings(self.piece)], 0, 0
            why = self.advice or "no equilibrium was found"
        elif flaws & UNSTABLE and not self.piece.feet:
            found, tried, tested = [Suggestion.of(one) for one in lengthenings(self.piece)], 0, 0
            why = "nothing stands on the floor: draw a plank that does, or connect one that is near it"
        else:
            searches = self._combined(most)
            found = [self._along(one, one.beyond, one.valid) for each in searches for one in each.found]
            tried, tested = (sum(counts) for counts in zip(*((sum(one.tried), one.tested) for one in searches)))
            why = self._why_none(searches[-1])
            added = [Suggestion.of(one) for one in lengthenings(self.piece)]
            if flaws & WEAK and flaws & UNSTABLE:
                why += f"; {FASTENING} may help"
            elif flaws & WEAK:
                why += "; closer or other fasteners and thicker planks do not help either; a lighter load may"
                supports = [Suggestion.supported(self.piece, one) for one in support_planks(self.furniture)]
                others = map(Suggestion.by, remedies(self.piece, self._obeys, False, self.guidance.thickened))
                added += [*supports, *others]
            found += [one for one in added if self._unlocked(one)]
        return found, tried, tested, why

    @property
    def advice(self) -> str:
        """What to do about planks that overlap; empty where none do."""
        said = overlap_advice(self.piece, self.furniture.geometry().overlaps)
        return "; ".join(said[:ADVICE]) + (f"; and {len(said) - ADVICE} more" if len(said) > ADVICE else "")

    def after(self, one: Suggestion) -> Piece:
        """The piece where a suggestion is shown."""
        return one.piece or self.furniture.moved(one.t * one.direction)

    def _unlocked(self, one: Suggestion) -> bool:
        """Whether a suggestion keeps what is locked."""
        return locked(self.piece, self.after(one), self.guidance.keep)

    def _near(self, after: Piece) -> bool:
        """Whether a change moves no corner too far."""
        return farthest_move(self.piece, after) <= self._farthest * self.piece.size

    @property
    def _farthest(self) -> float:
        """How far a corner may be moved, in parts of the piece."""
        return FARTHEST if self.guidance.farthest is None else self.guidance.farthest

    def _nearest(self, found: list[Suggestion]) -> list[Suggestion]:
        """Those that stay near, where one of them holds and the scene says nothing of how far they may go."""
        near = [one for one in found if self._move(one) <= NEAR * self.piece.size]
        return near if self.guidance.farthest is None and any(one.valid for one in near) else found

    def _move(self, one: Suggestion) -> float:
        """How far [m] a suggestion moves the corner that goes farthest."""
        return farthest_move(self.piece, self.after(one))

    def _why_far(self, nearest: Suggestion) -> str:
        """Why nothing is shown where all would move things too far."""
        if self.advice:
            return self.advice
        share, what = self._move(nearest) / self.piece.size, shorten(nearest.words, FAR_WORDS, placeholder=" ...")
        far = f"{share:.2g} of the piece, and effects.guidance.farthest is {self._farthest:g}"
        return f"the nearest that would mend it goes too far ({what}: {far}): draw a plank between, or raise it"

    def _combined(self, most: int) -> list[Combinations]:
        """Searches for combinations, first of those that keep the piece level and symmetric, until some are found."""
        searches, count = [], 0
        for modes in kept_modes(self.furniture, self.guidance.keep):
            searches.append(suggest(self.furniture, self.guidance.freedoms, most, modes=modes))
            # What holds in part only, or far from here, keeps nothing worth keeping.
            count += sum(
                one.valid and self._near(self.furniture.moved(one.t * one.direction)) for one in searches[-1].found
            )
            self.furniture.test()
            if count:
                break
        return searches

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

    def _with_weights(self, one: Suggestion) -> Suggestion:
        """The suggestion with the weights that it takes along, where planks that carry them change their length."""
        taken = weights_along(self.piece, self.after(one)) if one.direction is not None else ""
        return replace(one, weights=taken) if taken else one

    def _with_costs(self, one: Suggestion) -> Suggestion:
        """The suggestion with what it costs the shape."""
        return replace(one, costs="" if one.settings else shape_costs(self.piece, self.after(one)))

    def _with_doubt(self, one: Suggestion) -> Suggestion:
        """The suggestion in the part of its range that is beyond doubt if there is one; else with what is doubtful."""
        if not one.valid:
            return one
        found = doubts(self.after(one), self.guidance.quantities, self.guidance.bending)
        doubtful = replace(one, doubt=shorten("; ".join(phrases(found)), REST, placeholder=" ..."))
        low, high = one.span
        if one.direction is None or high <= low:
            return doubtful
        clear = self._clear(one, bool(found))
        large = [(left, right) for left, right in clear if right - left >= CLEAR * (high - low)]
        if not found and not large:
            large = [(left, right) for left, right in clear if left <= one.t <= right]
        if not large or large == [one.span]:
            return doubtful
        left, right = min(large, key=lambda ends: max(ends[0] - one.t, one.t - ends[1], 0.0))
        t = left + REPRESENTED * (right - left)
        room = max(self._move(one), (self.guidance.farthest or NEAR) * self.piece.size)
        if farthest_move(self.piece, self.furniture.moved(t * one.direction)) > room:
            return doubtful
        words = amounts.in_words(self.piece, t * one.direction)
        return replace(one, t=t, span=(left, right), words=words, beyond=(False, one.beyond[1] and right >= high))

    def _clear(self, one: Suggestion, thorough: bool) -> list[tuple[float, float]]:
        """The parts of the range of a suggestion that nothing makes doubtful.

        `thorough`: limits, free ends and compliances are looked at inside the range too where its ends are clear.
        """
        low, high = one.span
        sure = self._sure(one.direction, low, high).intervals.tolist()

        def clear(t: float) -> bool:
            piece = self.furniture.moved(t * one.direction)
            return self._obeys(piece) and not (free(piece) or depends(piece))

        if not thorough and all(clear(end) for part in sure for end in part):
            return [(left, right) for left, right in sure]
        return clear_ranges(clear, sure, NARROW * (high - low))

    def _obeys(self, piece: Piece) -> bool:
        return not violated_limits(piece, self.guidance.quantities, self.guidance.bending)

    def _along(self, one: Combination | Reconnection, open_: bool, valid: bool) -> Suggestion:
        return Suggestion.along(self.piece, one.direction, one.t, one.span, open_, valid)

    def _why_none(self, search: Combinations) -> str:
        """Why a search of combinations found nothing."""
        if not len(search.modes):
            return "no plank can move, turn or change its length without opening a joint"
        few, tried = self.guidance.freedoms, sum(search.tried)
        if not tried:
            return "its stability margin is not known: its contacts lie on several planes"
        what = f"{tried} combinations of at most {few} freedoms tried"
        if not search.led:
            more = f"effects.guidance.freedoms may be up to {MOST_FREEDOMS}" if few < MOST_FREEDOMS else ""
            return "; ".join(filter(None, [f"{what}, none leads to where it holds", why_slides(self.piece) or more]))
        what = f"{what}, {search.led} lead to where it should hold, but none of {search.tested} tested in full does"
        return "; ".join(filter(None, [what, why_slides(self.piece)]))


def findings_at(furniture: Furniture, result: TestResult, gamma: np.ndarray) -> tuple[Finding, ...]:
    """What is wrong at design parameters (n, 8), with distances as they are there."""
    moved = gamma.any() and result.flaws & (LOST | APART | OVERLAPPING | UNSTABLE)
    return (replace(result, piece=furniture.moved(gamma)) if moved else result).findings


def _verb(parameter: str) -> str:
    """What a plank does when a parameter of it changes."""
    kind, _, axis = parameter.partition(" ")
    return f"become longer along its {axis}" if kind == "length" else f"{kind} {axis}".strip()


def _distinct(found: list[Suggestion]) -> list[Suggestion]:
    """The suggestions; of those that read the same, and so differ by rounding, the first that holds, or the first."""
    distinct: dict[str, Suggestion] = {}
    for one in sorted(found, key=lambda one: not one.valid):
        distinct.setdefault(one.words, one)
    return list(distinct.values())
