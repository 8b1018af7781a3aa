"""A reference for forces in furniture: the least complementary energy in equilibrium, by one dense linear system."""

import numpy as np
from restshape_apps.furniture.physics.furniture import Furniture


def least_energy(furniture: Furniture) -> tuple[np.ndarray, np.ndarray]:
    """Joint forces h_t, h_r (j, 6) and contact forces (c, 3) of the least complementary energy in equilibrium.

    Contacts are springs both ways. Displacements are small, and nothing of the model's own solver is used.

    Args:
        furniture: whose geometry and compliances are taken.

    Source: minimise f.C f / 2 with A f = b: its multipliers are the displacements.
    """
    piece, geometry, compliance = furniture.piece, furniture.geometry(), furniture.compliance
    n, nj, nc = len(piece.planks), len(piece.joints), len(geometry.contacts)
    A = _balance(furniture)
    b = np.zeros(6 * n)
    for i in range(n):
        b[6 * i : 6 * i + 3] = -geometry.mass[i] * np.array(piece.gravity)
    for load in piece.weights:
        at = geometry.centre[load.plank] + geometry.axes[load.plank] @ (load.place * geometry.size[load.plank])
        b[6 * load.plank : 6 * load.plank + 3] -= load.force
        b[6 * load.plank + 3 : 6 * load.plank + 6] -= _arm(at, geometry.centre[load.plank]) @ load.force
    C = np.concatenate([np.tile([compliance.joint_t] * 3 + [compliance.joint_r] * 3, nj), [compliance.floor] * 3 * nc])
    C = C / compliance.joint_t
    system = np.block([[np.diag(C), A.T], [A, np.zeros((6 * n, 6 * n))]])
    f = np.linalg.lstsq(system, np.concatenate([np.zeros(len(C)), b]), rcond=1e-13)[0]
    return f[: 6 * nj].reshape(-1, 6), f[6 * nj : len(C)].reshape(-1, 3)


def _balance(furniture: Furniture) -> np.ndarray:
    """What forces of joints and contacts do to the planks: forces and moments (6 n, 6 j + 3 c)."""
    piece, geometry = furniture.piece, furniture.geometry()
    n, nj, nc = len(piece.planks), len(piece.joints), len(geometry.contacts)
    A = np.zeros((6 * n, 6 * nj + 3 * nc))
    for k, joint in enumerate(piece.joints):
        for plank, sign in ((joint.i, -1.0), (joint.j, 1.0)):
            A[6 * plank : 6 * plank + 3, 6 * k : 6 * k + 3] += sign * np.eye(3)
            A[6 * plank + 3 : 6 * plank + 6, 6 * k : 6 * k + 3] += sign * _arm(geometry.p[k], geometry.centre[plank])
            # The opening is the rotation of j seen from i.
            A[6 * plank + 3 : 6 * plank + 6, 6 * k + 3 : 6 * k + 6] -= sign * np.eye(3)
    for k, point in enumerate(geometry.contacts):
        plank, column = piece.feet[k // 4].plank, 6 * nj + 3 * k
        A[6 * plank : 6 * plank + 3, column : column + 3] = np.eye(3)
        A[6 * plank + 3 : 6 * plank + 6, column : column + 3] = _arm(point, geometry.centre[plank])
    return A


def _arm(point: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """The matrix (3, 3) that makes a force at a point its moment about a centre."""
    x, y, z = point - centre
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
