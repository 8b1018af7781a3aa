"""Second-order triangles as pictures show them: curved sides follow their parabola."""

import numpy as np
import pytest

from restshape.report.outlines import border, chains, lines, polygons

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


@pytest.mark.parametrize("order", [1, 2])
def test_dashes_go_on_from_side_to_side(order):
    """A square of eight triangles around a square hole: two closed lines, as long as both squares are around."""
    outer = np.array([[0, 0], [4, 0], [4, 4], [0, 4]], dtype=float)
    X = np.vstack([outer, 1.0 + 0.5 * outer])
    cells = np.array([[k, (k + 1) % 4, 4 + k] for k in range(4)])
    cells = np.vstack([cells, [[(k + 1) % 4, 4 + (k + 1) % 4, 4 + k] for k in range(4)]])
    if order == 2:
        middles: dict[tuple[int, int], int] = {}
        more = []
        for cell in cells:
            pairs = [tuple(sorted((int(cell[i]), int(cell[(i + 1) % 3])))) for i in range(3)]
            more.append([middles.setdefault(pair, len(X) + len(middles)) for pair in pairs])
        X = np.vstack([X, [0.5 * (X[a] + X[b]) for a, b in middles]])
        cells = np.hstack([cells, more])
    found = chains(X, border(cells))
    assert len(found) == 2 and all((line[0] == line[-1]).all() for line in found)
    lengths = sorted(float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()) for line in found)
    assert lengths == pytest.approx([8.0, 16.0])


def test_first_order_is_left_as_it_is():
    corners = CELLS[:, :3]
    assert np.array_equal(polygons(X, corners), X[corners])
    assert border(corners).shape == (4, 2)
