"""Corners at which two edges with different temperatures meet: heat that flows there has no limit as cells shrink.

And loads at edges whose temperature is fixed.
"""

from collections.abc import Iterator, Mapping

import numpy as np

from restshape.errors import ReplayProblem
from restshape.fem.nodal_values import Nodal
from restshape.scene.expressions import Value
from restshape.scene.model import Scene
from restshape.scene.physics import Inspection
from restshape.shape.outline import Outline

TIMES = (0.0, 0.5, 1.0)
"""At which temperatures that vary with the time are looked at [s]."""
CONTINUOUS = 1e-6
"""Part of the range of temperatures by which those of two edges may differ where they meet."""

Given = Mapping[str, tuple[str, Value]]
"""Of names of entities: where the scene gives their temperature, and which."""


def inspect_conduction(scene: Scene, outline: Outline) -> Inspection:
    """Warnings of a body that conducts heat: temperatures that jump between edges, and loads where they are fixed."""
    given = {
        on: (f"supports.{name}.fix.temperature", support.fix["temperature"])
        for name, support in scene.supports.items()
        if "temperature" in support.fix
        for on in support.on
    }
    return Inspection(warnings=(*temperature_jumps(scene, outline, given), *_idle_loads(scene, outline, given)))


def _idle_loads(scene: Scene, outline: Outline, given: Given) -> Iterator[str]:
    """A warning for each load on edges whose temperature is fixed: its heat changes no temperature."""
    fixed = {edge for on in given for edge in outline.entity(on).edges}
    for name, load in scene.loads.items():
        edges = {edge for on in load.on for edge in outline.entity(on).edges} if load.kind != "source" else set()
        if both := sorted(fixed & edges):
            names = ", ".join(repr(outline.edges[edge].name) for edge in both)
            what = f"loads.{name} changes no temperature at {names}, where a support fixes it"
            yield f"{what}; take out one of the two there"


def temperature_jumps(scene: Scene, outline: Outline, given: Given) -> tuple[str, ...]:
    """A warning for each corner at which temperatures jump between edges.

    Near one the temperature is linear in the angle between its edges, which is harmonic: the flux is the jump times the
    conductivity over angle and distance, whose integral along an edge has no limit at the corner.
    """
    values = edge_temperatures(scene, outline, given)
    if not values:
        return ()
    every = np.concatenate([*values.values()])
    allowed = CONTINUOUS * float(np.ptp(every))
    found = []
    for loop in outline.loops:
        for (edge, forward), (after, onward) in zip(loop.edges, (*loop.edges[1:], loop.edges[0])):
            if loop.kind == "region" or edge == after or not {edge, after} <= values.keys():
                continue
            before, behind = values[edge][-1 if forward else 0], values[after][0 if onward else -1]
            jump = float(np.abs(before - behind).max())
            if jump > allowed:
                names = " and ".join(repr(outline.edges[k].name) for k in (edge, after))
                what = f"the temperature jumps by {jump:.4g} K where {names} meet: heat flow and Nusselt number there"
                do = "let a formula join the two temperatures, or put an insulated edge between"
                found.append(f"{what} have no limit as cells become smaller; {do}")
    return tuple(dict.fromkeys(found))


def edge_temperatures(scene: Scene, outline: Outline, given: Given) -> dict[int, np.ndarray]:
    """The temperatures (m, times) [K] that the scene gives edges, along each from start to end.

    Edges whose formula has no number somewhere are left out: they are refused where it is used.
    """
    found = {}
    for on, (where, value) in given.items():
        for edge in outline.entity(on).edges:
            try:
                found[edge] = np.stack([*_along(scene, outline, edge, where, value)], axis=1)
            except ReplayProblem:
                continue
    return found


def _along(scene: Scene, outline: Outline, edge: int, where: str, value: Value) -> Iterator[np.ndarray]:
    # More points than an arc or a line needs to look right.
    places = outline.point(edge, np.linspace(0.0, 1.0, 33))
    for time in TIMES:
        yield Nodal(value, {**scene.parameters, "t": time}, where)(places)
