"""Stiffness of materials, isotropic or with a grain, as the elements take it."""

from collections.abc import Sequence

import numpy as np

from restshape.scene.model import Material

SHEAR_FACTOR = 5.0 / 6.0
"""Share of the shear modulus that a plate's mean shear strain meets. Source: Reissner, J. Appl. Mech. 12 (1945) A69."""

FREE_SIDES = slice(11, 14), (0.0, 0.0, 0.0)
"""Columns of a plate's parameters that are 1 for each side that is free to twist, and what they are elsewhere."""

PLANE = [0, 1, 5]
"""Rows of the strains in the plane."""


def isotropic(E: float, nu: float) -> np.ndarray:
    """Stiffness (6, 6) [Pa] in the order xx yy zz yz xz xy, shear strains doubled, of Young's modulus [Pa] and nu."""
    G = E / (2 * (1 + nu))
    return orthotropic((E, E, E), (nu, nu, nu), (G, G, G))


def lame(material: Material, stress: bool) -> tuple[float, float]:
    """Lame coefficients (lambda, mu) [Pa]; plane stress takes lambda* (docs/theory/solids.md)."""
    E, nu = material.E, material.nu
    return (E * nu / (1 - nu**2) if stress else E * nu / ((1 + nu) * (1 - 2 * nu))), E / (2 * (1 + nu))


def orthotropic(E: Sequence[float], nu: Sequence[float], G: Sequence[float]) -> np.ndarray:
    """Stiffness (6, 6) [Pa] in the order 11 22 33 23 13 12, shear strains doubled; 1 is along the grain.

    Args:
        E: Young's moduli E1, E2, E3 [Pa].
        nu: nu12, nu13, nu23: the second index contracts where the first is pulled.
        G: shear moduli G12, G13, G23 [Pa].

    Source: Lekhnitskii, Theory of Elasticity of an Anisotropic Body (1963), section 3.
    """
    (E1, E2, E3), (n12, n13, n23), (G12, G13, G23) = E, nu, G
    S = np.zeros((6, 6), np.result_type(float, *E, *nu, *G))
    S[:3, :3] = [[1 / E1, -n12 / E1, -n13 / E1], [-n12 / E1, 1 / E2, -n23 / E2], [-n13 / E1, -n23 / E2, 1 / E3]]
    S[3:, 3:] = np.diag([1 / G23, 1 / G13, 1 / G12])
    return np.linalg.inv(S)


def stiffness_of(material: Material) -> np.ndarray:
    """Stiffness (6, 6) [Pa] of a material in the axes x, y of the plane and z: xx yy zz yz xz xy, shear doubled."""
    if material.orthotropic is None:
        return isotropic(material.E, material.nu)
    constants = material.orthotropic
    return turned(orthotropic(constants.E, constants.nu, constants.G), material.grain)


def turned(C: np.ndarray, angle: float) -> np.ndarray:
    """The stiffness C (6, 6) of a material whose axis 1 is turned from x towards y by an angle [rad].

    Source: Ting, Anisotropic Elasticity (1996), section 2.5 (Bond's matrix).
    """
    c, s = np.cos(angle), np.sin(angle)
    # Stresses of the turned axes in x, y, z.
    K = np.eye(6, dtype=np.result_type(float, c))
    K[np.ix_(PLANE, PLANE)] = [[c * c, s * s, -2 * c * s], [s * s, c * c, 2 * c * s], [c * s, -c * s, c * c - s * s]]
    K[3:5, 3:5] = [[c, s], [-s, c]]
    return K @ C @ K.T


def plane_stress(C: np.ndarray) -> np.ndarray:
    """Stiffness (3, 3) [Pa] of xx, yy, xy where no stress is normal to the plane, of C (6, 6)."""
    inner = C[np.ix_(PLANE, PLANE)]
    return inner - np.outer(C[PLANE, 2], C[2, PLANE]) / C[2, 2]


def plane_strain(C: np.ndarray) -> np.ndarray:
    """Stiffness (3, 3) [Pa] of xx, yy, xy where nothing stretches along the normal of the plane, of C (6, 6)."""
    return C[np.ix_(PLANE, PLANE)]


def solid_params(C: np.ndarray) -> np.ndarray:
    """Parameters (24,) of the elements anisotropic_tet4 and anisotropic_tet10, without body force, of C (6, 6) [Pa]."""
    return np.concatenate([C[np.triu_indices(6)], np.zeros(3)])


def plane_params(Q: np.ndarray, thickness: float) -> np.ndarray:
    """Parameters (9,) of anisotropic_tri3 and anisotropic_tri6, without body force, of Q (3, 3) [Pa]; thickness [m]."""
    return np.concatenate([Q[np.triu_indices(3)], [thickness, 0.0, 0.0]])


def plate_params(C: np.ndarray, rho: float, load: float = 0.0, factor: float = SHEAR_FACTOR) -> np.ndarray:
    """Parameters (14,) of the elements plate_tri3 and mass_plate_tri3, of triangles without a free side.

    Args:
        C: stiffness (6, 6) [Pa], turned to the axes of the plane.
        rho: density [kg/m^3].
        load: force along z on the surface [Pa].
        factor: of the shear moduli.
    """
    Q = plane_stress(C)
    shear = factor * C[3:5, 3:5]
    bending = [Q[0, 0], Q[0, 1], Q[1, 1], Q[0, 2], Q[1, 2], Q[2, 2]]
    return np.array([*bending, shear[0, 0], shear[0, 1], shear[1, 1], rho, load, *FREE_SIDES[1]])
