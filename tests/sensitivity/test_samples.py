"""Moving least squares with derivatives: linear maps, samples that degenerate, and interpolation."""

from itertools import pairwise

import numpy as np
import pytest

from restshape import _kernels
from restshape.sensitivity.samples import DragSamples, SamplePlace

EPSILON = 10.0**-1.5


def samples_of(places, function, derivative, epsilon=EPSILON, size=1.0, most=10):
    """DragSamples of a function of the hand and of its derivative (2, n)."""
    found = DragSamples(None, size, epsilon, most)
    for k, c in enumerate(places):
        found.add(SamplePlace(tuple(c), k, "mesh"), function(c), derivative(c))
    return found


def by_the_book(hand, places, values, slopes, last, last_values, epsilon):
    """The formula of section 5.1.5 as it is printed, with p about the origin, by dense linear algebra."""
    p = lambda d: np.array([1.0, d[0], d[1]])  # noqa: E731
    dp = np.eye(3)[1:]
    w = lambda d: 1.0 / (np.sum((np.asarray(d) - hand) ** 2) + epsilon**2)  # noqa: E731
    g, right = np.zeros((3, 3)), np.zeros((3, values.shape[1]))
    if last is not None:
        g += w(last) * np.outer(p(last), p(last))
        right += w(last) * np.outer(p(last), last_values)
    for d, x, s in zip(places, values, slopes):
        g += w(d) * (np.outer(p(d), p(d)) + dp.T @ dp)
        right += w(d) * (np.outer(p(d), x) + dp.T @ s)
    return p(hand) @ np.linalg.solve(g, right)


@pytest.mark.parametrize("with_last", [False, True])
def test_the_kernel_is_the_formula(with_last):
    random = np.random.default_rng(3)
    places, values = random.standard_normal((4, 2)), random.standard_normal((4, 2500))
    slopes, last_values = random.standard_normal((4, 2, 2500)), random.standard_normal(2500)
    last, hand, size = np.array([0.3, -0.2]), np.array([0.25, 0.4]), 2.5
    rows = np.concatenate([last_values[None], *(np.vstack([x, s]) for x, s in zip(values, slopes))])
    out = np.empty(2500)
    factors = _kernels.gmls(hand, last if with_last else np.empty(0), places, size, EPSILON**2, rows, out)
    expected = by_the_book(
        hand / size, places / size, values, slopes * size, last / size if with_last else None, last_values, EPSILON
    )
    np.testing.assert_allclose(out, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    np.testing.assert_allclose(factors @ rows, out, rtol=0, atol=1e-12 * np.abs(out).max())
    # Constants are kept.
    assert factors[0] + factors[1::3].sum() == pytest.approx(1.0, abs=1e-14)


LAYOUTS = {
    "scattered": [(0.1, 0.2), (0.5, -0.3), (-0.4, 0.4), (0.9, 0.7)],
    "one": [(0.1, 0.2)],
    "ten on a line": [(0.1 * k, 0.05 * k) for k in range(10)],
    "far away": [(100.0, -40.0), (100.2, -40.1)],
}


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("epsilon", [EPSILON, 1e-6])
def test_linear_maps_are_reproduced_to_rounding(layout, epsilon):
    random = np.random.default_rng(1)
    a, b = random.standard_normal(30), random.standard_normal((2, 30))
    exact = lambda c: a + np.asarray(c) @ b  # noqa: E731
    found = samples_of(LAYOUTS[layout], exact, lambda c: b, epsilon)
    for last in (None, (0.6, 0.1), LAYOUTS[layout][0]):
        if last:
            found.set_last(last, exact(last))
        for hand in ((0.15, 0.22), (2.0, -3.0), LAYOUTS[layout][-1]):
            size = np.abs(exact(hand)).max() + np.abs(exact(found.c)).max()
            # A state and samples a hundred sizes apart weigh the ways that derivatives alone know 1e4 times less.
            least = 1e-11 if layout == "far away" else 1e-13
            np.testing.assert_allclose(found(hand), exact(hand), rtol=0, atol=least * size)


def test_repeated_places_are_no_harm():
    """Of the kernel, for `DragSamples` keeps none that repeat."""
    places, rows, out = np.tile([0.3, 0.4], (3, 1)), np.zeros((10, 2)), np.empty(2)
    rows[0], rows[1::3], rows[2::3], rows[3::3] = (1.3, 0.4), (1.3, 0.4), (1.0, 0.0), (0.0, 1.0)
    _kernels.gmls(np.array([0.5, 0.1]), np.array([0.3, 0.4]), places, 1.0, 1e-20, rows, out)
    np.testing.assert_allclose(out, (1.5, 0.1), rtol=0, atol=1e-14)


def curved(c):
    """A function that no plane fits, with its derivatives."""
    x, y = c
    return np.array([np.sin(2.0 * x) + y * y, np.exp(x - y)])


def curved_slopes(c):
    x, y = c
    return np.array([[2.0 * np.cos(2.0 * x), np.exp(x - y)], [2.0 * y, -np.exp(x - y)]])


def test_samples_are_interpolated_with_the_square_of_epsilon():
    """Three tenths apart the usual epsilon leaves about a hundredth; as it goes to 0 so does that, with its square."""
    places = [(0.0, 0.0), (0.3, 0.0), (0.0, 0.3), (0.3, 0.3)]
    errors = []
    for epsilon in (EPSILON, EPSILON / 2, EPSILON / 4, EPSILON / 8):
        found = samples_of(places, curved, curved_slopes, epsilon)
        errors.append(max(np.abs(found(c) - curved(c)).max() for c in places))
    assert 1e-4 < errors[0] < 0.02
    rates = [np.log2(a / b) for a, b in pairwise(errors)]
    assert rates[-1] == pytest.approx(2.0, abs=0.05) and rates[0] == pytest.approx(2.0, abs=0.3)


def test_more_samples_predict_better():
    hand = (0.15, 0.18)
    few = samples_of([(0.0, 0.0)], curved, curved_slopes)
    many = samples_of([(0.0, 0.0), (0.3, 0.1), (0.1, 0.3)], curved, curved_slopes)
    exact = curved(hand)
    assert np.linalg.norm(few(hand) - exact) > 1.5 * np.linalg.norm(many(hand) - exact)
    # Of one sample alone it is the prediction to first order.
    np.testing.assert_allclose(few(hand), curved((0, 0)) + np.array(hand) @ curved_slopes((0, 0)), rtol=1e-14)


def test_samples_that_are_near_each_other_do_not_weigh_alike():
    """A thin body is dragged by a small part of its diagonal, all of which is within epsilon."""
    scale, hand = 0.02, np.array([0.48, 0.47])
    fine = lambda c: curved(np.asarray(c) / scale)  # noqa: E731
    slopes = lambda c: curved_slopes(np.asarray(c) / scale) / scale  # noqa: E731
    places = [(0.0, 0.0), (0.5, 0.0), (0.0, 0.5), (0.5, 0.5)]
    near = samples_of([tuple(scale * x for x in c) for c in places], fine, slopes)
    far = samples_of(places, curved, curved_slopes)
    errors = [np.linalg.norm(one - curved(hand)) for one in (near(tuple(scale * hand)), far(tuple(hand)))]
    # Smoothed by the size they all weigh the same, and are off by what the plane through them is off.
    coarse = np.empty(2)
    _kernels.gmls(scale * hand, np.empty(0), scale * np.array(places), 1.0, EPSILON**2, near._rows, coarse)
    assert len(near) == 4 and max(errors) < 0.1 * np.linalg.norm(coarse - curved(hand))
    # Those that fill the shape are smoothed by its size, and those at one place as if they were a little apart.
    wide = samples_of([(0.0, 0.0), (3.0, 0.0)], curved, curved_slopes)
    assert wide.smoothing == EPSILON and samples_of([(0.1, 0.1)], curved, curved_slopes).smoothing == 1e-3 * EPSILON


def test_the_last_state_pulls_the_value_there():
    found = samples_of([(0.0, 0.0)], curved, curved_slopes)
    hand = (0.4, 0.4)
    before = np.abs(found(hand) - curved(hand)).max()
    found.set_last((0.39, 0.4), curved((0.39, 0.4)))
    assert np.abs(found(hand) - curved(hand)).max() < 0.1 * before


def test_too_many_samples_and_too_near_ones_go():
    found = samples_of([(0.1 * k, 0.0) for k in range(10)], curved, curved_slopes)
    assert len(found) == 10
    found.add(SamplePlace((0.95, 0.0), 10, "mesh"), curved((0.95, 0.0)), curved_slopes((0.95, 0.0)))
    # The farthest from the hand has gone.
    assert len(found) == 10 and (0.0, 0.0) not in [at.c for at in found.places]
    found.add(SamplePlace((0.955, 0.001), 11, "mesh"), curved((0.955, 0.001)), curved_slopes((0.955, 0.001)))
    assert [at.frame for at in found.places] == [*range(1, 10), 11]
    assert found.knows((0.95, 0.0), "mesh") and not found.knows((0.95, 0.0), "another")
    assert not found.knows((0.93, 0.0), "mesh")
    # The rows are those of the samples that have stayed.
    for at in found.places:
        close = samples_of([other.c for other in found.places], curved, curved_slopes)
        np.testing.assert_array_equal(found(at.c), close(at.c))


def test_what_makes_no_sense_is_refused():
    out, rows = np.empty(2), np.zeros((4, 2))
    hand, none, places = np.zeros(2), np.empty(0), np.zeros((1, 2))
    for size, epsilon2 in ((0.0, 1.0), (1.0, 0.0), (1.0, -1.0), (1.0, np.nan)):
        with pytest.raises(ValueError):
            _kernels.gmls(hand, none, places, size, epsilon2, rows, out)
    with pytest.raises(ValueError):
        _kernels.gmls(hand, none, np.zeros((2, 2)), 1.0, 1.0, rows, out)
    with pytest.raises(ValueError):
        _kernels.gmls(hand, none, np.zeros((0, 2)), 1.0, 1.0, rows, out)


def bent(c):
    """Values of the hand that are not linear in it, and those of another mesh, which are off by a linear function."""
    return np.array([np.sin(c[0]) + c[1] ** 2, c[0] * c[1], np.exp(0.3 * c[0])])


def slopes_of_bent(c):
    return np.array([[np.cos(c[0]), c[1], 0.3 * np.exp(0.3 * c[0])], [2.0 * c[1], c[0], 0.0]])


def test_samples_of_another_mesh_agree_with_what_is_known_of_this_one():
    """What is off by a linear function is told by one answer: all that is predicted is off by it."""
    places, c = LAYOUTS["scattered"], (0.2, 0.1)
    made, rebased = (samples_of(places, bent, slopes_of_bent) for _ in range(2))
    made.set_last((0.0, 0.3), bent((0.0, 0.3)))
    rebased.set_last((0.0, 0.3), bent((0.0, 0.3)))
    slope, offset = np.array([[0.3, -0.2, 1.0], [0.0, 0.5, 0.1]]), np.array([1.0, -2.0, 0.5])
    step = 1e-5
    own = [(made(c + way) - made(c - way)) / (2 * step) for way in step * np.eye(2)]
    rebased.rebase(c, made(c) + offset, np.array(own) + slope)
    for hand in [(0.2, 0.1), (0.6, 0.5), (-0.3, 0.9)]:
        expected = made(hand) + offset + (np.array(hand) - c) @ slope
        np.testing.assert_allclose(rebased(hand), expected, rtol=0, atol=2e-3)
    np.testing.assert_allclose(rebased(c), made(c) + offset, rtol=0, atol=1e-12)


def test_samples_on_another_mesh_predict_what_is_interpolated_from_what_they_predict():
    places, matrix = LAYOUTS["scattered"], np.random.default_rng(4).normal(size=(5, 3))
    made = samples_of(places, bent, slopes_of_bent)
    made.set_last((0.0, 0.3), bent((0.0, 0.3)))
    found = made.projected(lambda rows: rows @ matrix.T)
    for hand in [(0.2, 0.1), (0.6, 0.5), (-0.3, 0.9)]:
        np.testing.assert_allclose(found(hand), matrix @ made(hand), rtol=0, atol=1e-13)
    assert all(at.projected for at in found.places) and not any(at.projected for at in made.places)
    assert [at.c for at in found.places] == [at.c for at in made.places] and found.last == made.last
    # The next sample of that mesh is none of these.
    found.add(SamplePlace((0.3, 0.3), 9, "other"), found((0.3, 0.3)), np.zeros((2, 5)))
    assert [at.projected for at in found.places] == [True] * 4 + [False]
