"""What there is to rasp on a bar that has been measured: the model's factor, places, ways to the tone, tolerances."""

from dataclasses import dataclass

import numpy as np
from restshape_apps.metallophone.rasping.advice import REACHED, Aim, Way, least_material, same_depth
from restshape_apps.metallophone.rasping.densities import Densities, densities_of
from restshape_apps.metallophone.rasping.outline_places import AROUND, all_around, outline_places
from restshape_apps.metallophone.rasping.places import Place, alike, strongest_first, worth_it
from restshape_apps.metallophone.rasping.rasped_bar import RaspedBar
from restshape_apps.metallophone.rasping.tolerances import Tolerances, tolerances
from restshape_apps.metallophone.rasping.underneath_places import WHOLE, underneath_places

from restshape.analysis.modal.modal import ModalAnalysis
from restshape.analysis.modal.pitch import cents_between
from restshape.errors import UserError
from restshape.sensitivity.frequency_derivative import stands_alone

OCTAVE = 1200.0
MOST_OFF_OUTLINE = 2e-3
"""Largest depth [m] off the outline, where none is named."""


@dataclass(frozen=True, eq=False)
class Wish:
    """What the maker has and wants.

    Args:
        measured: frequency [Hz] of the bar's first tone.
        target: that it is to have [Hz].
        keep: ranks of modes, from 1, whose ratio to the first is to stay.
        most: largest depth off the outline [m].
    """

    measured: float
    target: float
    keep: tuple[int, ...] = ()
    most: float = MOST_OFF_OUTLINE

    @property
    def cents(self) -> float:
        """By how many cents the tone is to go up."""
        return cents_between(self.target, self.measured)


@dataclass(frozen=True, eq=False)
class RaspingPlan:
    """The answer.

    Args:
        wish: the question.
        model: (modes,) frequencies [Hz] of the model; factor: on all of them, so that the first one is as measured.
        ranks: of the modes that places and ways have cents of, from 0: the first, those to keep, and the second.
        densities: of these modes.
        places: the strongest first; ways: those that reach the tone, the least material first.
        nearest: the nearest that the limits allow, where no way reaches the tone.
        left_out: ways off all of a face that the limits keep from the tone, in words.
        tolerances: of the bar.
        solves: how many there were.
    """

    wish: Wish
    model: np.ndarray
    factor: float
    ranks: list[int]
    densities: Densities
    places: list[Place]
    ways: list[Way]
    nearest: Way | None
    left_out: list[str]
    tolerances: Tolerances
    solves: int

    @property
    def in_tune(self) -> bool:
        """Whether there is nothing to rasp."""
        return abs(self.wish.cents) <= REACHED

    def goes(self, underneath: bool, up: bool) -> bool:
        """Whether rasping somewhere on the outline, or underneath, moves the tone up, or down."""
        return any(place.underneath == underneath and (place.cents[0] > 0.0) == up for place in self.places)


def rasping_plan(analysis: ModalAnalysis, wish: Wish) -> RaspingPlan:
    """Places, ways and tolerances of a bar.

    Args:
        analysis: solved on the mesh as it lies, which is put back at the end.
        wish: what is measured, and what is wanted.

    Raises:
        UserError: what is measured is more than an octave from the model, or a mode is not there or one of a pair.
    """
    f = analysis.frequencies.copy()
    away = cents_between(wish.measured, float(f[0]))
    if abs(away) > OCTAVE:
        raise UserError(
            f"{wish.measured:g} Hz is {away:+.0f} cents from the model's {f[0]:.1f} Hz, more than an octave",
            "--measured",
            "look at the scene's thickness and material, and at its unit",
        )
    ranks = _ranks(analysis, wish.keep)
    densities = densities_of(analysis, ranks)
    places = worth_it([*outline_places(analysis, densities, wish.most), *underneath_places(analysis, densities)])
    places = strongest_first([*places, *all_around(analysis, densities, wish.most)])
    found = tolerances(analysis)
    wanted = np.array([wish.cents, *np.zeros(len(wish.keep))])
    left_out: list[str] = []
    with RaspedBar(analysis, ranks) as bar:
        ways = _ways(Aim(bar, f[ranks], wanted), places, left_out) if abs(wish.cents) > REACHED else []
    reached = sorted((way for way in ways if way.reached(len(wish.keep))), key=lambda way: way.volume)
    kept = 1 + len(wish.keep)
    nearest = min(ways, key=lambda way: float(np.abs(way.off[:kept]).max()), default=None) if not reached else None
    factor = wish.measured / float(f[0])
    return RaspingPlan(wish, f, factor, ranks, densities, places, reached, nearest, left_out, found, bar.solves)


def _ranks(analysis: ModalAnalysis, keep: tuple[int, ...]) -> list[int]:
    """The modes to look at, from 0.

    Raises:
        UserError: one to keep is not computed, or one is of a pair.
    """
    count = len(analysis.frequencies)
    for mode in keep:
        if not 2 <= mode <= count:
            what = f"mode {mode} has no ratio that could be kept: modes 2 to {count} have one"
            raise UserError(what, "--keep", "name one of these, or raise effects.modal.modes")
    ranks = [0, *(mode - 1 for mode in dict.fromkeys(keep))]
    alone = [stands_alone(analysis, int(mode)) for mode in analysis.state.modes.chosen]
    for rank in ranks:
        if not alone[rank]:
            what = f"mode {rank + 1} is one of a pair: how it follows the rasp depends on how the pair parts"
            raise UserError(
                what, "--rasp", "rasp the bar where it is symmetric until its modes part, and measure again"
            )
    return [*ranks, *([1] if count > 1 and alone[1] and 1 not in ranks else [])]


def _ways(aim: Aim, places: list[Place], left_out: list[str]) -> list[Way]:
    """Ways to the tone: each place alone, all of one face alike, and what takes the least material.

    Args:
        aim: of them.
        places: that may be rasped.
        left_out: gets those of a whole face that the limits keep from the tone, in words.
    """
    up = aim.wanted[0] > 0.0
    right = [place for place in places if (place.cents[0] > 0.0) == up]
    parts = [place for place in (right if len(aim.wanted) == 1 else places) if place.where != AROUND]
    found: list[Way | None] = []
    if len(aim.wanted) == 1:
        found += [same_depth(aim, _words(group), group) for group in alike(parts)]
        for name, together in _faces(right, "raise" if up else "lower"):
            found.append(same_depth(aim, name, together))
            if found[-1] is None:
                left_out.append(_why(aim, name, together))
    name = "least material" if len(aim.wanted) == 1 else "least material, ratios kept"
    if len(aim.wanted) > 1 or not any(way is not None and way.reached(0) for way in found):
        found.append(least_material(aim, name, parts))
    return [way for way in found if way is not None]


def _faces(right: list[Place], verb: str) -> list[tuple[str, list[Place]]]:
    """What is rasped with one depth beside single places and those that mirror each other, with its name."""
    whole = [place for place in right if place.where == AROUND]
    found = [(AROUND, whole)] if whole else []
    for underneath, name in ((False, "all stretches of the outline"), (True, "all strips underneath")):
        parts = [one for one in right if one.underneath == underneath and one.where not in (WHOLE, AROUND)]
        if len(alike(parts)) > 1:
            found.append((f"{name} that {verb} it, alike", parts))
    return found


def _why(aim: Aim, name: str, places: list[Place]) -> str:
    """Why the same depth off places does not lead to the tone."""
    most, rate = aim.bar.most_alike(places), float(aim.rates(places)[0].sum())
    by = "as deep as the mesh shows" if most < 0.999 * min(place.limit for place in places) else "the limit"
    return f"{name}: {1e3 * most:.2f} mm, {by}, is {rate * most:+.1f} cents by derivatives"


def _words(group: list[Place]) -> str:
    """Where a group of places is."""
    if len(group) == 1:
        return group[0].words
    where = list(dict.fromkeys(place.where for place in group))
    return f"{len(group)} places alike: {' and '.join(where)}, {1e3 * group[0].length:.0f} mm {group[0].profile}"
