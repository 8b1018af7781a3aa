"""What a harmonic map of a large mesh takes, which is the most memory of a drag."""

import os
from pathlib import Path

import numpy as np
import pytest
from sample_meshes import unit_box

from restshape import _kernels

SIDE = 300


def resident() -> int:
    """Memory [bytes] of this process, without what it could give back."""
    if not _kernels.give_back_memory():
        pytest.skip("the system's library does not give memory back on demand")
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_a_map_keeps_neither_shapes_nor_copies_of_its_matrix():
    """Both together would be 50 bytes a cell more."""
    X, cells, inner = unit_box(2, SIDE)
    boundary = np.setdiff1d(np.arange(len(X)), inner).astype(np.int32)
    X, cells = np.ascontiguousarray(X), np.ascontiguousarray(cells, dtype=np.int32)
    before = resident()
    extension = _kernels.HarmonicExtension(X, cells, boundary)
    taken = (resident() - before) / len(cells)
    found = extension.solve(X[boundary])
    assert taken < 380.0 and np.abs(found - X).max() < 1e-9
