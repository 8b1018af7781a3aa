"""Fluids at random, steady or in time, with or without heat: streams, vessels, rotors, and what makes no sense."""

from math import hypot
from typing import Any

from hypothesis import strategies as st
from restshape_studies.stability.plane_strategies import head, meshes, tolerances
from restshape_studies.stability.random_scenes import ON_DEMAND, Parts, RandomScenes, edits_with
from restshape_studies.stability.shape_strategies import Table, entities, numbers, shapes, sides

SPEEDS = st.sampled_from([1.0, 1.0, 0.1, 1e-6, 30.0, 0.0])
TURNING = ["{speed!r}*(0 - y)", "{speed!r}*x"]
"""Velocity of a body that turns about the origin: as much enters a closed border as leaves it."""


def entering(shape: Table, speed: float) -> list[Any]:
    """The velocity by which a fluid enters by the first edge, at right angles to the line between its ends [m/s]."""
    (ax, ay), (bx, by) = (shape["vertices"][name] for name in ("p1", "p2"))
    size = speed / hypot(bx - ax, by - ay)
    return [round(size * (ay - by), 9), round(size * (bx - ax), 9)]


@st.composite
def boundaries(draw: st.DrawFn, shape: Table, in_time: bool) -> Table:
    """The [boundary.NAME] of a shape: mostly a stream that enters and leaves, else a vessel that is turned."""
    speed, kind = draw(SPEEDS), draw(st.sampled_from(["stream"] * 8 + ["vessel", "vessel", "rotor", "rotor", "odd"]))
    turning = [form.format(speed=speed) for form in TURNING]
    if kind == "rotor" and "holes" in shape:
        return {"b0": {"on": "window", "velocity": ["0 - " + turning[0], f"{-speed!r}*(x + 0.1)"]}}
    if kind in ("vessel", "rotor"):
        return {"b0": {"on": "outline", "velocity": turning}}
    velocity = entering(shape, speed)
    if in_time and draw(st.booleans()):
        velocity = [f"({part!r})*{draw(st.sampled_from(['t', 'sin(9*t)', '(1 + k*y)']))}" for part in velocity]
    found: Table = {"b0": {"on": "e1", "velocity": velocity}}
    if kind == "stream" or draw(st.booleans()):
        found["b1"] = {"on": draw(st.sampled_from([["e3"], ["e2"], ["e2", "e3"]])), "outflow": True}
    others = [*shape.get("holes", {}), *list(shape["edges"])[3:]]
    if others and draw(st.booleans()):
        on = draw(st.sampled_from([*others * 10, "e2", "p1"]))
        found["b2"] = {"on": on, draw(st.sampled_from(["wall", "slip", "slip"])): True}
    return found


@st.composite
def fluids(draw: st.DrawFn, hot: bool) -> Table:
    """The [fluid]: from syrup to one whose Reynolds number is above 1,000; some that are known."""
    if draw(st.integers(0, 4)) == 0:
        found: Table = {"name": draw(st.sampled_from(["air", "water", "glycerin"]))}
    else:
        found = {"rho": draw(st.sampled_from([1.0, 1000.0])), "mu": draw(st.sampled_from([0.01, 0.1, 1.0, 1e-4, 1e-9]))}
        if hot and draw(st.integers(0, 9)):
            found |= draw(
                st.sampled_from(
                    [{"diffusivity": 0.01}, {"conductivity": 0.5, "heat_capacity": 1e3}, {"diffusivity": 1e-6}]
                )
            )
        if hot and draw(st.integers(0, 9)):
            found["expansion"] = draw(st.sampled_from([3e-3, 0.1, 0.0]))
    if hot and draw(st.integers(0, 9)):
        found["reference"] = draw(st.sampled_from([293.15, "20 degC"]))
    return found


@st.composite
def flow_effects(draw: st.DrawFn, hot: bool) -> Table:
    """The [effects]: steady or in time, with or without inertia and heat."""
    steady = draw(st.booleans())
    flow: Table = draw(st.sampled_from([{}, {"steady": True}]))
    if not steady:
        flow = {"time_step": draw(st.sampled_from([0.05, 1e-3, 2.0, 1e-8])), "steps": draw(st.integers(1, 3))}
        flow |= draw(st.sampled_from([{}, {}, {"scheme": "backward_euler"}, {"carry": "ale"}, {"carry": "remap"}]))
    found: Table = {"flow": flow}
    if draw(st.integers(0, 4)):
        found["convection"] = {}
    if hot:
        found["heat"] = draw(st.sampled_from([{}, {"coupling": "split"}, {"initial": 300.0}]))
        if draw(st.integers(0, 3)):
            found |= {"buoyancy": {}, "gravity": {"g": draw(st.sampled_from([[0.0, -9.81], [0.0, -1e-3], [1.0, 1.0]]))}}
    return found


@st.composite
def quantities(draw: st.DrawFn, shape: Table, hot: bool) -> Table:
    """The [quantities] of flow, and of heat."""
    side, place = st.sampled_from(sides(shape)), st.sampled_from(entities(shape))
    walls = st.sampled_from([*shape.get("holes", {}), "e1"] * 10 + sides(shape))
    of = {"speed": 1.0, "length": 0.2}
    kinds = [
        {"drag": True, "at": draw(walls)},
        {"lift": True, "at": draw(walls), "max": 1.0},
        {"lift_coefficient": of, "at": draw(walls)},
        {"strouhal": of, "at": draw(walls)},
        {"pressure": True, "at": draw(place), "reduce": draw(st.sampled_from(["max", "mean"]))},
        {"pressure_drop": {"from": draw(place), "to": draw(place)}},
        {"flux": True, "at": draw(side)},
        {"speed": True, "reduce": draw(st.sampled_from(["max", "mean"]))},
        {"kinetic": True},
    ]
    if hot:
        kinds += [
            {"temperature": True, "at": draw(place), "reduce": draw(st.sampled_from(["max", "min", "mean"]))},
            {"heat_flow": True, "at": draw(side)},
            {"nusselt": {"length": 1.0, "difference": draw(st.sampled_from([10.0, "1 K"]))}, "at": draw(side)},
            {"nusselt": {"length": 1.0, "against": draw(st.sampled_from(["all", draw(side)]))}, "at": draw(side)},
            {"bulk_temperature": True, "at": draw(side)},
        ]
    chosen = draw(st.lists(st.integers(0, len(kinds) - 1), min_size=1, max_size=5, unique=True))
    return {"area": {"area": True}} | {f"q{k}": kinds[k] for k in chosen}


@st.composite
def warmed(draw: st.DrawFn, scene: Table) -> Table:
    """A scene of a fluid with temperatures, fluxes and sources."""
    shape, tables = scene["shape"], scene["boundary"]
    for table in tables.values():
        warm = st.sampled_from([{}, {"temperature": 300.0}, {"temperature": "20 degC"}, {"temperature": "300 + 9*y"}])
        table |= draw(warm)
    if draw(st.integers(0, 5)) and not any(
        "window" in table["on"] or "outline" in table["on"] for table in tables.values()
    ):
        rest = [*shape.get("holes", {}), *list(shape["edges"])[3:]]
        if rest and not any(table["on"] in rest for table in tables.values()):
            own = draw(st.sampled_from([{"temperature": 310.0}, {"heat_flux": 50.0}, {"insulated": True}]))
            tables["b3"] = {"on": draw(st.sampled_from(rest)), "wall": True, **own}
    if draw(st.integers(0, 2)) == 0:
        on = draw(st.sampled_from(["all", *shape.get("regions", {})]))
        scene["heat"] = {"h0": {"on": on, "source": draw(st.sampled_from([100.0, "10*x", 1e7]))}}
    return scene


@st.composite
def scenes(draw: st.DrawFn, app: str = "flow") -> Table:
    """The tables of a scene of a fluid, with heat where its application has that."""
    shape, area = draw(shapes())
    hot = app != "flow"
    effects = draw(flow_effects(hot))
    scene = head(app, draw(numbers(-0.2, 0.2))) | {"shape": shape, "effects": effects, "fluid": draw(fluids(hot))}
    scene["boundary"] = draw(boundaries(shape, "time_step" in effects["flow"]))
    if hot:
        scene = draw(warmed(scene))
    mesh = draw(meshes(area, {}))
    if draw(st.integers(0, 19)):
        mesh.pop("order", None)
    scene |= {"mesh": mesh, "solve": {"tolerance": draw(tolerances)}, "quantities": draw(quantities(shape, hot))}
    return scene


def edits(scene: Table) -> Parts:
    """Edits of a scene of a fluid: its shape, and other values for its keys, not always such as suit them."""
    size = scene["mesh"]["size"]
    keys: dict[str, list[Any]] = {
        "fluid.mu": [0.01, 1.0, 1e-6, 0.0, "1 mPa s"],
        "fluid.rho": [1.0, 1000.0, -1.0],
        "fluid.depth": [0.1, "2 m"],
        "boundary.b0.velocity": [[0.0, 0.0], [1.0, 0.0], ["0 - y", "x"], ["k*t", 0.0]],
        "boundary.b0.on": ["e2", "outline", "window"],
        "parameters.k": [0.0, 0.1, -3.0],
        "mesh.size": [1.3 * size, 2 * size, 10.0],
        "solve.tolerance": [1e-2, 1e-10],
        "effects.flow.steps": [1, 3],
        "effects.flow.time_step": [1e-3, 0.2, 50.0],
        "effects.flow.scheme": ["bdf2", "backward_euler"],
        "effects.flow.carry": ["ale", "remap", "auto"],
        "effects.convection": [{}],
    }
    if "heat" in scene["effects"]:
        keys |= {
            "fluid.expansion": [0.0, 1.0],
            "fluid.diffusivity": [1e-3, 0.0],
            "boundary.b0.temperature": [310.0, "5 degC", "1 K"],
            "effects.gravity.g": [[0.0, 0.0], [0.0, -100.0]],
            "effects.heat.coupling": ["split", "monolithic"],
        }
    pairs = [(key, value) for key, values in keys.items() for value in values]
    values = st.sampled_from(pairs).map(lambda pair: [{"do": "set", "key": pair[0], "value": pair[1]}])
    return edits_with(scene, values)


def predictable(scene: Table) -> bool:
    """Whether frames of a scene can be predicted: steady ones."""
    return "time_step" not in scene["effects"]["flow"]


SCENES = RandomScenes(scenes(), edits, heads=(*({},) * 9, ON_DEMAND), predictable=predictable)
