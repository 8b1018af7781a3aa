"""What large deformation refuses: triangles that turn inside out are found; the hard cases are in `test_hard_cases`."""

import numpy as np
import pytest

from restshape import _kernels


@pytest.mark.parametrize("cells", ["straight", "second order"])
def test_inverted_cells_are_found(cells):
    X = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]], dtype=float)
    cell = np.arange(3 if cells == "straight" else 6, dtype=np.int32)[None]
    u = np.zeros_like(X)
    assert len(_kernels.inverted_cells(X, u, cell)) == 0
    if cells == "straight":
        u[2] = [0, -1.5]
    else:
        # The middle of a side is drawn past a quarter of it: det F < 0 near one corner only.
        u[3] = [0.3, 0]
    assert list(_kernels.inverted_cells(X, u, cell)) == [0]
