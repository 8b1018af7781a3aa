"""Bodies that conduct heat and fluids that carry it, at random, steady or in time."""

from typing import Any

from hypothesis import strategies as st
from restshape_studies.stability.plane_strategies import head, meshes, tolerances
from restshape_studies.stability.random_scenes import ON_DEMAND, Parts, RandomScenes, edits_with
from restshape_studies.stability.shape_strategies import Table, entities, numbers, shapes, sides
from restshape_verification.flow import random_scenes as fluids


@st.composite
def conductors(draw: st.DrawFn, shape: Table, stores: bool) -> Table:
    """The [material] of a shape, its region of another one; at times one that stores nothing though it should."""

    def one() -> Table:
        found = {"conductivity": draw(st.sampled_from([50.0, 1e-3, 400.0, "50 + k"]))}
        if stores:
            found |= {"rho": draw(st.sampled_from([2700.0, 1.0])), "specific_heat": 900.0}
            found["specific_heat"] = draw(st.sampled_from([900.0] * 9 + [0.0]))
        if draw(st.booleans()):
            found["thickness"] = draw(st.sampled_from([0.01, 1e-4]))
        return found

    bodies = {"m": one()}
    bodies["m"]["conductivity"] = draw(st.sampled_from([50.0, 1e-3, 400.0]))
    if "regions" in shape and draw(st.booleans()):
        bodies["inner"] = {**one(), "conductivity": 0.1, "region": ["patch"]}
    return bodies


@st.composite
def heated(draw: st.DrawFn, shape: Table) -> Table:
    """The [loads]: sources, fluxes and convection, weak ones and such as melt anything."""
    found = {}
    for k in range(draw(st.sampled_from([1, 2, 2, 3, 0]))):
        kind = draw(st.sampled_from(["source", "flux", "convection"]))
        size = draw(st.sampled_from([1.0, 1e3, -1e3, 1e7]))
        value: Any = draw(st.sampled_from([size, f"{size!r}*x", f"{size!r}*(1 + k*y)"]))
        if kind == "convection":
            film = draw(st.sampled_from([25.0, 1e4, 0.0, "25 + 10*x*x"]))
            value = {"film": film, "ambient": draw(st.sampled_from([293.15, "20 degC", "300 + 10*x"]))}
        on = ["all", *shape.get("regions", {})] if kind == "source" else sides(shape)
        found[f"l{k}"] = {"on": draw(st.sampled_from(on)), kind: value}
    return found


@st.composite
def temperatures(draw: st.DrawFn, shape: Table) -> Table:
    """The [supports]: mostly one that holds an edge at a temperature, at times none."""
    found = {}
    for k in range(draw(st.sampled_from([1, 1, 1, 1, 2, 0]))):
        on = draw(st.sampled_from([*shape.get("holes", {}), "e2", "p3"] if k else ["e1", "outline"]))
        value = draw(st.sampled_from([293.15, "60 degC", "300 + 20*y", 0.0]))
        found[f"s{k}"] = {"on": on, "fix": {"temperature": value}}
    return found


@st.composite
def storage(draw: st.DrawFn) -> Table:
    """The [effects]: none, or the temperature in time."""
    if draw(st.booleans()):
        return {}
    found = {"time_step": draw(st.sampled_from([1.0, 1e-3, 1e4])), "steps": draw(st.integers(1, 4))}
    found |= draw(st.sampled_from([{}, {"theta": 0.5}, {"theta": 0.7}, {"capacity": "lumped"}]))
    return {"storage": {**found, "initial": draw(st.sampled_from([293.15, "20 degC", 1000.0]))}}


@st.composite
def quantities(draw: st.DrawFn, shape: Table) -> Table:
    """The [quantities] of heat."""
    found: Table = {"area": {"area": True}, "edge": {"heat_flow": True, "at": draw(st.sampled_from(sides(shape)))}}
    reduce = draw(st.sampled_from(["mean", "max", "min", "absmax"]))
    found["there"] = {"temperature": True, "at": draw(st.sampled_from(entities(shape))), "reduce": reduce}
    if draw(st.booleans()):
        found["hottest"] = {"temperature": True, "reduce": "max", "max": draw(st.sampled_from(["40 degC", 1e9]))}
    return found


@st.composite
def bodies(draw: st.DrawFn) -> Table:
    """The tables of a scene of a body that conducts heat."""
    shape, area = draw(shapes())
    effects = draw(storage())
    scene = head("thermal", draw(numbers(-0.2, 0.2))) | {"shape": shape, "effects": effects}
    scene["material"] = draw(conductors(shape, bool(effects)))
    scene |= {"supports": draw(temperatures(shape)), "loads": draw(heated(shape))}
    scene["mesh"] = draw(meshes(area, effects))
    scene["solve"] = {"tolerance": draw(tolerances)}
    scene["quantities"] = draw(quantities(shape))
    return scene


def edits(scene: Table) -> Parts:
    """Edits of a scene of heat: its shape, and other values for its keys, not always such as suit them."""
    if "fluid" in scene:
        return fluids.edits(scene)
    size = scene["mesh"]["size"]
    keys: dict[str, list[Any]] = {
        "material.m.conductivity": [1.0, "400 W/(m K)", 0.0],
        "material.m.rho": [0, 1, 1e4],
        "material.m.specific_heat": [0.0, 500.0],
        "parameters.k": [0.0, 0.1, -3.0],
        "mesh.size": [1.3 * size, 2 * size, 10.0],
        "mesh.order": [1, 2],
        "solve.tolerance": [1e-2, 1e-10],
        "supports.s0.fix": [{"temperature": 350.0}, ["temperature"], ["x"]],
        "supports.s0.on": ["e2", "outline", "p1"],
        "effects.storage.steps": [1, 3],
        "effects.storage.time_step": [0.1, 10.0],
        "effects.storage.theta": [0.5, 1.0, 0.2],
    }
    for name, load in scene["loads"].items():
        kind = next(key for key in load if key != "on")
        if kind == "convection":
            keys[f"loads.{name}.convection.film"] = [0.0, 100.0, -1.0]
        else:
            keys[f"loads.{name}.{kind}"] = [0.0, 1e3, "k"]
    pairs = [(key, value) for key, values in keys.items() for value in values]
    values = st.sampled_from(pairs).map(lambda pair: [{"do": "set", "key": pair[0], "value": pair[1]}])
    return edits_with(scene, values)


def predictable(scene: Table) -> bool:
    """Whether frames of a scene can be predicted: steady ones."""
    return fluids.predictable(scene) if "fluid" in scene else not scene["effects"]


SCENES = RandomScenes(
    st.one_of(bodies(), fluids.scenes("thermal")), edits, heads=(*({},) * 9, ON_DEMAND), predictable=predictable
)
