"""The Reynolds number of a scene of flow, with the length that it is of, and numbers of its cells and steps."""

from typing import NamedTuple

import numpy as np

from restshape.errors import UserError
from restshape.physics.flow.flow_conditions import border_velocities
from restshape.scene.model import Scene
from restshape.shape.outline import Outline

FRAMES = np.unique(np.concatenate([np.arange(21), np.geomspace(20, 1000, 40).round()]))
"""Frames at whose times velocities that vary with the time are looked at."""
SOON = 100
"""Frames of which the largest speed is taken."""


class Stream(NamedTuple):
    """The fastest stream that edges are given.

    Args:
        speed: [m/s].
        along: (2,) its mean direction; 0 where there is none.
        time: at which it is there [s].
    """

    speed: float
    along: np.ndarray
    time: float


def looked_at(scene: Scene) -> np.ndarray:
    """Times [s] at which a scene is looked at before there is a flow; only 0 of a steady one."""
    settings = scene.effects.get("flow", {})
    return FRAMES * settings["time_step"] * settings.get("steps", 1) if settings.get("time_step") else np.zeros(1)


def stream(scene: Scene, outline: Outline) -> Stream:
    """The fastest one in the first 100 frames, or until a formula has no number."""
    found = Stream(0.0, np.zeros(2), 0.0)
    for _, time in zip(FRAMES[FRAMES <= SOON], looked_at(scene)):
        try:
            given = [*border_velocities(scene, outline, time)]
        except UserError:
            # The frame will say why it is refused.
            break
        velocities = np.concatenate([*given, np.zeros((1, 2))])
        speed = float(np.linalg.norm(velocities, axis=1).max())
        if speed > found.speed:
            found = Stream(speed, velocities.sum(axis=0) / np.linalg.norm(velocities, axis=1).sum(), float(time))
    return found


def characteristic_length(scene: Scene, outline: Outline, along: np.ndarray) -> tuple[float, str]:
    """The length [m] of a Reynolds number, and which one it is, for people.

    It is that of the first coefficient of a force; else the size across the stream of the largest body in it; else that
    of all of the shape.

    Args:
        along: (2,) direction of the stream; of no direction sizes are the smaller of both sides.
    """
    for name, one in scene.quantities.items():
        named = getattr(getattr(one, one.kind, None), "length", None)
        if one.kind in ("drag_coefficient", "lift_coefficient", "strouhal") and named is not None:
            return float(named), f"of the length that quantities.{name} names"
    bodies = {
        loop.name: np.concatenate([outline.polyline(edge) for edge, _ in loop.edges])
        for loop in outline.loops
        if loop.kind == "hole"
    }
    sizes = {name: _across(places, along) for name, places in bodies.items()}
    if sizes:
        name = max(sizes, key=lambda one: sizes[one])
        return sizes[name], f"of the size of {name} across the stream"
    everything = np.concatenate([outline.polyline(edge) for edge in range(len(outline.edges))])
    return _across(everything, along), "of the size of the shape across the stream"


def _across(places: np.ndarray, along: np.ndarray) -> float:
    """The extent of places (k, 2) across a direction (2,) [m]."""
    if not along.any():
        return float(np.ptp(places, axis=0).min())
    return float(np.ptp(places @ np.array([-along[1], along[0]]) / np.linalg.norm(along)))


def cell_rows(scene: Scene, speed: float) -> tuple[dict[str, object], list[tuple[str, str]]]:
    """The Reynolds number of cells and the Courant number at a speed [m/s]: for programs, and as rows for people."""
    if scene.mesh.size is None:
        return {}, []
    sides = sorted({float(scene.mesh.size), *map(float, scene.mesh.near.values())})
    fine, coarse, fluid = sides[0], sides[-1], scene.fluid
    ends = [fluid.rho * speed * side / fluid.mu for side in (fine, coarse)]
    of = f"of the largest speed given and sides of {_range(1e3 * fine, 1e3 * coarse)} mm"
    data, rows = {"cell_reynolds": ends}, [("cell Reynolds number", f"{_range(*ends)}, {of}")]
    if step := scene.effects.get("flow", {}).get("time_step"):
        passed = [speed * step / side for side in (coarse, fine)]
        data["courant"] = passed
        rows.append(("Courant number", f"{_range(*passed)}, sides that the largest speed given passes in a step"))
    return data, rows


def _range(low: float, high: float) -> str:
    return f"{low:.3g}" if low == high else f"{low:.3g} to {high:.3g}"
