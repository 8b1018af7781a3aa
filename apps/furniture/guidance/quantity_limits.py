"""Limits of quantities that a suggested piece violates, and of the strength of its planks."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from restshape_apps.furniture.physics.derivatives import stability_values
from restshape_apps.furniture.physics.furniture import LOST, Furniture
from restshape_apps.furniture.physics.plank_bending import overbent, plank_bending
from restshape_apps.furniture.physics.plank_quantities import Observed, plank_quantities
from restshape_apps.furniture.scene.plank_quantities import place_of
from restshape_apps.furniture.shape.planks import Piece

from restshape.findings import Finding
from restshape.replay.constraints import limits_of, violated_constraints
from restshape.scene.model import Quantity


def violated_limits(piece: Piece, quantities: Mapping[str, Quantity], bending: bool = False) -> tuple[Finding, ...]:
    """The limits that a piece violates, after the planks that bend beyond their strength.

    None are found where no quantity has a limit and planks do not bend, or where the piece has no forces.

    Args:
        piece: with closed joints.
        quantities: of its scene, by name.
        bending: whether planks bend.
    """
    limits = limits_of(quantities)
    if not limits and not bending:
        return ()
    furniture = Furniture(piece)
    if furniture.test().flaws & LOST:
        return ()
    limited = {name: quantities[name] for name in limits}
    cases = range(len(furniture.cases))
    rows = [stability_values(furniture, case) for case in cases]
    stability_margin = float(min((row.min() for row in rows if len(row)), default=np.nan))
    deflection, found = np.full(len(piece.planks), np.nan), {}
    places = {place_of(one)[0] for one in limited.values() if one.deflection}
    for k, plank in enumerate(piece.planks):
        if bending or "" in places or plank.name in places:
            found[k] = [plank_bending(furniture, k, case) for case in cases]
            deflection[k] = max(one.max_deflection for one in found[k])
    bent = overbent(piece, found) if bending else ()
    forces = [furniture.forces(case) for case in cases]
    known = Observed(piece, furniture.geometry(), forces, deflection, stability_margin)
    return (*bent, *violated_constraints(limits, plank_quantities(limited, known)))
