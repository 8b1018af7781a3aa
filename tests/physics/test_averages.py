"""Means count by length and area, not by nodes: they are those of the field, on any mesh."""

from types import SimpleNamespace

import numpy as np
import pytest
from large import solid
from small_scenes import HEAD, HOLE, block, make_replay, meshed, rows_of, write_scene

from restshape import _kernels
from restshape.fem.averages import facet_weights, node_weights

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
    assert _kernels.place_weights(X, cell, "cells").sum() == pytest.approx(0.5 + 2 / 3 * height * np.sqrt(2), rel=1e-12)
    assert facet_weights(ARC, np.array([[0, 1, 2]], dtype=np.int32)).sum() == pytest.approx(np.pi / 2, rel=0.011)
    np.testing.assert_allclose(facet_weights(X, np.array([[0, 1]], dtype=np.int32)), [[0.5, 0.5]])


@pytest.mark.parametrize("count", [3, 400])
def test_few_nodes_of_many_have_the_mean_of_all_weights(count):
    """In any order, and one of them twice: as by the weights of all nodes."""
    rng = np.random.default_rng(1)
    X, places = rng.normal(size=(1000, 2)), rng.integers(0, 1000, (2000, 2)).astype(np.int32)
    nodes = rng.permutation(places[:, 0])[:count].copy()
    nodes[1] = nodes[0]
    values, each = rng.normal(size=count), _kernels.place_weights(X, places, "facets")
    weights = np.bincount(places.ravel(), each.ravel(), len(X))[nodes]
    found = _kernels.mean_at(X, places, "facets", nodes, values)
    assert found == pytest.approx((weights * values).sum() / weights.sum(), rel=1e-12)


def test_a_mean_follows_flips_and_nodes():
    """Two triangles of a square of which one diagonal counts double, then the other; then the square is a trapezium."""
    X = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    space = SimpleNamespace(X=X, cells=np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32), topology=1)
    space.cells_of = lambda name: np.array([0, 1])
    values = np.array([6.0, 0, 0, 0])
    weights = node_weights(space, "core", slice(None))
    assert weights.mean(values) == pytest.approx(2.0) and weights()[0] == pytest.approx(1 / 3)
    space.cells[:] = [[0, 1, 3], [1, 2, 3]]
    space.topology = 2
    assert weights.mean(values) == pytest.approx(1.0) and weights().sum() == pytest.approx(1.0)
    X[1] = [3, 0]
    # Areas 3/2 and 1/2: a third of the first over both.
    assert weights.mean(values) == pytest.approx(6.0 * 0.5 / 2.0)


def test_a_node_that_is_named_twice_counts_twice():
    X, facets = np.array([[0.0, 0], [2, 0], [3, 0]]), np.array([[0, 1], [1, 2]], dtype=np.int32)
    at, values = np.array([0, 1, 1, 2], dtype=np.int32), np.array([1.0, 2.0, 4.0, 8.0])
    found = _kernels.mean_at(X, facets, "facets", at, values)
    assert found == pytest.approx((1.0 * 1 + 1.5 * (2 + 4) + 0.5 * 8) / 4.5)


def test_what_does_not_fit_is_refused():
    X, facets, at = np.zeros((2, 2)), np.array([[0, 2]], dtype=np.int32), np.array([0], dtype=np.int32)
    with pytest.raises(ValueError, match="do not exist"):
        _kernels.place_weights(X, facets, "facets")
    with pytest.raises(ValueError, match="cells must be"):
        _kernels.place_weights(X, facets, "cells")
    with pytest.raises(ValueError, match="as many values"):
        _kernels.mean_at(X, facets - facets, "facets", at, np.zeros(2))
