"""The steady response of a linear structure to a load that swings at one frequency."""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu


def harmonic_response(
    stiffness: sp.spmatrix, mass: sp.spmatrix, damping: sp.spmatrix, omega: float, load: np.ndarray
) -> np.ndarray:
    """The complex amplitude U (n,) of u = Re U exp(i omega t) under the load Re F exp(i omega t).

    (K - omega^2 M + i omega C) U = F, by a direct solve.

    Args:
        stiffness, mass, damping: (n, n) of the free unknowns.
        omega: angular frequency [rad/s].
        load: (n,) its amplitude F, complex or real.
    """
    operator = (stiffness - omega**2 * mass + 1j * omega * damping).tocsc()
    return splu(operator).solve(load.astype(complex))
