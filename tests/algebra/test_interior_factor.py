"""Factors of a rank's own rows: freed where they are let go of, not at the end of a frame."""

import os
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp

from restshape.algebra.factors.interior_factor import InteriorFactor, MumpsInterior, PlainInterior, has_mumps
from restshape.algebra.factors.node_factors import BorderedFactor

SIDE = 50


def laplacian() -> sp.csr_matrix:
    """That of a square of nodes."""
    chain = sp.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=2 * (SIDE,))
    made = sp.csr_matrix(sp.kronsum(chain, chain))
    made.indices, made.indptr = made.indices.astype(np.int32), made.indptr.astype(np.int32)
    return made


def resident() -> int:
    """Memory [bytes] of this process."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.parametrize("kind", [MumpsInterior, PlainInterior, BorderedFactor])
def test_factors_that_are_let_go_of_leave_nothing(kind):
    """A frame of large deformation on several ranks may test hundreds of tangents. Kept, each was 1 MB of these."""
    if kind is MumpsInterior and not has_mumps():
        pytest.skip("PETSc has been built without MUMPS")
    matrix, inside = laplacian(), SIDE * (SIDE - 1)
    used = []
    for _ in range(30):
        factor: InteriorFactor | BorderedFactor = kind(*((SIDE, 1) if kind is BorderedFactor else (inside, SIDE)))
        factor.make((matrix.indptr, matrix.indices, matrix.data))
        factor.destroy()
        used.append(resident())
    assert used[-1] - used[9] < 4 << 20
