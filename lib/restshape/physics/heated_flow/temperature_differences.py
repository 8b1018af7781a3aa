"""Whether any temperatures of a scene of a fluid differ: without a difference there is no heat to follow."""

from collections.abc import Iterator

from restshape.scene.derived_effects import On
from restshape.scene.expressions import Expression, Value
from restshape.scene.model import Scene
from restshape.scene.plain_values import Table, tables_in

ROOM = 293.15
"""A temperature [K] where a scene names none."""


def differences(scene: Scene, on: On) -> str:
    """What makes temperatures differ, for people; empty where nothing does, or heat is off."""
    if "heat" not in on:
        return ""
    causes = [key for key, value in _entering(scene) if isinstance(value, Expression) or value != 0.0]
    if causes:
        return f"heat enters by {', '.join(causes)}"
    known = dict(_temperatures(scene, on))
    formulas = [key for key, value in known.items() if isinstance(value, Expression)]
    if formulas:
        return f"{', '.join(formulas)}: a formula"
    if len(set(known.values())) < 2:
        return ""
    low, high = (pick(known, key=lambda key: known[key]) for pick in (min, max))
    return f"{high} is above {low}"


def span(scene: Scene, on: On) -> tuple[float, float]:
    """The lowest and the highest temperature [K] that the scene names as a number; equal where it names one at most."""
    known = [value for _, value in _temperatures(scene, on) if not isinstance(value, Expression)]
    return (min(known), max(known)) if known else (0.0, 0.0)


def initial(scene: Scene) -> float:
    """The temperature [K] at time 0, and that from which steady ones are looked for."""
    given = next((one for one in _initial(scene) if one is not None), None)
    if given is not None:
        return float(given)
    if scene.fluid.reference is not None:
        return float(scene.fluid.reference)
    return uniform(scene)


def neutral(scene: Scene) -> float:
    """The temperature [K] from which heat that fluid carries is counted: that which lifts nothing, else at time 0."""
    reference = scene.fluid.reference
    return initial(scene) if reference is None else float(reference)


def uniform(scene: Scene) -> float:
    """The temperature [K] that everything has where none differs: that of an edge, or the first one that is named."""
    known = [value for _, value in _prescribed(scene) if not isinstance(value, Expression)]
    known += [value for value in (*_initial(scene), scene.fluid.reference) if value]
    return float(known[0]) if known else ROOM


def unheated(raw: Table, _: On) -> Table:
    """The plain tables of a scene without [effects.heat], and without what says something of heat alone."""
    of_heat = ("temperature", "heat_flux", "insulated")
    boundary = {
        name: {key: value for key, value in table.items() if key not in of_heat}
        for name, table in tables_in(raw, "boundary").items()
    }
    effects = {name: one for name, one in tables_in(raw, "effects").items() if name != "buoyancy"}
    rest = {key: value for key, value in raw.items() if key != "heat"}
    return {**rest, "boundary": boundary, "effects": effects}


def _initial(scene: Scene) -> list[float | None]:
    """What effects say of the temperature at time 0 [K]."""
    return [scene.effects.get(name, {}).get("initial") for name in ("storage", "heat")]


def _prescribed(scene: Scene) -> Iterator[tuple[str, Value]]:
    for name, table in scene.boundary.items():
        if table.temperature is not None:
            yield f"boundary.{name}.temperature", table.temperature


def _entering(scene: Scene) -> Iterator[tuple[str, Value]]:
    for name, table in scene.boundary.items():
        if table.heat_flux is not None:
            yield f"boundary.{name}.heat_flux", table.heat_flux
    for name, table in scene.heat.items():
        yield f"heat.{name}.source", table.source


def _temperatures(scene: Scene, on: On) -> Iterator[tuple[str, Value]]:
    """Keys and values of all temperatures that matter."""
    yield from _prescribed(scene)
    if "buoyancy" in on and scene.fluid.reference is not None:
        yield "fluid.reference", scene.fluid.reference
    if "storage" in on or scene.effects.get("flow", {}).get("time_step") is not None:
        yield "effects.heat.initial", initial(scene)
