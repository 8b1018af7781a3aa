"""Derivatives of the forces in furniture with respect to its design: one factor, many right sides."""

from dataclasses import dataclass

import numpy as np
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.shape.design_modes import DesignModes


@dataclass(frozen=True)
class ForceDerivative:
    """Derivatives of one case's equilibrium, modes in rows.

    Args:
        u: (m, n, 6) of displacements and rotation vectors.
        tension, bending: (m, j) of T [N] and h^r_y [N m].
        shear: (m, j, 2) of h_x and h_y [N].
        pressed: (m, c) of the contacts' normal forces [N].
        length: (m, j) of the joints [m].
    """

    u: np.ndarray
    tension: np.ndarray
    bending: np.ndarray
    shear: np.ndarray
    pressed: np.ndarray
    length: np.ndarray


def force_derivative(furniture: Furniture, directions: np.ndarray, case: int = 0) -> ForceDerivative:
    """Derivatives of the forces of a case along design directions, at the piece as it is.

    The number of fasteners in a joint is kept, and so is what each contact does: hold, slide, or nothing.

    Args:
        furniture: just tested at no change of its design parameters.
        directions: (m, 8 n), such as `DesignModes.directions`.
        case: of the loads.

    Source: docs/theory/furniture.md: A dx = db - dA x.
    """
    raw = furniture.kernel.derivative(directions, case)
    m = len(directions)
    return ForceDerivative(
        raw["x"].reshape(m, -1, 6),
        raw["tension"],
        raw["bending"],
        np.stack([raw["shear_x"], raw["shear_y"]], axis=2),
        raw["normal"],
        raw["length"],
    )


def stability_derivative(furniture: Furniture, directions: np.ndarray, case: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """What holds a piece down, (r,) as `stability_values`, and its derivatives (m, r) along design directions (m, 8 n).

    Both are at no change of its design parameters, whatever was tested last.
    """
    return furniture.kernel.stability_rows(directions, case)


def stability_values(furniture: Furniture, case: int = 0) -> np.ndarray:
    """What holds a piece down (r,) at the last test.

    One number for each edge of the hull of a part's contacts: the loads' moment about it in parts of weight times
    size; and one for friction where loads push sideways: mu less the ratio of the forces. All are positive in a
    piece that neither tips nor slides.
    """
    return furniture.kernel.stability(case)


def predicted(furniture: Furniture, modes: DesignModes, direction: np.ndarray, case: int = 0) -> np.ndarray:
    """Displacements (n, 6) that the derivative predicts after a change (m,) of the modes: Newton's guess."""
    whole = direction @ modes.directions
    return furniture.forces(case).u + force_derivative(furniture, whole[None], case).u[0]
