"""Parameters of the elements of cloth, by stiffness matrices."""

import numpy as np

from restshape.physics.cloth.sheet.parameters import UPPER


def membrane_params(C: np.ndarray, load: np.ndarray | tuple[float, float, float] = (0.0, 0.0, 0.0)) -> np.ndarray:
    """Parameters (9,) of the elements membrane_tri3, membrane_stabilised_tri3 and membrane_corotated_tri3.

    Args:
        C: (3, 3) tensions xx, yy, xy [N/m] by strains xx, yy and twice xy: plane stress times thickness.
        load: (3,) dead force [N/m^2] of material.
    """
    return np.concatenate([C[UPPER], load])


def morley_params(D: np.ndarray, signs: np.ndarray) -> np.ndarray:
    """Parameters (ne, 9) of the element morley_tri6.

    Args:
        D: (3, 3) moments xx, yy, xy [N] by curvatures xx, yy and twice xy: plane stress times thickness^3/12 [N m].
        signs: (ne, 3) of the sides, see `restshape.mesh.morley.MorleySpace`.
    """
    return np.column_stack([np.tile(D[UPPER], (len(signs), 1)), signs])


def isotropic_bending(D: float, nu: float) -> np.ndarray:
    """Bending stiffness (3, 3) [N m] of an isotropic sheet, D = E h^3/(12 (1 - nu^2)) [N m]."""
    return D * np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, (1.0 - nu) / 2.0]])
