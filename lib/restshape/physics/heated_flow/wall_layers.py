"""Layers of fluid at walls that heat passes: how thick they are, and whether cells are small enough to show them."""

import numpy as np

from restshape.physics.flow.flow_conditions import edge_kinds
from restshape.physics.flow.reynolds import characteristic_length, stream
from restshape.physics.heated_flow.fluid_heat import heat_properties
from restshape.scene.model import Scene
from restshape.shape.outline import Outline

SHOWN = 0.8
"""Size of cells at a wall, over the thickness of its layer, from which heat may be off by a tenth and more."""


def buoyant_layer(height: float, rayleigh: float) -> float:
    """The thickness [m] of the layer at a wall of this height [m], over which its heat is conducted.

    It is the height over the Nusselt number, 0.29 Ra^(1/4) for a square that is heated from one side: G. de Vahl Davis,
    Int. J. Numer. Meth. Fluids 3 (1983) 249.
    """
    return height / (0.29 * rayleigh**0.25)


def forced_layer(scene: Scene, outline: Outline) -> float:
    """The same [m] below the fastest stream that edges are given; infinite where there is none.

    Of a channel it is Leveque's: M. A. Leveque, Annales des Mines 13 (1928), with four times the speed over the width
    as the velocity's slope at the wall. Bodies in the stream are as long as they are wide.
    """
    speed, along, _ = stream(scene, outline)
    if speed == 0.0:
        return np.inf
    capacity, conductivity = heat_properties(scene)
    width, _ = characteristic_length(scene, outline, along)
    places = np.concatenate([outline.polyline(edge) for edge in range(len(outline.edges))])
    around = any(loop.kind == "hole" for loop in outline.loops)
    length = width if around or not along.any() else float(np.ptp(places @ along) / np.linalg.norm(along))
    return 1.24 * (conductivity / capacity * length * width / (4.0 * speed)) ** (1.0 / 3.0)


def hidden_layers(scene: Scene, outline: Outline, layer: float) -> tuple[str, ...]:
    """A warning of the wall with the largest cells beside its layer [m]; of none where all cells show it.

    Walls are those at which a table gives a temperature or a heat flux.
    """
    if scene.mesh.size is None or not np.isfinite(layer):
        return ()
    kinds = edge_kinds(scene, outline)
    near = [(set(outline.entity(name).edges), float(size)) for name, size in scene.mesh.near.items()]
    found = []
    for table in scene.boundary.values():
        if table.temperature is None and table.heat_flux is None:
            continue
        for on in table.on:
            walls = [edge for edge in outline.entity(on).edges if kinds[edge][0] in ("wall", "slip")]
            sizes = [min([float(scene.mesh.size), *(h for of, h in near if edge in of)]) for edge in walls]
            if sizes and max(sizes) > SHOWN * layer:
                found.append((max(sizes), on))
    if not found:
        return ()
    size, name = max(found)
    what = (
        f"the warm or cold layer at {name} is about {1e3 * layer:.2g} mm thick, and cells there are {1e3 * size:.3g} mm"
    )
    return (f"{what}: heat may be off by a tenth and more; set mesh.near.{name} to {1e3 * layer / 3:.1g} mm or so",)
