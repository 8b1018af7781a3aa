"""What steps of cloth ask of places, beside numpy's answer."""

import numpy as np
import pytest

from restshape import _kernels


def test_the_farthest_way_is_measured_from_the_mean_way():
    random = np.random.default_rng(0)
    before, ways = random.normal(size=(40, 3)), random.normal(size=(40, 3))
    known = np.linalg.norm(ways - ways.mean(axis=0), axis=1).max()
    assert _kernels.farthest_apart(before, before + ways) == pytest.approx(known, rel=1e-13)
    assert _kernels.farthest_apart(before, before + np.array([3.0, -1.0, 7.0])) < 1e-14
    ways[7, 1] = np.nan
    assert np.isnan(_kernels.farthest_apart(before, before + ways))
    with pytest.raises(ValueError, match="after must have the shape of before"):
        _kernels.farthest_apart(before, before[:-1])


def test_the_least_slide_leaves_out_the_way_along_normals():
    random = np.random.default_rng(1)
    x, nodes, start = random.normal(size=(30, 3)), np.array([3, 8, 3, 29]), random.normal(size=(4, 3))
    normals = random.normal(size=(4, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    ways = x[nodes] - start
    known = np.linalg.norm(ways - (ways * normals).sum(axis=1)[:, None] * normals, axis=1).min()
    assert _kernels.least_slide(x, nodes, start, normals) == pytest.approx(known, rel=1e-13)
    none = np.empty((0, 3))
    assert _kernels.least_slide(x, np.empty(0, np.int64), none, none) == np.inf
    with pytest.raises(ValueError, match="out of range"):
        _kernels.least_slide(x, np.array([3, 8, 3, 30]), start, normals)


def test_values_are_the_same_where_all_of_them_are():
    x = np.random.default_rng(2).normal(size=(9, 3))
    other = x.copy()
    assert _kernels.same_values(x, other)
    other[8, 2] = np.nextafter(other[8, 2], 9.0)
    assert not _kernels.same_values(x, other)
    assert not _kernels.same_values(x, x[:-1])
    other[8, 2] = np.nan
    assert not _kernels.same_values(other, other)
