"""Which scenes are replayed to show what each effect of a scene costs."""

from dataclasses import dataclass

from restshape.application import Application
from restshape.scene.plan import Plan

Names = frozenset[str]

REQUIRED = "always there"
ALONE = "nothing else drives the body, without it there is nothing to solve"
PART = "no part that can be left out"


@dataclass(frozen=True)
class Difference:
    """The price of an effect: what frames cost more with it than without.

    Args:
        more, less: effects that are left out of the one replay, and of the other.
    """

    more: Names
    less: Names


@dataclass(frozen=True)
class Variants:
    """What is replayed.

    Args:
        sets: of effects that are left out, none of them first.
        differences: by effect, for those that are on and can be left out.
        alone: by effect, for one that drives the body alone, whose time cannot be determined.
        drivers: effects that drive the body.
        kept: by effect, why its time cannot be determined, for those that are on and in no difference.
    """

    sets: tuple[Names, ...]
    differences: dict[str, Difference]
    alone: dict[str, Difference]
    drivers: Names
    kept: dict[str, str]


def variants(plan: Plan, application: Application) -> Variants:
    """The replays that price the effects of a plan.

    An effect is left out of the whole scene, and what cannot be without it, or is done again for it, as well: the
    difference is then taken between two scenes without the latter. The last effect that drives the body stays, for a
    body that nothing loads costs nothing.
    """
    on = [effect.name for effect in (*plan.effects, *plan.derived) if effect.on]
    known = {**application.effects, **application.derived}
    drivers = frozenset(name for name in on if known[name].drives)
    differences, alone, kept = {}, {}, {}
    for name in on:
        if name in application.effects:
            lasting = application.effects[name].required and REQUIRED
        else:
            lasting = application.derived[name].without is None and PART
        if lasting:
            kept[name] = lasting
            continue
        more = _hanging_on(name, on, application)
        if drivers and not drivers - more:
            more = frozenset()
        less = more | {name}
        if drivers & less and not drivers - less:
            kept[name], alone[name] = ALONE, Difference(more, less)
            continue
        differences[name] = Difference(more, less)
    sets = {frozenset[str](): None}
    for difference in (*differences.values(), *alone.values()):
        sets |= {difference.more: None, difference.less: None}
    return Variants(tuple(sets), differences, alone, drivers, kept)


def _hanging_on(name: str, on: list[str], application: Application) -> Names:
    """The effects that are on and cannot be without one, or do their work again for what it adds."""
    repeated = application.effects[name].repeats if name in application.effects else ()
    needing = {other for other, one in application.derived.items() if one.needs == name and one.without is not None}
    return frozenset(other for other in on if other in repeated or other in needing)
