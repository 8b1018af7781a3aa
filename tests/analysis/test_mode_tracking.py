"""Modes keep their ids by their shape."""

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from restshape.analysis.modal.mode_tracking import SAME, ModeIds, assigned


def followed(before, after):
    """Ids of `after` when `before` had theirs from 1."""
    after, heavy = after.copy(), after.copy()
    ids = ModeIds.first(len(before), np.arange(len(before))).track(before, after, heavy, np.ones(len(before)))
    return ids.ids, after


def test_modes_that_cross_exchange_their_ranks_and_keep_their_numbers():
    numbers, _ = followed(np.eye(3), np.eye(3)[[1, 0, 2]])
    assert list(numbers) == [2, 1, 3]


def test_sign_follows_the_mode():
    _, after = followed(np.eye(2), -np.eye(2))
    assert np.array_equal(after, np.eye(2))


def test_mode_from_above_gets_a_new_number_and_an_old_one_keeps_its_own():
    numbers, _ = followed(np.eye(4)[:2], np.eye(4)[[3, 0]])
    assert list(numbers) == [3, 1]


def test_a_stranger_that_looks_a_little_like_a_lost_mode_does_not_get_its_number():
    leak = 1e-4
    stranger = np.array([0.0, leak, np.sqrt(1 - leak**2), 0.0])
    numbers, _ = followed(np.eye(4)[:2], np.stack([np.eye(4)[0], stranger]))
    assert list(numbers) == [1, 3]


def test_modes_on_another_mesh_are_compared_in_its_mass():
    after = np.eye(2)[[1, 0]]
    ids = ModeIds.first(2, np.arange(2)).track(3.0 * np.eye(2), after, after.copy(), np.full(2, 9.0))
    assert list(ids.ids) == [2, 1]


def test_modes_that_turn_in_a_pair_keep_the_nearer_number():
    c, s = np.cos(0.5), np.sin(0.5)
    numbers, _ = followed(np.eye(2), np.array([[c, s], [-s, c]]))
    assert list(numbers) == [1, 2]


def test_first_numbers_go_to_the_modes_that_are_asked_for():
    assert list(ModeIds.first(4, np.array([1, 3])).ids) == [3, 1, 4, 2]


@pytest.mark.parametrize("shape", [(9, 9), (5, 5), (4, 7), (7, 4), (6, 3), (1, 3), (0, 2), (2, 0)])
@pytest.mark.parametrize("turned", [0.05, 0.5, 3.0])
def test_ids_go_to_the_modes_that_are_most_alike_together(shape, turned):
    """As by SciPy, of those that are alike at all; also where modes have turned so far that few are the most alike."""
    random = np.random.default_rng(3)
    for _ in range(50):
        basis, _ = np.linalg.qr(np.eye(9) + turned * random.normal(size=(9, 9)))
        mac = (np.eye(9)[: shape[0]] @ basis[:, random.permutation(9)[: shape[1]]]) ** 2
        rows, columns = linear_sum_assignment(-mac)
        alike = mac[rows, columns] >= SAME
        found = assigned(mac)
        kept = [(row, column) for row, column in enumerate(found) if column >= 0 and mac[row, column] >= SAME]
        assert kept == [*zip(rows[alike], columns[alike])]


def test_a_mode_that_is_no_number_is_refused():
    mac = np.full((2, 2), 0.9)
    mac[0, 1] = np.nan
    with pytest.raises(ValueError, match="invalid"):
        assigned(mac)
