"""Tractions taken out of nodal stresses, beside projections by numpy."""

import numpy as np
import pytest

from restshape import _kernels

TENSOR = [[0, 2, 5], [2, 1, 4], [5, 4, 3]]


def cleaned(normals, constrained, stress):
    nodal = stress.copy()
    _kernels.remove_tractions(np.array(normals), np.array(constrained, dtype=np.uint8), nodal)
    return nodal


def test_one_normal_takes_its_traction_and_leaves_what_lies_in_the_face():
    rng = np.random.default_rng(0)
    normal = rng.normal(size=3)
    normal /= np.linalg.norm(normal)
    normals, stress = np.zeros((3, 1, 3)), rng.normal(size=(2, 1, 6))
    normals[1, 0] = normal
    P = np.eye(3) - np.outer(normal, normal)
    for before, after in zip(stress[:, 0, TENSOR], cleaned(normals, [[0, 0, 0]], stress)[:, 0, TENSOR]):
        np.testing.assert_allclose(after @ normal, 0.0, atol=1e-14)
        np.testing.assert_allclose(after, P @ before @ P, atol=1e-14)


def test_three_normals_leave_nothing_and_two_alike_count_once():
    stress = np.ones((1, 2, 6))
    normals = np.zeros((3, 2, 3))
    normals[:, 0] = [[1, 0, 0], [0.6, 0.8, 0], [0, 0, 1]]
    normals[:2, 1] = [[0, 0, 1], [0, 0, -1]]
    found = cleaned(normals, np.zeros((2, 3)), stress)
    np.testing.assert_allclose(found[0, 0], 0.0, atol=1e-15)
    np.testing.assert_allclose(found[0, 1], [1, 1, 1, 0, 0, 0], atol=1e-15)


def test_nodes_that_are_held_or_inside_stay():
    normals = np.zeros((3, 2, 3))
    normals[0, 0] = [1, 0, 0]
    stress = np.arange(12.0).reshape(1, 2, 6)
    np.testing.assert_array_equal(cleaned(normals, [[0, 1, 0], [0, 0, 0]], stress), stress)


def test_what_does_not_fit_is_refused():
    with pytest.raises(ValueError, match="normals"):
        cleaned(np.zeros((3, 2, 3)), np.zeros((1, 3)), np.zeros((1, 1, 6)))
    with pytest.raises(ValueError, match="constrained"):
        cleaned(np.zeros((3, 1, 3)), np.zeros((2, 3)), np.zeros((1, 1, 6)))
