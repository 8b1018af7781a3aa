"""Recovered stresses at nodes: exact where stresses are linear, and one value a side between materials."""

import numpy as np
import pytest
from small_scenes import HEAD, block

from restshape import _kernels
from restshape.interface.first_frame import first_frame

TWO_MATERIALS = """
[shape.regions]
soft = { polygon = [[0.2, 0.1], [0.8, 0.1], [0.8, 0.4], [0.2, 0.4]] }
[material.stiff]
E = 1e11
nu = 0.0
[material.soft]
E = 1e9
nu = 0.0
region = "soft"
[effects]
solid = { model = "plane_stress" }
[supports]
strained = { on = "all", fix = { x = "1e-3*x", y = 0 } }
[mesh]
size = 0.08
[quantities]
soft_most = { stress = "xx", at = "soft", reduce = "max" }
soft_least = { stress = "xx", at = "soft", reduce = "min" }
most = { stress = "xx", reduce = "max" }
least = { stress = "xx", reduce = "min" }
border_most = { stress = "xx", at = "soft.1", reduce = "max" }
"""
PARALLEL = HEAD + block(1.0, 0.5) + TWO_MATERIALS


def test_each_material_has_its_own_stress_at_their_border(tmp_path):
    # A uniform strain of 1e-3 is imposed on every node: the stress is E times it on either side.
    (tmp_path / "parallel.toml").write_text(PARALLEL)
    row = first_frame(tmp_path / "parallel.toml").row
    assert row["q_soft_most"] == pytest.approx(1e6, rel=1e-9)
    assert row["q_soft_least"] == pytest.approx(1e6, rel=1e-9)
    assert row["q_most"] == pytest.approx(1e8, rel=1e-9)
    assert row["q_least"] == pytest.approx(1e6, rel=1e-9)
    assert row["q_border_most"] == pytest.approx(1e8, rel=1e-9)


def grid(side, rng):
    """Nodes (side^2, 2) of a square, many of them in random order, and triangles; which nodes are inside."""
    places = np.array([(i, j) for j in range(side) for i in range(side)], dtype=float)
    inner = (places > 0).all(axis=1) & (places < side - 1).all(axis=1)
    X = places + np.where(inner[:, None], rng.uniform(-0.25, 0.25, places.shape), 0.0)
    corners = [j * side + i for j in range(side - 1) for i in range(side - 1)]
    quads = np.array([(k, k + 1, k + side + 1, k + side) for k in corners])
    cells = np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    order = rng.permutation(len(X)) if len(X) > 2048 else np.arange(len(X))
    return X[np.argsort(order)], np.ascontiguousarray(order[cells], dtype=np.int32), inner[np.argsort(order)]


@pytest.mark.parametrize("side", [7, 70])
def test_linear_stresses_are_recovered_exactly_at_inner_and_boundary_nodes(side):
    """Of few nodes, and of so many that they are taken in blocks, neighbours in different ones."""
    rng = np.random.default_rng(3)
    X, cells, inner = grid(side, rng)
    slopes = rng.normal(size=(3, 4))

    def field(places):
        return np.column_stack([np.ones(len(places)), places]) @ slopes

    out = np.empty((len(X), 4))
    patches = _kernels.PatchRecovery(cells, cells, len(X))
    patches(X, np.ascontiguousarray(field(X[cells].mean(axis=1))), out)
    # The two corners that only one triangle touches have no inner node beside them where the diagonal cuts them off.
    near = np.isin(np.arange(len(X)), np.unique(cells[np.isin(cells, np.flatnonzero(inner)).any(axis=1)]))
    assert near.sum() >= len(X) - 2
    assert np.abs(out - field(X))[near].max() < 1e-12 * side**2


@pytest.mark.parametrize("side", [7, 40, 70])
def test_values_at_random_are_fitted_to_the_cells_around_each_node(side):
    """By least squares of NumPy at inner nodes; at others the mean of what those beside them, cell by cell, say there.

    Of a linear field any cells would do, those of other nodes as well.
    """
    rng = np.random.default_rng(4)
    X, cells, inner = grid(side, rng)
    values, out = rng.normal(size=(len(cells), 4)), np.empty((len(X), 4))
    _kernels.PatchRecovery(cells, cells, len(X))(X, values, out)
    own, order = np.repeat(np.arange(len(cells)), 3), np.argsort(cells.ravel(), kind="stable")
    around = np.split(own[order], np.cumsum(np.bincount(cells.ravel()))[:-1])
    centres = X[cells].mean(axis=1)

    def fitted(node, place):
        rows = np.column_stack([np.ones(len(around[node])), centres[around[node]] - place])
        return np.linalg.lstsq(rows, values[around[node]], rcond=None)[0][0]

    for node in range(len(X)):
        beside = [k for e in around[node] for k in cells[e] if inner[k]]
        if inner[node]:
            expected = fitted(node, X[node])
        elif beside:
            expected = np.mean([fitted(k, X[node]) for k in beside], axis=0)
        else:
            expected = values[around[node]].mean(axis=0)
        np.testing.assert_allclose(out[node], expected, rtol=0.0, atol=1e-9)


def test_nodes_that_lose_their_polynomial_get_what_is_beside_them():
    """Triangles of a half that is pressed onto a line have centres on it; and back: as of a recovery that is new."""
    rng = np.random.default_rng(6)
    X, cells, _ = grid(12, rng)
    flat = X.copy()
    flat[:, 1] = np.where(X[:, 0] < 5.0, X[:, 0] + 1e-6 * X[:, 1], X[:, 1])
    values, found = rng.normal(size=(len(cells), 4)), []
    kept = _kernels.PatchRecovery(cells, cells, len(X))
    for places in (X, flat, X):
        out, new = np.empty((len(X), 4)), np.empty((len(X), 4))
        kept(places, values, out)
        _kernels.PatchRecovery(cells, cells, len(X))(places, values, new)
        np.testing.assert_array_equal(out, new)
        found.append(out)
    # Where all around a node is flat it has the mean of its triangles.
    node = np.argmin(np.abs(X - 2.0).sum(axis=1))
    plain = values[(cells == node).any(axis=1)].mean(axis=0)
    np.testing.assert_allclose(found[1][node], plain, rtol=1e-12)
    assert np.abs(found[0][node] - plain).max() > 1e-3


@pytest.mark.parametrize("each", [False, True])
@pytest.mark.parametrize("jumps", [False, True])
def test_one_loop_over_triangles_gives_the_bits_of_one_after_the_other(each, jumps):
    """Stresses, energies, recovered stresses and von Mises' of them, of all triangles and of two materials."""
    rng = np.random.default_rng(5)
    X, cells, _ = grid(60, rng)
    x, parameters = rng.normal(size=X.shape), np.array([3.0, 5.0, 0.5, 0.1, 0.2])
    if each:
        parameters = parameters * rng.uniform(0.5, 2.0, (len(cells), 1))
    rows, count = cells, len(X)
    if jumps:
        rows, count = cells.copy(), 2 * len(X)
        rows[len(cells) // 3 :] += len(X)
    patches = _kernels.PatchRecovery(cells, rows, count)
    for plane_stress in (True, False):
        stress, energy = _kernels.triangle_stress(X, x, cells, parameters, plane_stress)
        nodal = np.empty((count, 4))
        patches(X, stress, nodal)
        found = [np.full(shape, np.nan) for shape in ((len(cells),), (len(cells), 4), (count, 4), (count,))]
        patches.triangles(X, x, parameters, plane_stress, *found)
        for one, expected in zip(found, (energy, stress, nodal, _kernels.von_mises(nodal))):
            np.testing.assert_array_equal(one, expected)
        some = [np.full_like(one, np.nan) for one in found]
        patches.triangles(X, x, parameters, plane_stress, some[0], None, None, some[3])
        np.testing.assert_array_equal(some[0], energy)
        np.testing.assert_array_equal(some[3], found[3])


def test_results_without_room_are_refused():
    X, cells, _ = grid(7, np.random.default_rng(1))
    patches, x = _kernels.PatchRecovery(cells, cells, len(X)), np.zeros_like(X)
    energy, parameters = np.empty(len(cells)), np.ones(5)
    with pytest.raises(ValueError, match="all nodes"):
        patches.triangles(X[:-1].copy(), x, parameters, True, energy, None, None, None)
    with pytest.raises(ValueError, match=r"x must be \(n, 2\)"):
        patches.triangles(X, x[:-1].copy(), parameters, True, energy, None, None, None)
    with pytest.raises(ValueError, match="params"):
        patches.triangles(X, x, parameters[:3].copy(), True, energy, None, None, None)
    for wrong in ((np.empty(4), None, None), (None, np.empty(4), None), (None, None, np.empty(4))):
        with pytest.raises(ValueError, match="as many numbers"):
            patches.triangles(X, x, parameters, True, energy, *wrong)


def test_patches_of_cells_that_do_not_fit_are_refused():
    cells, X = np.array([[0, 1, 2]], dtype=np.int32), np.zeros((2, 2))
    for wrong, rows in ((cells - 1, cells), (cells, cells + 1), (cells, cells - 1)):
        with pytest.raises(ValueError, match="do not exist"):
            _kernels.PatchRecovery(wrong, rows, 3)
    with pytest.raises(ValueError, match="all nodes"):
        _kernels.PatchRecovery(cells, cells, 3)(X, np.zeros((1, 4)), np.zeros((3, 4)))


def test_patches_follow_a_flip_as_new_ones_do():
    X = np.array([[0.0, 0.0], [2.0, 0.1], [2.2, 2.0], [-0.1, 1.9], [0.9, 0.8], [1.2, 1.3]])
    before = np.array([[0, 1, 4], [1, 5, 4], [1, 2, 5], [2, 3, 5], [3, 4, 5], [3, 0, 4]], dtype=np.int32)
    after = np.array([[0, 1, 4], [1, 2, 4], [2, 5, 4], [2, 3, 5], [3, 4, 5], [3, 0, 4]], dtype=np.int32)
    stress = np.random.default_rng(2).normal(size=(6, 4))
    patches, found, expected = _kernels.PatchRecovery(before, before, 6), np.empty((6, 4)), np.empty((6, 4))
    patches(X, stress, found)
    patches.follow(after, after)
    patches(X, stress, found)
    _kernels.PatchRecovery(after, after, 6)(X, stress, expected)
    np.testing.assert_array_equal(found, expected)
    with pytest.raises(ValueError, match="as many cells"):
        patches.follow(after[:5], after[:5])
