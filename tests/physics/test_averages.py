"""Means count by length and area, not by nodes: they are those of the field, on any mesh."""

import numpy as np
import pytest
from large import solid
from small_scenes import HEAD, HOLE, block, make_replay, meshed, rows_of, write_scene

from restshape.fem.averages import cell_weights, facet_weights

ARC = np.array([[1.0, 0], [0, 1], [np.sqrt(0.5), np.sqrt(0.5)]])


def stretched(near, order):
    """A block stretched along x by 1 % of x^2 at its whole outline, with small triangles in one corner."""
    return (
        HEAD
        + block()
        + HOLE
        + "[material.m]\nE = 1e6\nnu = 0.3\n"
        + solid()
        + '[supports.round]\non = ["outline", "window"]\nfix = { x = "0.01*x^2", y = 0 }\n'
        + meshed(0.15, order)
        + f"[mesh.near]\nb = {near}\n"
        + '[quantities]\nbottom = { displacement = "x", at = "bottom", reduce = "mean" }\n'
        + 'corner = { displacement = "x", at = "c", reduce = "mean" }\n'
        + 'whole = { displacement = "x", reduce = "mean" }\n'
    )


@pytest.mark.parametrize("order", [1, 2])
def test_small_triangles_in_a_corner_do_not_pull_a_mean_there(tmp_path, order):
    found = [rows_of(make_replay(write_scene(tmp_path, stretched(near, order))))[0] for near in (0.15, 0.01)]
    for row in found:
        # The mean of x^2 from 0 to 1; a mean of nodes would be near 0.8 in the second.
        assert row["q_bottom"] == pytest.approx(0.01 / 3, rel=0.02 if order == 1 else 1e-3)
        assert row["q_corner"] == pytest.approx(0.01, rel=1e-12)
    assert found[0]["q_whole"] == pytest.approx(found[1]["q_whole"], rel=0.02)


def test_weights_of_a_curved_side_are_its_length_and_those_of_its_triangle_its_area():
    X = np.array([[0.0, 0], [1, 0], [0, 1], [0.5, 0], [0.7, 0.7], [0, 0.5]])
    cell = np.arange(6, dtype=np.int32)[None]
    # A parabola beyond the chord: two thirds of its height times the chord.
    height = np.hypot(0.2, 0.2)
    assert cell_weights(X, cell).sum() == pytest.approx(0.5 + 2 / 3 * height * np.sqrt(2), rel=1e-12)
    assert facet_weights(ARC, np.array([[0, 1, 2]])).sum() == pytest.approx(np.pi / 2, rel=0.011)
    np.testing.assert_allclose(facet_weights(X, np.array([[0, 1]])), [[0.5, 0.5]])
