"""How a scene's cloth touches itself: whether, from which distance on, and how hard."""

from __future__ import annotations

import numpy as np

from restshape.errors import UserError
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.self_contact.self_contact import SelfContactValues
from restshape.physics.cloth.self_contact.touching_itself import layer_thickness
from restshape.physics.cloth.self_contact.touching_pairs import barrier_force
from restshape.physics.cloth.sheet.fabric import Fabric, FabricRates
from restshape.scene.model import Scene
from restshape.scene.plan import Plan

APART = 3.0
"""Distance of parts that are no neighbours in flat cloth, over that at which contact begins, at least."""
PRESSED = 10.0
"""Pressure at half of that distance, over what a layer of cloth weighs, or what a fold presses with."""
ROUND = 10.0
"""Radius of a fold, over the distance at which contact begins."""
FAINT = 1e-6
"""Pressure over the membrane's stiffness by the distance, of cloth that neither weighs nor bends."""


def layer_values(scene: Scene, plan: Plan, mesh: Mesh, fabric: Fabric) -> SelfContactValues | None:
    """How parts of the cloth push each other away on a mesh; None: they pass through each other.

    Raises:
        UserError: contact would begin between neighbours in the flat cloth.
    """
    if not plan.on("self_contact"):
        return None
    settings, gravity = plan.settings("contact"), plan.settings("gravity")
    thickness, most = layer_thickness(scene, settings), smallest_height(mesh) / APART
    if thickness > most and settings and settings.self_thickness is not None:
        raise UserError(
            f"parts of the flat cloth are {1e3 * APART * most:.3g} mm apart, and contact begins at "
            f"{1e3 * thickness:.3g} mm: a third of that is the most",
            "effects.contact.self_thickness",
            f'set it to "{1e3 * most:.2g} mm" or less, or make mesh.size larger',
        )
    thickness = min(thickness, most)
    weight = float(np.max(fabric.density)) * (gravity.size if gravity else 0.0)
    fold = float(np.max(fabric.bending)) / (ROUND * thickness) ** 3
    pressure = PRESSED * max(weight, fold) or FAINT * float(fabric.membrane.max()) / thickness
    half = float(barrier_force(np.array([0.5]), 1.0)[0])
    friction, slip = (settings.self_friction, settings.slip) if settings else (0.0, SelfContactValues.slip)
    return SelfContactValues(thickness, pressure / half, friction, slip)


def stiffness_share(thickness: float, fabric: Fabric, g: np.ndarray, rates: FabricRates, gravity: np.ndarray) -> float:
    """The rate of the barrier's stiffness that `layer_values` decides, over the stiffness.

    Args:
        thickness: distance at which contact begins [m].
        fabric: of the cloth; rates: of it.
        g: acceleration (3,) [m/s^2]; gravity: its rate (3,).
    """
    size, ne = float(np.linalg.norm(g)), len(rates.density)
    density = np.broadcast_to(fabric.density, ne)
    heaviest, weight = int(np.argmax(density)), float(np.max(density)) * size
    bends, stretches = (np.broadcast_to(part, (ne, 3, 3)).reshape(-1) for part in (fabric.bending, fabric.membrane))
    stiffest = int(np.argmax(bends))
    fold = float(bends[stiffest]) / (ROUND * thickness) ** 3
    if not max(weight, fold):
        strongest = int(np.argmax(stretches))
        return float(rates.membrane.reshape(-1)[strongest] / stretches[strongest])
    if fold > weight:
        return float(rates.bending.reshape(-1)[stiffest] / bends[stiffest])
    return float(rates.density[heaviest] / density[heaviest] + g @ gravity / size**2)


def smallest_height(mesh: Mesh) -> float:
    """The smallest height of a triangle of a mesh [m]: farther apart are all parts that are no neighbours."""
    corners = mesh.X[mesh.cells]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return float((np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]) / sides.max(axis=1)).min())
