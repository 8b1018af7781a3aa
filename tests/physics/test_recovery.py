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


def test_linear_stresses_are_recovered_exactly_at_inner_and_boundary_nodes():
    rng = np.random.default_rng(3)
    grid = np.array([(i, j) for j in range(7) for i in range(7)], dtype=float)
    inner = (grid > 0).all(axis=1) & (grid < 6).all(axis=1)
    X = grid + np.where(inner[:, None], rng.uniform(-0.25, 0.25, grid.shape), 0.0)
    quads = np.array([(j * 7 + i, j * 7 + i + 1, j * 7 + i + 8, j * 7 + i + 7) for j in range(6) for i in range(6)])
    cells = np.ascontiguousarray(np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]), dtype=np.int32)
    slopes = rng.normal(size=(3, 4))

    def field(places):
        return np.column_stack([np.ones(len(places)), places]) @ slopes

    out = np.empty((len(X), 4))
    patches = _kernels.PatchRecovery(cells, cells, len(X))
    patches(X, np.ascontiguousarray(field(X[cells].mean(axis=1))), out)
    # The two corners that only one triangle touches have no inner node beside them where the diagonal cuts them off.
    near = np.isin(np.arange(len(X)), np.unique(cells[np.isin(cells, np.flatnonzero(inner)).any(axis=1)]))
    assert near.sum() >= len(X) - 2
    assert np.abs(out - field(X))[near].max() < 1e-12


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
