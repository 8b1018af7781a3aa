"""What is seen of heat in a scene of a fluid with its outline: its numbers, jumps of temperature, layers at walls."""

import numpy as np

from restshape.physics.heat.temperature_jumps import edge_temperatures, temperature_jumps
from restshape.physics.heated_flow.fluid_heat import heat_properties
from restshape.physics.heated_flow.heated_flow_conditions import given_temperatures
from restshape.physics.heated_flow.temperature_differences import differences, span
from restshape.physics.heated_flow.wall_layers import buoyant_layer, forced_layer, hidden_layers, is_stirred
from restshape.scene.model import Scene
from restshape.scene.physics import Inspection
from restshape.shape.outline import Outline

TURBULENT = 1e9
"""Rayleigh number of heated walls from which layers on them are turbulent."""


def inspect_heated_flow(scene: Scene, outline: Outline) -> Inspection:
    """Warnings of temperatures that jump and of layers that cells do not show; with buoyancy Ra and Pr."""
    on, given = frozenset(scene.effects), given_temperatures(scene)
    jumps = temperature_jumps(scene, outline, given) if "heat" in on else ()
    forced = forced_layer(scene, outline) if "flow" in on and differences(scene, on) else np.inf
    still = Inspection(warnings=(*jumps, *hidden_layers(scene, outline, forced)))
    if "buoyancy" not in on:
        if "gravity" in on:
            lifted = (
                "effects.gravity: without [effects.buoyancy] it moves no fluid, for pressures are those without weight"
            )
            still = Inspection(warnings=(*still.warnings, lifted))
        return still
    g, fluid = np.array(scene.effects["gravity"]["g"], dtype=float), scene.fluid
    size = float(np.linalg.norm(g))
    known = edge_temperatures(scene, outline, given)
    every = np.concatenate([*(values.ravel() for values in known.values()), span(scene, on)])
    low, high = float(every[every > 0.0].min(initial=np.inf)), float(every.max())
    if size == 0.0 or high <= low:
        return still
    places = np.concatenate([outline.polyline(edge) for edge in range(len(outline.edges))])
    capacity, conductivity = heat_properties(scene)
    viscosity, diffusivity = fluid.mu / fluid.rho, conductivity / capacity
    height = float(np.ptp(places @ g / size))
    rayleigh = size * fluid.expansion * (high - low) * height**3 / (viscosity * diffusivity)
    rows = [
        ("Rayleigh number", f"{rayleigh:.3g}, of the length along gravity and the largest difference given"),
        ("Prandtl number", f"{viscosity / diffusivity:.3g}"),
    ]
    what = f"at a Rayleigh number of {rayleigh:.3g} layers at walls are turbulent, for which there is no model"
    doubts = (f"{what}: cells would have to show the eddies",) if rayleigh > TURBULENT else ()
    stirred = is_stirred(outline, known, g / size, rayleigh)
    buoyant = buoyant_layer(height, rayleigh) if stirred else np.inf
    layers = hidden_layers(scene, outline, min(forced, buoyant))
    return Inspection({"rayleigh": rayleigh, "prandtl": viscosity / diffusivity}, rows, (*jumps, *doubts, *layers))
