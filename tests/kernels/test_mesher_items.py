"""The mesher keeps the items of its lists: one for each node that is inserted would take a tenth of its time."""

import numpy as np
import pytest

from restshape import _kernels

pytestmark = pytest.mark.skipif(not _kernels.has_cgal, reason="built without CGAL")


def mesh(size):
    points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    segments = np.array([[0, 1], [1, 2], [2, 3], [3, 0]], dtype=np.int32)
    # Triangles grow away from a corner, so that none is in stock.
    sources = np.array([[0.0, 0.0, 0.2 * size, 0.5]])
    given = points, segments, np.ones(4, dtype=np.uint8), size, 0.2, sources
    return _kernels.refine_delaunay(*given, 1.0, 0.12, 1_000_000)


def test_items_of_lists_serve_for_all_nodes_and_the_next_mesh():
    before = _kernels.mesher_items()
    X = mesh(0.05)[0]
    made = _kernels.mesher_items() - before
    assert len(X) > 400 and made < len(X) / 4
    assert np.array_equal(mesh(0.05)[0], X)
    assert _kernels.mesher_items() == before + made
