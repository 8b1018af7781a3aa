"""Layers of fluid at walls that heat passes: how thick they are, and whether cells are small enough to show them."""

from collections.abc import Mapping

import numpy as np

from restshape.arrays import Reals
from restshape.physics.flow.flow_conditions import edge_kinds
from restshape.physics.flow.reynolds import characteristic_length, stream
from restshape.physics.heated_flow.fluid_heat import heat_properties
from restshape.scene.model import Scene
from restshape.shape.outline import Outline

SHOWN = 0.8
"""Size of cells at a wall, over the thickness of its layer, from which heat may be off by a tenth and more."""


ONSET = 1708.0
"""Rayleigh number from which fluid between level walls moves that are heated from below: Lord Rayleigh; H. Jeffreys."""


def is_stirred(outline: Outline, temperatures: Mapping[int, Reals], gravity: Reals, rayleigh: float) -> bool:
    """Whether differences of temperature move a fluid: it stays at rest where all that is warm is above what is cold.

    Args:
        outline: of the fluid; gravity: (2,) of length 1, downwards.
        temperatures: (m, times) [K] of edges, as far as they are given.
        rayleigh: the Rayleigh number; below level walls that are warm it has to be above `ONSET`.
    """
    known = [(float(values.mean()), -(outline.polyline(edge) @ gravity)) for edge, values in temperatures.items()]
    if len({temperature for temperature, _ in known}) < 2:
        return True
    middle = 0.5 * (max(known, key=lambda one: one[0])[0] + min(known, key=lambda one: one[0])[0])
    warm = np.concatenate([heights for temperature, heights in known if temperature > middle])
    cold = np.concatenate([heights for temperature, heights in known if temperature <= middle])
    if warm.min() >= cold.max():
        return False
    return warm.max() > cold.min() or rayleigh > ONSET


def buoyant_layer(height: float, rayleigh: float) -> float:
    """The thickness [m] of the layer at a wall of this height [m], over which its heat is conducted.

    It is the height over the Nusselt number, 0.29 Ra^(1/4) for a square that is heated from one side: G. de Vahl Davis,
    Int. J. Numer. Meth. Fluids 3 (1983) 249. Where that is below 1 heat is conducted alone, and there is no layer.
    """
    nusselt = 0.29 * rayleigh**0.25
    return height / nusselt if nusselt > 1.0 else np.inf


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
    thick, cells = f"{_short(1e3 * layer, 2)} mm", f"{1e3 * size:.3g} mm"
    what = f"the warm or cold layer at {name} is about {thick} thick, and cells there are {cells}"
    return (
        f"{what}: heat may be off by a tenth and more; set mesh.near.{name} to {_short(1e3 * layer / 3, 1)} mm or so",
    )


def _short(number: float, digits: int) -> str:
    """A number of so many digits, without a power of ten where it is of usual size."""
    return f"{float(f'{number:.{digits}g}'):g}"
