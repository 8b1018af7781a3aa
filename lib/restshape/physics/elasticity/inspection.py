"""What an elastic scene and its outline show at a glance: the mass, values that no material has, singular places."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import pi, sqrt

import numpy as np

from restshape.errors import UserError
from restshape.mesh.entity_area import entity_area
from restshape.mesh.regions import contains, loop_polygon
from restshape.mesh.thickness import Thickness
from restshape.physics.elasticity.ground_record import read_record
from restshape.physics.elasticity.modal_effect import modal_keys
from restshape.physics.elasticity.motion_effects import DynamicsKeys
from restshape.physics.elasticity.singular_places import places_of_quantities, warning, worst_places
from restshape.physics.elasticity.thickness_layers import FLOOR, usual_layers
from restshape.scene.model import Material, Scene
from restshape.scene.physics import Inspection
from restshape.shape.outline import Outline

STIFFNESS = (1e3, 1.3e12)
"""Young's modulus [Pa] of the softest gels and of diamond."""
DENSITY = (1.0, 2.3e4)
"""Density [kg/m^3] of the lightest aerogels and of osmium."""
SPEED = (1.0, 2.0e4)
"""Speed of sound sqrt(E / rho) [m/s] in gels and in diamond.

Source of the orders of magnitude: M. F. Ashby, Materials Selection in Mechanical Design, 4th edition, 2011, chapter 4
(charts of modulus against density, from foams and elastomers to diamond and tungsten); its ends, gels, aerogels and
osmium, are rounded outwards.
"""
STEPS, LEAST_STEPS = 20, 10
"""Time steps a period below which a motion is off by more than 0.8 % in frequency, (w dt)^2 / 12, and not resolved."""
STATIC = {"solid", "large_deformation"}
"""Effects of bodies that nothing loads or moves but `[loads]` and `[supports]`."""
DRIVING = {"gravity", "ground"}
"""Effects that load a body, or set it in motion."""
GRID = 40
"""Places in each direction at which a thickness that varies is averaged."""


def inspect_solid(scene: Scene, outline: Outline) -> Inspection:
    """The mass of a plane solid, values that no material has, and quantities at singular places."""
    places = places_of_quantities(scene, outline)
    seen = inspect_body(scene, outline)
    warnings = [warning(name, scene.quantities[name], there) for name, there in places.items()]
    warnings = [*seen.warnings, *_unloaded(scene), *_reactions_of_nothing(scene, outline), *warnings]
    return Inspection(seen.data, seen.rows, tuple(warnings), *worst_places(places))


def _unloaded(scene: Scene) -> Iterator[str]:
    """That nothing loads a static body, or sets one in motion; what buckles has its own words."""
    prescribed = [value for support in scene.supports.values() for value in support.fix.values()]
    if scene.loads or any(value != 0 for value in prescribed) or scene.effects.keys() & DRIVING:
        return
    nothing = "loads: there is none, and no gravity and no prescribed displacement"
    if scene.effects.keys() <= STATIC:
        yield f"{nothing}: all answers are 0 until an edit sets one; add [loads.NAME] or [effects.gravity]"
    elif "dynamics" in scene.effects:
        yield f"{nothing}: nothing moves until an edit does; add [loads.NAME], [effects.gravity] or [effects.ground]"


def _reactions_of_nothing(scene: Scene, outline: Outline) -> Iterator[str]:
    """Reactions at rest where no support fixes their direction: these are 0."""
    if "dynamics" in scene.effects:
        return
    for name, quantity in scene.quantities.items():
        if quantity.kind != "reaction":
            continue
        axis = quantity.reaction
        places = [on for support in scene.supports.values() if axis in support.fix for on in support.on]
        if not any(_meet(outline, quantity.at, on) for on in places):
            yield (
                f"quantities.{name}: no support that fixes {axis} is at {quantity.at}: the reaction there is 0 until "
                "an edit adds one; name the place of a support"
            )


def _meet(outline: Outline, one: str | None, other: str) -> bool:
    """Whether two entities have a vertex or an edge in common, or one covers an area."""
    if one in (None, "all") or other == "all":
        return True
    nodes = []
    for entity in (outline.entity(one), outline.entity(other)):
        if any(outline.loops[loop].kind == "region" for loop in entity.loops):
            return True
        ends = (end for e in entity.edges for end in (outline.edges[e].start, outline.edges[e].end))
        nodes.append({*entity.vertices, *ends})
    return bool(nodes[0] & nodes[1])


def inspect_motion(scene: Scene, outline: Outline) -> Inspection:
    """What `inspect_solid` sees, and the record of the base excitation."""
    seen, ground = inspect_solid(scene, outline), scene.effects.get("ground", {})
    time_step = scene.effects.get("dynamics", {}).get("time_step", DynamicsKeys().time_step)
    if ground.get("file") is None:
        return replace(seen, warnings=(*seen.warnings, *_coarse_steps(ground.get("frequency"), time_step)))
    record = read_record(scene.folder / ground["file"])
    last, peak = float(record.times[-1] - record.times[0]), abs(ground["scale"]) * record.peak
    data = {"ground": {"samples": len(record.times), "step": record.step, "duration": last, "peak": peak}}
    text = f"{ground['file']}: {len(record.times)} samples over {last:.6g} s, at most {peak:.4g} m/s^2"
    warnings = seen.warnings
    if time_step > 1.001 * record.step:
        what = (
            f"effects.dynamics.time_step = {time_step:g} s passes over samples of the record, {record.step:g} s apart"
        )
        warnings = (*warnings, f"{what}: a time step of {record.step:g} s sees them all")
    rows = [*seen.rows, ("ground motion", text)]
    return replace(seen, data=seen.data | data, rows=rows, warnings=warnings)


def _coarse_steps(frequency: float | None, time_step: float) -> Iterator[str]:
    """Time steps that are long beside the period of a harmonic base excitation."""
    if frequency is None:
        return
    steps = 1.0 / (frequency * time_step)
    if steps < STEPS:
        share = (2.0 * pi / steps) ** 2 / 12.0
        off = f"is off by about {100.0 * share:.2g} % in frequency" if steps > LEAST_STEPS else "is not resolved"
        fine = 1.0 / (STEPS * frequency)
        yield (
            f"effects.dynamics.time_step = {time_step:g} s takes {steps:.3g} steps a period of the ground's "
            f"{frequency:g} Hz: a motion of that frequency {off}: a time step of {fine:.2g} s takes {STEPS}"
        )


def inspect_body(scene: Scene, outline: Outline) -> Inspection:
    """The mass of a body, and values that no material has or no plate."""
    warnings = [text for name, material in scene.material.items() for text in _doubts(name, material, outline)]
    mass = sum(_mass(scene, name, outline) for name in scene.material)
    if not mass:
        return Inspection(warnings=tuple(warnings))
    return Inspection({"mass": mass}, [("mass", f"{mass:.6g} kg")], tuple(warnings))


def inspect_vibrating(scene: Scene, outline: Outline) -> Inspection:
    """The mass of a body that vibrates, values that no material has, and its layers of tetrahedra."""
    seen = inspect_body(scene, outline)
    if modal_keys(scene).model != "solid":
        return seen
    usual, named = usual_layers(scene, outline), scene.mesh.layers
    layers = named or usual.count
    words = f"{layers}: {'mesh.layers says so' if named else usual.why}"
    floor = usual.floor(layers)
    stiff = (
        f"mesh.layers: with {layers} layer{'s' * (layers > 1)} the highest modes come out up to {100.0 * floor:.2g} % "
        f"too high, however fine the mesh, for {usual.why}: leave it out to have {usual.count}"
    )
    warnings = (*seen.warnings, stiff) if floor > FLOOR else seen.warnings
    return Inspection(seen.data | {"layers": layers}, [*seen.rows, ("layers", words)], warnings)


def _doubts(name: str, material: Material, outline: Outline) -> Iterator[str]:
    """What is odd in a material."""
    moduli = [material.E] if material.orthotropic is None else material.orthotropic.E
    odd = [E for E in moduli if not STIFFNESS[0] <= E <= STIFFNESS[1]]
    for E in odd:
        yield (
            f"material.{name}: a stiffness of {E:g} Pa is that of no material (gels {STIFFNESS[0]:g}, rubber 1e6, "
            "wood 1e10, steel 2e11, diamond 1.2e12): is its unit right?"
        )
    rho = material.rho
    if rho and not DENSITY[0] <= rho <= DENSITY[1]:
        yield (
            f"material.{name}: a density of {rho:g} kg/m^3 is that of no material (aerogels {DENSITY[0]:g}, wood 500, "
            "water 1000, steel 7850, osmium 22600): is its unit right?"
        )
    elif rho and not odd and not SPEED[0] <= (speed := sqrt(max(moduli) / rho)) <= SPEED[1]:
        yield (
            f"material.{name}: with this stiffness and density sound goes at {speed:g} m/s, which it does in no "
            "material (rubber 50, steel 5000, diamond 18000): are their units right?"
        )
    size = float(np.max(np.subtract(*outline.bounds()[::-1])))
    given = "thickness" in material.model_fields_set
    if given and isinstance(material.thickness, int | float) and material.thickness > size:
        yield (
            f"material.{name}: the thickness of {material.thickness:g} m is more than the {size:.3g} m of the "
            "whole shape: is its unit right?"
        )


def _mass(scene: Scene, name: str, outline: Outline) -> float:
    """The mass [kg] of a material of a scene on an outline; formulas of the thickness are averaged at places."""
    material = scene.material[name]
    if not material.rho:
        return 0.0
    areas = sum(_area(outline, region) for region in material.region or [])
    if material.region is None:
        used = {region for one in scene.material.values() for region in one.region or []}
        areas = float(outline.area()) - sum(_area(outline, region) for region in used)
    return float(material.rho) * areas * _mean_thickness(scene, material, outline)


def _area(outline: Outline, region: str) -> float:
    try:
        return entity_area(outline, region)
    except UserError:
        # Regions of a mesh file are known by their cells alone.
        return 0.0


def _mean_thickness(scene: Scene, material: Material, outline: Outline) -> float:
    if isinstance(material.thickness, int | float):
        return float(material.thickness)
    low, high = outline.bounds()
    axes = (a + (np.arange(GRID) + 0.5) / GRID * (b - a) for a, b in zip(low, high))
    places = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    inside = places[contains(loop_polygon(outline, outline.loops[0]), places)]
    return float(np.mean(Thickness(material.thickness, scene.parameters).at(inside)))
