"""Smoothing: short waves go, straight curves and ends stay."""

import numpy as np
import pytest
from shape_scenes import plate, scene_and_script, shape

from restshape.errors import UserError
from restshape.shape.chain import Chain
from restshape.shape.hand.fairing import ZIGZAG, bending, smooth
from restshape.shape.session import EditSession


def wavy(y):
    """A strip whose lower edge is a polyline through the heights y, evenly spaced."""
    x = np.linspace(0.0, 3.0, len(y))
    inner = np.column_stack([x, y])[1:-1].tolist()
    edges = {"low": {"polyline": ["a", "b"], "through": inner}}
    edges |= {name: {"line": list(name)} for name in ("bc", "cd", "da")}
    corners = {"a": [0, y[0]], "b": [3, y[-1]], "c": [3, 2], "d": [0, 2]}
    return shape(vertices=corners, edges=edges, outline=["low", "bc", "cd", "da"])


@pytest.mark.parametrize("waves", [1, 3, 6])
def test_a_wave_on_a_closed_curve_has_the_value_of_the_fourth_difference(waves):
    n = 12
    chain = Chain("ring", (), (), np.arange(n), True, 0.7 * np.arange(n), 0.7 * n)
    wave = np.cos(2.0 * np.pi * waves * np.arange(n) / n)
    expected = (2.0 - 2.0 * np.cos(2.0 * np.pi * waves / n)) ** 2
    np.testing.assert_allclose(bending(chain) @ wave, expected * wave, atol=1e-12)
    if waves == n / 2:
        assert expected == pytest.approx(ZIGZAG)


def test_the_step_solves_the_equations_of_its_minimum():
    rng = np.random.default_rng(3)
    outline = wavy(np.concatenate([[0.0], 0.2 * rng.random(7), [0.0]]))
    chosen, before = outline.layout.controls[0], outline.points
    after = smooth(outline, "low", 0.4).points((1.0, 0.0))

    # Bending measured along the old curve, plus the way: no small step of a free point makes the sum less.
    s = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(before[chosen], axis=0).T))])
    h = np.diff(s) / np.diff(s).mean()

    def cost(points):
        slopes = np.diff(points, axis=0) / h[:, None]
        curvature = np.diff(slopes, axis=0) * np.sqrt(2.0 / (h[1:] + h[:-1]))[:, None]
        return 0.4 / (16.0 * 0.6) * (curvature**2).sum() + ((points - before[chosen]) ** 2).sum()

    best = cost(after[chosen])
    for i in range(1, len(chosen) - 1):
        for step in ([1e-3, 0], [-1e-3, 0], [0, 1e-3], [0, -1e-3]):
            other = after[chosen].copy()
            other[i] += step
            assert cost(other) > best
    np.testing.assert_array_equal(after[chosen[[0, -1]]], before[chosen[[0, -1]]])


def test_a_straight_curve_stays_and_pins_stay():
    assert np.abs(smooth(wavy(np.zeros(6)), "low", 0.9).basis).max() < 1e-15
    outline = wavy([0, 0.1, 0, 0.1, 0, 0.1, 0])
    gesture = smooth(outline, "low", 0.5, [(0.5, 0.1)])
    assert not gesture.basis[:, outline.layout.controls[0][1]].any()
    assert gesture.basis[0, outline.layout.controls[0][2]].any()


def test_what_cannot_be_smoothed_is_refused():
    with pytest.raises(UserError, match="no control point between its ends"):
        smooth(plate(), "bottom", 0.5)
    with pytest.raises(UserError, match="b is not a vertex of top"):
        smooth(plate(), "top", 0.5, ["b"])


def test_a_session_smooths_in_equal_parts_and_undoes(tmp_path):
    events = [{"do": "smooth", "on": "top", "strength": 0.6, "frames": 4}, {"do": "undo"}, {"do": "redo"}]
    frames = list(EditSession(*scene_and_script(tmp_path, events)).frames())
    assert [f.change for f in frames] == ["start", *["move"] * 6]
    points = [f.outline.points for f in frames]
    for i in range(1, 4):
        np.testing.assert_allclose(points[i + 1] - points[i], points[1] - points[0], atol=1e-15)
    np.testing.assert_array_equal(points[5], points[0])
    np.testing.assert_array_equal(points[6], points[4])
