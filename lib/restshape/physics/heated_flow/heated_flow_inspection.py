"""What is seen of heat in a scene of a fluid with its outline: the numbers of Rayleigh and of Prandtl."""

import numpy as np

from restshape.physics.heated_flow.fluid_heat import heat_properties
from restshape.physics.heated_flow.temperature_differences import span
from restshape.scene.model import Scene
from restshape.scene.physics import Inspection
from restshape.shape.outline import Outline

TURBULENT = 1e9
"""Rayleigh number of heated walls from which layers on them are turbulent."""


def inspect_heated_flow(scene: Scene, outline: Outline) -> Inspection:
    """The Rayleigh number of the shape's length along gravity, and the Prandtl number; nothing without buoyancy."""
    on = frozenset(scene.effects)
    if "buoyancy" not in on:
        return Inspection()
    g, fluid = np.array(scene.effects["gravity"]["g"], dtype=float), scene.fluid
    size = float(np.linalg.norm(g))
    low, high = span(scene, on)
    if size == 0.0 or high == low:
        return Inspection()
    places = np.concatenate([outline.polyline(edge) for edge in range(len(outline.edges))])
    capacity, conductivity = heat_properties(scene)
    viscosity, diffusivity = fluid.mu / fluid.rho, conductivity / capacity
    rayleigh = size * fluid.expansion * (high - low) * float(np.ptp(places @ g / size)) ** 3 / (viscosity * diffusivity)
    rows = [
        ("Rayleigh number", f"{rayleigh:.3g}, of the length along gravity and the largest difference given"),
        ("Prandtl number", f"{viscosity / diffusivity:.3g}"),
    ]
    what = f"at a Rayleigh number of {rayleigh:.3g} layers at walls are turbulent, for which there is no model"
    doubts = (f"{what}: cells would have to show the eddies",) if rayleigh > TURBULENT else ()
    return Inspection({"rayleigh": rayleigh, "prandtl": viscosity / diffusivity}, rows, doubts)
