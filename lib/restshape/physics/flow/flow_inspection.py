"""What a scene of flow shows before it has a mesh: its Reynolds number, and what a user may have meant otherwise."""

import numpy as np

from restshape.physics.flow.flow_conditions import border_velocities, edge_kinds
from restshape.scene.model import Scene
from restshape.scene.physics import Inspection
from restshape.shape.outline import Outline

TIMES = np.linspace(0.0, 1.0, 11)
"""At which velocities that vary with the time are looked at [s]."""
STEADY = 2000.0
"""Reynolds number of the width from which flows are hardly ever steady."""


def inspect_flow(scene: Scene, outline: Outline) -> Inspection:
    """The Reynolds number of the width of the shape, and whether anything moves the fluid."""
    kinds = edge_kinds(scene, outline)
    speeds = [np.linalg.norm(u, axis=1).max(initial=0.0) for t in TIMES for u in border_velocities(scene, outline, t)]
    speed = max(speeds, default=0.0)
    if speed == 0.0:
        lifted = "buoyancy" in scene.effects and any(scene.effects["gravity"]["g"])
        if lifted or (scene.effects and "flow" not in scene.effects):
            return Inspection()
        given = any(kind == "velocity" for kind, _ in kinds.values())
        what = "velocities at edges are 0 in the first second" if given else "no edge has a velocity"
        return Inspection(warnings=(f"nothing moves the fluid: {what}",))
    corners = np.concatenate([outline.polyline(edge) for edge in kinds])
    width = float(np.ptp(corners, axis=0).min())
    number = scene.fluid.rho * speed * width / scene.fluid.mu
    words = f"{number:.3g}, of the width of the shape and the largest speed given"
    return Inspection({"reynolds": number}, [("Reynolds number", words)], _doubts(scene, number))


def _doubts(scene: Scene, number: float) -> tuple[str, ...]:
    """That a steady flow at this Reynolds number may be none."""
    in_time = scene.effects.get("flow", {}).get("time_step") is not None
    if in_time or "convection" not in scene.effects or number < STEADY:
        return ()
    what = f"at a Reynolds number of {number:.3g} flows are hardly ever steady, and a coarse mesh may hide it"
    return (f"{what}: give [effects.flow] a time_step",)
