"""Second-order triangles as pictures show them: curved sides follow their parabola."""

import numpy as np
import pytest

from restshape.report.outlines import border, lines, polygons

# A triangle whose first side is the parabola y = -x (1 - x) from (0, 0) to (1, 0); a straight neighbour on its side 1.
X = np.array([[0, 0], [1, 0], [0, 1], [0.5, -0.25], [0.5, 0.5], [0, 0.5], [1, 1], [1, 0.5], [0.5, 1]], dtype=float)
CELLS = np.array([[0, 1, 2, 3, 4, 5], [1, 6, 2, 7, 8, 4]])


def test_sides_lie_on_their_parabola():
    (side,) = lines(X, np.array([[0, 1, 3]]))
    np.testing.assert_allclose(side[:, 1], -side[:, 0] * (1 - side[:, 0]), atol=1e-15)
    assert side[0].tolist() == [0, 0] and side[-1].tolist() == [1, 0]


def test_polygons_nearly_fill_curved_triangles():
    areas = []
    for shape in polygons(X, CELLS):
        x, y = shape.T
        areas.append(0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)))
    # The integral of x (1 - x) is 1/6; four chords miss a sixteenth of it.
    assert areas[0] == pytest.approx(0.5 + 1 / 6 * 15 / 16, rel=1e-12)
    assert areas[1] == pytest.approx(0.5, rel=1e-12)


def test_the_border_leaves_out_the_side_between():
    assert {frozenset(side[:2]) for side in border(CELLS).tolist()} == {
        frozenset(pair) for pair in [(0, 1), (0, 2), (1, 6), (6, 2)]
    }
    assert {tuple(sorted(side[:2])): side[2] for side in border(CELLS).tolist()}[0, 1] == 3


def test_first_order_is_left_as_it_is():
    corners = CELLS[:, :3]
    assert np.array_equal(polygons(X, corners), X[corners])
    assert border(corners).shape == (4, 2)
