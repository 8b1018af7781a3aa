"""Limits of quantities that a suggested piece violates."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from restshape_apps.furniture.physics.derivatives import stability_derivative
from restshape_apps.furniture.physics.furniture import LOST, Furniture
from restshape_apps.furniture.physics.plank_bending import plank_bending
from restshape_apps.furniture.physics.plank_quantities import Observed, plank_quantities
from restshape_apps.furniture.scene.plank_quantities import place_of
from restshape_apps.furniture.shape.planks import Piece

from restshape.findings import Finding
from restshape.replay.constraints import limits_of, violated_constraints
from restshape.scene.model import Quantity


def violated_limits(piece: Piece, quantities: Mapping[str, Quantity]) -> tuple[Finding, ...]:
    """The limits that a piece violates; none where no quantity has one, or the piece has no forces.

    Args:
        piece: with closed joints.
        quantities: of its scene, by name.
    """
    limits = limits_of(quantities)
    if not limits:
        return ()
    furniture = Furniture(piece)
    if furniture.test().flaws & LOST:
        return ()
    limited = {name: quantities[name] for name in limits}
    cases = range(len(furniture.cases))
    still = np.zeros((1, 8 * len(piece.planks)))
    rows = [stability_derivative(furniture, still, case)[0] for case in cases]
    stability_margin = float(min((row.min() for row in rows if len(row)), default=np.nan))
    deflection = np.full(len(piece.planks), np.nan)
    if any(one.deflection for one in limited.values()):
        places = {place_of(one)[0] for one in limited.values() if one.deflection}
        for k in (k for k, plank in enumerate(piece.planks) if "" in places or plank.name in places):
            deflection[k] = max(plank_bending(furniture, k, case).max_deflection for case in cases)
    forces = [furniture.forces(case) for case in cases]
    known = Observed(piece, furniture.geometry(), forces, deflection, stability_margin)
    return violated_constraints(limits, plank_quantities(limited, known))
