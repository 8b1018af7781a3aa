"""What models alone cannot check of heat in a fluid."""

from restshape.physics.heated_flow.temperature_differences import differences
from restshape.scene.expressions import Expression
from restshape.scene.load_kind import AREAS, ENTITIES, any_of
from restshape.scene.model import Scene
from restshape.scene.source import Source, name_suggestion
from restshape.scene.values import RESERVED

OF_HEAT = ("temperature", "heat_flow", "nusselt", "area")
"""Kinds of quantities that a fluid has which does not flow."""
BY_WATT = "it is counted in W, and the fluid has a diffusivity alone"


def check_heated_flow(scene: Scene, source: Source) -> None:
    """Refuses heat without what it needs, buoyancy without gravity, expansion or reference, and sources nowhere.

    Raises:
        UserError: the first of them.
    """
    if not {"flow", "heat"} & set(scene.effects):
        do = "name one of them: flow = { steady = true }, or heat = {}"
        raise source.error(("effects",), "neither flow nor heat is on, so that nothing is simulated", do)
    if "storage" in scene.effects and ("flow" in scene.effects or "heat" not in scene.effects):
        do = "leave it out: a flow in time has a time_step, and heat without flow is in time with it"
        raise source.error(("effects", "storage"), "this is of heat in a fluid that does not flow", do)
    if "heat" in scene.effects:
        _check_heat(scene, source)
    else:
        _refuse_without_heat(scene, source)
    if "buoyancy" in scene.effects:
        _check_buoyancy(scene, source)
    for name, one in scene.quantities.items():
        if "flow" not in scene.effects and one.kind not in OF_HEAT:
            what = f"a {one.kind.replace('_', ' ')} is of a flow, and flow is off"
            raise source.error(("quantities", name), what, "add [effects.flow], or take it out")
    _check_places(scene, source)


def _check_heat(scene: Scene, source: Source) -> None:
    fluid, in_time = scene.fluid, scene.effects.get("flow", {}).get("time_step") is not None
    if fluid.diffusivity is None and (fluid.conductivity is None or fluid.heat_capacity is None):
        do = 'give conductivity and heat_capacity, such as "0.026 W/(m K)" and "1006 J/(kg K)", or diffusivity'
        raise source.error(("fluid",), "heat needs to know how the fluid conducts it and takes it up", do)
    if fluid.conductivity is None:
        counted = [("boundary", name, "heat_flux") for name, one in scene.boundary.items() if one.heat_flux is not None]
        counted += [("heat", name) for name in scene.heat]
        counted += [("quantities", name) for name, one in scene.quantities.items() if one.kind == "heat_flow"]
        for place in counted:
            raise source.error(place, f"this needs the conductivity: {BY_WATT}", "give fluid.conductivity besides")
    for name, one in scene.boundary.items():
        for key in ("temperature", "heat_flux"):
            value = getattr(one, key)
            if isinstance(value, Expression) and "t" in value.names and not in_time:
                what = f"{value.text!r} depends on the time t, and the temperature is steady"
                raise source.error(("boundary", name, key), what, "add a time_step to [effects.flow]")
    prescribed = any(one.temperature is not None for one in scene.boundary.values())
    if not (in_time or prescribed or "storage" in scene.effects) and differences(scene, frozenset(scene.effects)):
        what = "nothing holds the temperature: no edge has one, and it is steady"
        raise source.error(("boundary",), what, 'give one, as in temperature = "20 degC", or a time_step')


def _refuse_without_heat(scene: Scene, source: Source) -> None:
    do = "add [effects.heat], or take it out"
    for name, one in scene.boundary.items():
        for key in ("temperature", "heat_flux"):
            if getattr(one, key) is not None:
                raise source.error(("boundary", name, key), "heat is off, so that this says nothing", do)
    for name in scene.heat:
        raise source.error(("heat", name), "heat is off, so that this says nothing", do)
    if "buoyancy" in scene.effects:
        raise source.error(("effects", "buoyancy"), "buoyancy comes from heat, and heat is off", "add [effects.heat]")


def _check_buoyancy(scene: Scene, source: Source) -> None:
    if "flow" not in scene.effects:
        do = "add [effects.flow], or take it out"
        raise source.error(("effects", "buoyancy"), "buoyancy moves a fluid, and flow is off", do)
    if "gravity" not in scene.effects:
        do = 'add gravity = { g = [0, "-9.81 m/s^2"] } to [effects]'
        raise source.error(("effects", "buoyancy"), "buoyancy needs gravity, which the scene does not have", do)
    for key, example in (("expansion", "3.4e-3 1/K"), ("reference", "20 degC")):
        if getattr(scene.fluid, key) is None:
            what = f"buoyancy needs fluid.{key}, which the scene does not have"
            raise source.error(("fluid", key), what, f'give it, such as {key} = "{example}"')


def _check_places(scene: Scene, source: Source) -> None:
    if scene.shape.file or scene.mesh.file:
        return
    kinds = scene.shape.kinds()
    for name, one in scene.quantities.items():
        if one.kind == "nusselt" and one.nusselt.against not in (None, *RESERVED, *kinds):
            do = name_suggestion(one.nusselt.against, sorted(kinds), RESERVED)
            what = f"there is no entity {one.nusselt.against!r}"
            raise source.error(("quantities", name, "nusselt", "against"), what, do)
    for name, one in scene.heat.items():
        for at in one.on:
            if at not in kinds:
                do = name_suggestion(at, sorted(kinds), RESERVED)
                raise source.error(("heat", name, "on"), f"there is no entity {at!r}", do)
            if kinds[at] not in AREAS:
                what = f"no heat is set free in {at!r}, which is {ENTITIES[kinds[at]]}"
                raise source.error(("heat", name, "on"), what, f"name {any_of(AREAS)}")
