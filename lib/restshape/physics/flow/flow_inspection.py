"""What a scene of flow shows before it has a mesh: its Reynolds number, and what a user may have meant otherwise."""

from collections.abc import Mapping
from typing import Any

from restshape.errors import UserError
from restshape.physics.flow.flow_conditions import balance, edge_kinds
from restshape.physics.flow.reynolds import FRAMES, SOON, cell_rows, characteristic_length, looked_at, stream
from restshape.scene.model import Scene
from restshape.scene.physics import Inspection
from restshape.shape.outline import Outline

STEADY, STEADY_BEHIND = 2000.0, 300.0
"""Reynolds numbers from which flows of vessels, and those around bodies, are hardly ever steady."""
SLOW = 1.0
"""Reynolds number up to which inertia hardly counts."""
LONG_STEP = 10.0
"""Courant number of the largest cells from which a step is longer than what a mesh can show takes to pass."""


def inspect_flow(scene: Scene, outline: Outline) -> Inspection:
    """The Reynolds number, those of cells, whether anything moves the fluid, and whether it can leave all the time."""
    speed, along, fastest = stream(scene, outline)
    if speed and scene.effects and "flow" not in scene.effects:
        names = ", ".join(f"boundary.{name}" for name, one in scene.boundary.items() if one.velocity is not None)
        return Inspection(warnings=(f"{names}: flow is off, and the fluid at rest; add [effects.flow]",))
    if speed == 0.0:
        lifted = "buoyancy" in scene.effects and any(scene.effects["gravity"]["g"])
        if lifted or (scene.effects and "flow" not in scene.effects):
            return Inspection()
        given = any(kind == "velocity" for kind, _ in edge_kinds(scene, outline).values())
        what = "no edge has a velocity"
        if given:
            what = f"velocities at edges are 0{f' in the first {SOON} frames' if len(looked_at(scene)) > 1 else ''}"
        return Inspection(warnings=(f"nothing moves the fluid: {what}",))
    length, words = characteristic_length(scene, outline, along)
    number = scene.fluid.rho * speed * length / scene.fluid.mu
    data, cells = cell_rows(scene, speed)
    of = f"{words} ({1e3 * length:.4g} mm) and the largest speed given{f', at {fastest:g} s' if fastest else ''}"
    rows = [("Reynolds number", f"{number:.3g}, {of}"), *cells]
    warnings = (*_doubts(scene, outline, number), *_long_steps(scene, data), *_unbalanced(scene, outline))
    return Inspection({"reynolds": number, "reynolds_length": length} | data, rows, warnings)


def _doubts(scene: Scene, outline: Outline, number: float) -> tuple[str, ...]:
    """That a flow at this Reynolds number is not slow, or that a steady one may be none."""
    if "convection" not in scene.effects and number > SLOW:
        what = f"at a Reynolds number of {number:.3g} inertia counts where the fluid turns or speeds up"
        return (f"{what}, and the scene leaves it out: add [effects.convection]",)
    in_time = scene.effects.get("flow", {}).get("time_step") is not None
    around = any(loop.kind == "hole" for loop in outline.loops)
    if in_time or "convection" not in scene.effects or number < (STEADY_BEHIND if around else STEADY):
        return ()
    what = f"at a Reynolds number of {number:.3g} flows {'around bodies ' if around else ''}are hardly ever steady"
    return (f"{what}, and a coarse mesh may hide it: give [effects.flow] a time_step",)


def _long_steps(scene: Scene, numbers: Mapping[str, Any]) -> tuple[str, ...]:
    """That what the mesh can show passes its cells within a step."""
    passed = float(min(numbers.get("courant", [0.0])))
    if passed <= LONG_STEP:
        return ()
    what = (
        f"the fluid passes {passed:.3g} sides of the largest cells in a step: it is stable, but eddies are smeared out"
    )
    step = scene.effects["flow"]["time_step"] / passed
    return (f"{what}; what changes needs a time_step near {step:.2g} s",)


def _unbalanced(scene: Scene, outline: Outline) -> tuple[str, ...]:
    """That later on more flows into a vessel without outflow than out of it."""
    for frame, time in zip(FRAMES, looked_at(scene)):
        try:
            error = balance(scene, outline, time)
        except UserError:
            # The frame will say why it is refused.
            return ()
        if error:
            where = f"{error.where}: at {time:g} s, in frame {frame:g}"
            return (f"{where}, {error.what}: such frames are refused; {error.do}",)
    return ()
