"""Which way round seams are sewn that do not say it: by their ends, then by the energy of springs, then by faces."""

import numpy as np
import pytest

from restshape.physics.cloth.seams.seam_lines import ALIKE, SeamLine, turned_round


def side(points) -> tuple[np.ndarray, SeamLine, int]:
    """Places (n, 3) of a side along a line of places, with its nodes from 0."""
    x = np.asarray(points, float)
    return x, SeamLine(np.arange(len(x)), np.ones(len(x) - 1)), len(x)


def turned(first, second, lengths=None) -> bool:
    """Whether two sides at these places in space belong together with the second one turned round.

    They lie straight in the pattern, with nodes at even distances, or at these lengths (p,), (q,).
    """
    (x, one, n), (y, other, m) = side(first), side(second)
    a, b = lengths or (np.arange(n), np.arange(m))
    X = np.column_stack([np.concatenate([a, b]), np.repeat([0.0, 5.0], [n, m])]).astype(float)
    return turned_round(X, np.vstack([x, y]), one, SeamLine(other.nodes + n, other.along))


BESIDE = np.array([0.0, 0.3, 0.0])
EDGE = np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [1.0, 0.0, 0.0]])


def test_nearer_ends_belong_together():
    assert not turned(EDGE, EDGE + BESIDE)
    assert turned(EDGE, EDGE[::-1] + BESIDE)


def test_ends_that_are_clearly_nearer_decide_whatever_lies_between():
    far = EDGE[::-1] + BESIDE
    far[1] = (0.5, 40.0, 0.0)
    assert turned(EDGE, far)


@pytest.mark.parametrize("order", [1, -1])
def test_where_ends_are_alike_springs_decide(order):
    """A closed edge around a closed edge, as a sleeve in its armhole: ends are one place, both ways round as near."""
    angle = np.linspace(0.0, 2.0 * np.pi, 17)
    ring = np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
    other = np.stack([1.1 * np.cos(angle), 1.1 * np.sin(angle), 0.1 + 0.0 * angle], axis=1)[::order]
    assert turned(ring, other) is (order < 0)


def test_springs_are_compared_by_share_of_length():
    """Two zigzags with alike ends: by lengths in the pattern their corners belong together in one pairing alone."""
    first = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
    second = np.array([[1.0, 0.5, 0.5], [0.0, 0.0, 1.2], [-1.0, 0.5, -0.5]])
    a, b, c, d = first[0], first[-1], second[0], second[-1]
    ways = [np.sum((a - p) ** 2) + np.sum((b - q) ** 2) for p, q in ((c, d), (d, c))]
    assert abs(ways[0] - ways[1]) < ALIKE * max(ways)
    # The corner lies at a tenth of the first side, and at a tenth or nine tenths of the second one.
    near, far = np.array([0.0, 0.1, 1.0]), np.array([0.0, 0.9, 1.0])
    assert not turned(first, second, (near, near)) and turned(first, second, (near, far))


def test_where_all_is_alike_the_same_face_is_outside():
    """Edges that cross at a right angle in their middles' line: no end is nearer, and springs have one energy."""
    across = np.array([[0.5, 1.0, -0.5], [0.5, 1.0, 0.0], [0.5, 1.0, 0.5]])
    assert turned(EDGE, across) and turned(EDGE, across[::-1])
