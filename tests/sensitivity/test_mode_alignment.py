"""Modes of several solutions in one basis: signs, order, and turns within clusters."""

import numpy as np
import pytest

from restshape.sensitivity.mode_alignment import turning


def modes_and_mass(count=5, size=40, seed=2):
    """Modes (k, n) orthonormal in a mass, and the mass."""
    random = np.random.default_rng(seed)
    root = random.standard_normal((size, size))
    mass = root @ root.T + size * np.eye(size)
    modes = random.standard_normal((count, size))
    return np.linalg.solve(np.linalg.cholesky(modes @ mass @ modes.T), modes), mass


def test_signs_order_and_turns_are_found():
    modes, mass = modes_and_mass()
    angle = 0.7
    turn = np.eye(5)
    turn[2:4, 2:4] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    other = np.diag([1, -1, 1, 1, -1]) @ turn @ np.eye(5)[[1, 0, 2, 3, 4]] @ modes
    found = turning(modes @ mass, other)
    np.testing.assert_allclose(found @ other, modes, atol=1e-12)
    np.testing.assert_allclose(found @ found.T, np.eye(5), atol=1e-12)


def test_modes_that_have_changed_a_little_are_brought_closest():
    modes, mass = modes_and_mass()
    changed = modes + 1e-3 * np.random.default_rng(0).standard_normal(modes.shape)
    mixed = np.linalg.qr(np.random.default_rng(1).standard_normal((5, 5)))[0] @ changed
    found = turning(modes @ mass, mixed)
    assert np.linalg.norm(found @ mixed - modes) < 1.1 * np.linalg.norm(changed - modes)


@pytest.mark.parametrize("lost", [0, 4])
def test_a_mode_that_is_gone_is_not_mixed(lost):
    modes, mass = modes_and_mass(6)
    before = np.delete(modes, lost, axis=0)
    after = np.delete(modes, (lost + 1) % 6, axis=0)
    assert turning(after @ mass, before) is None
    assert turning(modes @ mass, before) is None
