"""Force space of a piece: forces in parts of what is allowed, and how design modes change them."""

import numpy as np
from restshape_apps.furniture.physics.derivatives import force_derivative, stability_derivative
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.shape.design_modes import DesignModes

from restshape.guidance.force_space import ForceSpace

SHEARED = 0.7
"""Use of a joint's shear strength from which on shear has rows of its own."""


def durability_space(furniture: Furniture, modes: DesignModes) -> ForceSpace:
    """Bending moments of all joints and cases, in parts of what their fasteners bear beside the present pull.

    Fasteners count by the joint's length here, for their whole number has no derivative. Shear forces join them where
    one comes near its strength; their circle is taken for a square.
    """
    nails, directions = furniture.nails(), modes.directions
    pull, shear = furniture.strength.T * nails
    length = furniture.geometry().length
    forces = [furniture.forces(case) for case in range(len(furniture.cases))]
    sheared = any(f.shear_utilisation.max(initial=0.0) > SHEARED for f in forces)
    h, K = [], []
    for case, found in enumerate(forces):
        change = force_derivative(furniture, directions, case)
        bears = 0.5 * furniture.lever * np.maximum(pull - found.tension, 1e-3 * pull)
        longer = change.length / length
        h.append(found.bending / bears)
        K.append(change.bending / bears - h[-1] * longer)
        for k in range(2 if sheared else 0):
            h.append(found.shear[:, k] / shear)
            K.append(change.shear[:, :, k] / shear - h[-1] * longer)
    h, K = np.concatenate(h), np.ascontiguousarray(np.concatenate(K, axis=1))
    one = np.ones_like(h)
    return ForceSpace(K, h, h, -one, one)


def stability_space(furniture: Furniture, modes: DesignModes) -> ForceSpace:
    """What holds the piece down in all cases, which must not be negative; nothing of cases that do not press at all."""
    found = [stability_derivative(furniture, modes.directions, case) for case in range(len(furniture.cases))]
    h = np.concatenate([values for values, _ in found])
    K = np.concatenate([change for _, change in found], axis=1)
    known = np.isfinite(h)
    h, K = h[known], np.ascontiguousarray(K[:, known])
    return ForceSpace(K, h, np.minimum(h, 0.0), np.zeros_like(h), np.full_like(h, np.inf))


def whole_space(furniture: Furniture, modes: DesignModes) -> ForceSpace:
    """Rows of stability and of durability at once: what makes a piece stand is not to break its joints."""
    stable, durable = stability_space(furniture, modes), durability_space(furniture, modes)
    outside = durable.h - np.clip(durable.h, durable.low, durable.high)
    return ForceSpace(
        np.concatenate([stable.K, durable.K], axis=1),
        *(
            np.concatenate(pair)
            for pair in (
                (stable.h, durable.h),
                (stable.gap, outside),
                (stable.low, durable.low),
                (stable.high, durable.high),
            )
        ),
    )


def contact_space(furniture: Furniture, modes: DesignModes, case: int = 0) -> ForceSpace:
    """Normal forces of the contacts of one case, in parts of their sum, which must not be negative (6.16)."""
    normals = np.repeat([furniture.piece.planes[foot.plane].normal for foot in furniture.piece.feet], 4, axis=0)
    pressed = np.einsum("ca,ca->c", furniture.forces(case).contacts, normals)
    scale = max(pressed.sum(), 1e-300)
    K = np.ascontiguousarray(force_derivative(furniture, modes.directions, case).pressed / scale)
    h = pressed / scale
    return ForceSpace(K, h, np.minimum(h, 0.0), np.zeros_like(h), np.full_like(h, np.inf))
