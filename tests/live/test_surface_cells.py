"""Triangles that show elements come in the order from which the page knows the sides inside an element."""

from types import SimpleNamespace

import numpy as np
import pytest

from restshape.live.shape_surface import ShapeSurface
from restshape.live.surface_cells import triangles_of

PLACES = {
    3: [[0, 0], [1, 0], [0, 1]],
    6: [[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]],
    8: [[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))],
}


@pytest.mark.parametrize(("nodes", "parts"), [(3, 1), (6, 4), (8, 2)])
def test_triangles_of_an_element_come_part_by_part(nodes, parts):
    X = np.concatenate([PLACES[nodes], np.array(PLACES[nodes]) + 3.0]).astype(float)
    cells = np.arange(2 * nodes).reshape(2, nodes)
    shown = triangles_of(X, cells)
    assert shown.parts == parts
    faces = shown.corners.reshape(parts, -1, 3)
    assert np.array_equal(shown.cell.reshape(parts, -1), np.tile(shown.cell.reshape(parts, -1)[0], (parts, 1)))
    inner = {4: [[True, False, False], [False, True, False], [False, False, True], [True] * 3]}
    inner |= {2: [[False, True, False], [False, False, True]], 1: [[False] * 3]}
    for part, sides in zip(faces, inner[parts]):
        for corner, inside in enumerate(sides):
            ends = np.delete(part, corner, axis=1)
            assert all(shares(faces, pair) == inside for pair in ends), (corner, inside)


def shares(faces, side):
    """Whether two triangles of one plane face, or element, have a side; triangles of one face have the same number."""
    with_it = np.isin(faces, side).sum(axis=2) == 2
    return bool((with_it.sum(axis=0) == 2).any())


def test_a_mesh_whose_cells_are_those_of_the_one_before_is_drawn_by_the_same_triangles():
    cells, X = np.array([[0, 1, 2], [0, 2, 3]]), np.random.default_rng(5).random((4, 2))
    surface = ShapeSurface()
    first, moved, other = (
        surface(SimpleNamespace(X=at, cells=of, topology=1), {}, {}, None)
        for at, of in ((X, cells), (X + 0.1, cells), (X, cells.copy()))
    )
    assert all(first.arrays[name] is moved.arrays[name] for name in ("cells", "border"))
    np.testing.assert_allclose(moved.arrays["points"], X + 0.1, atol=1e-7)
    assert other.arrays["cells"] is not first.arrays["cells"]
