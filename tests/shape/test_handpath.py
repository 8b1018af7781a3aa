"""Paths of a hand: closed form of the minimum-jerk law, exact ends, pauses, repeatability."""

import numpy as np
import pytest

from restshape.shape.hand.handpath import cursor_path, minimum_jerk


def test_the_law_is_the_minimiser_of_squared_jerk():
    n = 60
    t = np.linspace(0, 1, n + 1)[1:-1]

    def jerk(inner):
        """The third differences, with two more points at rest on either side."""
        x = np.concatenate([[0.0] * 3, inner, [1.0] * 3])
        return np.diff(x, 3) * n**3

    # Jerk is linear in the places: its squares are least where numpy's least squares have them.
    fixed = jerk(np.zeros_like(t))
    found = np.linalg.lstsq(np.column_stack([jerk(one) - fixed for one in np.eye(t.size)]), -fixed, rcond=None)[0]
    # The least of the continuous problem is 720; ends that rest for two steps are 2/n off.
    assert np.sum(jerk(minimum_jerk(t)) ** 2) / n == pytest.approx(720, rel=0.5)
    assert np.abs(found - minimum_jerk(t)).max() < 0.05
    assert minimum_jerk(np.array([0.0, 0.5, 1.0])).tolist() == [0.0, 0.5, 1.0]


@pytest.mark.parametrize("style", ["straight", "jerk", "hand-like"])
@pytest.mark.parametrize("frames", [1, 2, 3, 17, 160])
@pytest.mark.parametrize("pause", [0, 5])
def test_paths_have_their_length_and_end_exactly(style, frames, pause):
    start, step = (0.1, 0.7), (0.3, -0.123456789012345)
    path = cursor_path(start, step, frames, style, pause, seed=4)
    assert len(path) == frames
    assert path[-1] == (start[0] + step[0], start[1] + step[1])
    assert path == cursor_path(start, step, frames, style, pause, seed=4)


def test_a_hand_rests_trembles_and_jerks():
    path = np.array(cursor_path((0, 0), (1, 0), 160, "hand-like", seed=1))
    speed = np.hypot(*np.diff(path, axis=0).T)
    assert (speed == 0).sum() == 160 // 12
    # Without a jerk the greatest speed of 147 moving frames would be 1.875 / 147.
    assert speed.max() > 2 * 1.875 / 147
    assert 1e-4 < np.abs(path[:, 1]).max() < 0.005
    assert path.tolist() != np.array(cursor_path((0, 0), (1, 0), 160, "hand-like", seed=2)).tolist()


def test_an_even_path_is_even():
    path = np.array(cursor_path((1, 2), (4, 8), 4))
    np.testing.assert_allclose(path, [[2, 4], [3, 6], [4, 8], [5, 10]], atol=1e-12)
