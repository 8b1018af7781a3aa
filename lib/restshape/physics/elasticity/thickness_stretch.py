"""How the thickness of a plane body changes where it stretches in its plane."""

import numpy as np

from restshape import _kernels

CENTRE = np.full((1, 2), 1.0 / 3.0)


def thickness_stretch(
    X: np.ndarray, x: np.ndarray, cells: np.ndarray, ratio: np.ndarray | float, points: np.ndarray | None = None
) -> np.ndarray:
    """Thickness over that at rest, in plane stress under the law of St. Venant and Kirchhoff; not a number beyond 0.

    S_zz = lambda tr(E) + 2 mu E_zz = 0 gives E_zz = -nu/(1 - nu) (E_xx + E_yy), and the stretch sqrt(1 + 2 E_zz).

    Args:
        X: (n, 2) places at rest [m].
        x: (n, 2) displacements [m].
        cells: (ne, 3) or (ne, 6) nodes of triangles.
        ratio: (ne,) or a number, nu/(1 - nu).
        points: (m, 2) reference coordinates; without them the centroids are meant.

    Returns:
        (ne, m), or (ne,) at centroids.

    Source: docs/theory/solids.md.
    """
    ratios = np.full(len(cells), ratio) if np.ndim(ratio) == 0 else ratio
    found = _kernels.thickness_stretch(X, x, cells, ratios, CENTRE if points is None else points)
    return found[:, 0] if points is None else found
