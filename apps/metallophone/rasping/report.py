"""A rasping plan on the console, and for programs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from restshape_apps.metallophone.rasping.advice import REACHED
from restshape_apps.metallophone.rasping.tolerances import TENTH, print_tolerances

from restshape.cli.options import print_table

if TYPE_CHECKING:
    from restshape_apps.metallophone.rasping.advice import Way
    from restshape_apps.metallophone.rasping.places import Place
    from restshape_apps.metallophone.rasping.plan import RaspingPlan

FACES = ((False, "along the outline"), (True, "underneath"))


def print_plan(plan: RaspingPlan, tone: str) -> None:
    """Print the factor, the places, the ways to a tone and the tolerances."""
    wish = plan.wish
    print(f"measured {wish.measured:.2f} Hz; {tone} is {wish.target:.2f} Hz, {wish.cents:+.1f} cents from it")
    print(f"model {plan.model[0]:.2f} Hz; one factor {plan.factor:.4f} on all tones, so that their ratios stay")
    _print_places(plan)
    for sentence in directions(plan):
        print(sentence)
    if plan.in_tune:
        print(f"the bar is in tune: nothing to rasp for {tone}")
    elif plan.ways:
        _print_ways(plan, plan.ways, f"ways to {tone}: each is solved for on the rasped bar")
    else:
        print(out_of_reach(plan, tone))
        if plan.nearest is not None:
            _print_ways(plan, [plan.nearest], "the nearest to it")
    for words in plan.left_out:
        print(f"not enough: {words}")
    print_tolerances(plan.tolerances)


def out_of_reach(plan: RaspingPlan, tone: str) -> str:
    """What no rasping within the limits does, in words: the tone, or ratios to be kept with it."""
    near = plan.nearest
    if near is None or not near.reached(0):
        return f"no rasping within the limits of depth leads to {tone}"
    moved = [
        f"the ratio of mode {mode} by {off:+.1f} cents"
        for mode, off in zip(dict.fromkeys(plan.wish.keep), near.off[1:])
        if abs(off) > REACHED
    ]
    return f"rasping within the limits of depth leads to {tone}, but moves {' and '.join(moved)}"


def directions(plan: RaspingPlan) -> list[str]:
    """What rasping can do to the tone where it can only do one thing, in words."""
    found = []
    for underneath, name in FACES:
        up, down = (plan.goes(underneath, way) for way in (True, False))
        if up != down:
            found.append(f"{name} rasping can only {'raise' if up else 'lower'} the tone")
        elif underneath and not plan.densities.underneath:
            found.append("a plane solid has no face underneath")
        elif not up:
            found.append(f"{name} there is no place to rasp: supports keep it, or --most is less than the mesh shows")
    up, down = (any(plan.goes(face, way) for face, _ in FACES) for way in (True, False))
    wanted_up = plan.wish.cents > 0.0
    if not plan.in_tune and not (up if wanted_up else down):
        way, other = ("up", "lower") if wanted_up else ("down", "raise")
        found.append(f"the tone has to go {way}, and rasping can only {other} it: begin with another blank")
    return found


def plan_as_json(plan: RaspingPlan, tone: str) -> dict[str, Any]:
    """The plan for programs; lengths in m, frequencies in Hz."""
    wish = plan.wish
    return {
        "tone": tone,
        "measured": wish.measured,
        "target": wish.target,
        "cents": wish.cents,
        "model": plan.model.tolist(),
        "factor": plan.factor,
        "adjusted": (plan.factor * plan.model).tolist(),
        "modes": [rank + 1 for rank in plan.ranks],
        "in_tune": plan.in_tune,
        "reached": plan.in_tune or bool(plan.ways),
        "only": directions(plan),
        "places": [_place_as_json(place) for place in plan.places],
        "left_out": plan.left_out,
        "ways": [_way_as_json(way) for way in plan.ways],
        "nearest": None if plan.nearest is None else _way_as_json(plan.nearest),
        "tolerances": plan.tolerances.as_json(),
        "solves": plan.solves,
    }


def _place_as_json(place: Place) -> dict[str, Any]:
    return {
        "where": place.where,
        "underneath": place.underneath,
        "ends": place.ends.tolist(),
        "length": place.length,
        "profile": place.profile,
        "cents_0.1_mm": (TENTH * place.cents).tolist(),
        "limit": place.limit,
    }


def _way_as_json(way: Way) -> dict[str, Any]:
    parts = [{**_place_as_json(place), "depth": float(depth)} for place, depth in zip(way.places, way.depths)]
    return {
        "name": way.name,
        "parts": parts,
        "linear": way.linear.tolist(),
        "solved": way.solved.tolist(),
        "off": way.off.tolist(),
        "volume": way.volume,
    }


def _print_places(plan: RaspingPlan) -> None:
    tones = [f"mode {rank + 1}" for rank in plan.ranks]
    heads = ("where", "from [mm]", "to [mm]", "length [mm]", "profile", *(f"{tone}: [cents]" for tone in tones))
    rows = [
        (
            place.where,
            *place.ends_in_millimetres,
            f"{1e3 * place.length:.0f}",
            place.profile,
            *(f"{TENTH * own:+.2f}" for own in place.cents),
        )
        for place in plan.places
    ]
    print_table("what 0.1 mm off does, where it is deepest", heads, rows, right=(heads[3], *heads[5:]))


def _print_ways(plan: RaspingPlan, ways: list[Way], title: str) -> None:
    ratios = [f"f{rank + 1}/f1: [cents]" for rank in plan.ranks[1:]]
    heads = ("way", "depth [mm]", "off [mm³]", "by derivatives", "by a solve", "missed by", *ratios)
    rows = []
    for way in ways:
        alike = len(way.places) == 1 or len({round(float(depth), 9) for depth in way.depths}) == 1
        depths = [f"{1e3 * depth:.2f}" for depth in way.depths]
        numbers = (f"{1e9 * way.volume:.0f}", f"{way.linear[0]:+.1f}", f"{way.solved[0]:+.1f}", f"{way.off[0]:+.2f}")
        rows.append((way.name, depths[0] if alike else "", *numbers, *(f"{own:+.1f}" for own in way.solved[1:])))
        if len(way.places) > 1:
            blank = [""] * (len(heads) - 2)
            rows += [(f"  {place.words}, {place.profile}", depth, *blank) for place, depth in zip(way.places, depths)]
    print_table(title, heads, rows, right=heads[1:])
