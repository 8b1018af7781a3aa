"""Response spectra against closed forms, and against scipy's integration of the same equation."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import StateSpace, lsim

from restshape.analysis.motion.response_spectrum import response_spectrum, spectrum_and_sums


def noise(count=40, seed=3):
    rng = np.random.default_rng(seed)
    return np.cumsum(rng.uniform(0.004, 0.03, count)), rng.normal(size=count)


@pytest.mark.parametrize("ratio", [0.0, 0.05, 0.4])
def test_a_constant_acceleration_has_the_closed_form(ratio):
    """From rest u peaks at half a damped period, at a/w^2 (1 + exp(-pi z / sqrt(1 - z^2))), if it lasts that long."""
    frequencies = np.array([0.8, 2.0, 7.0])
    found = response_spectrum(np.array([0.0, 3.0]), np.array([2.5, 2.5]), frequencies, ratio)
    expected = 2.5 * (1 + np.exp(-np.pi * ratio / np.sqrt(1 - ratio**2)))
    np.testing.assert_allclose(found.pseudo_acceleration, expected, rtol=2e-5)
    np.testing.assert_allclose(found.pseudo_velocity * 2 * np.pi * frequencies, found.pseudo_acceleration)
    np.testing.assert_allclose(found.periods, 1 / frequencies)


def test_a_half_sine_shock_has_the_closed_form():
    """Undamped shock spectrum of a half sine of duration d, with r = (2 d f): residual 2 r cos(pi r/2)/(1 - r^2) below
    r = 1, and the largest of the maxima during the pulse above.

    Source: C. M. Harris and A. G. Piersol, Shock and Vibration Handbook, chapter 8; Jacobsen and Ayre, 1958.
    """
    duration, peak = 0.2, 3.0
    t = np.linspace(0, duration, 4001)
    r = np.array([0.2, 0.5, 0.9, 1.5, 2.2, 3.3, 6.1])
    found = response_spectrum(t, peak * np.sin(np.pi * t / duration), r / (2 * duration), 0.0)
    residual = 2 * r * np.abs(np.cos(np.pi * r / 2)) / np.abs(1 - r**2)
    # Extremes during the pulse lie at t = 2 m d / (1 +- r), where u is r/(r - 1) sin(2 pi m / (1 + r)) or the like.
    inside = [
        max([r_i / (r_i - 1) * np.sin(2 * np.pi * m / (r_i + 1)) for m in range(1, int((r_i + 1) / 2) + 1)], default=0)
        for r_i in r
    ]
    np.testing.assert_allclose(found.pseudo_acceleration / peak, np.maximum(residual, inside), rtol=2e-5)


def integrated(t, a, frequency, ratio, dense):
    """Displacements at dense times, by a Runge-Kutta method of high order."""
    w = 2 * np.pi * frequency

    def rates(time, y):
        return [y[1], -np.interp(time, t, a, left=0, right=0) - 2 * ratio * w * y[1] - w**2 * y[0]]

    return solve_ivp(rates, (t[0], dense[-1]), [0, 0], "DOP853", dense, max_step=0.02, rtol=1e-7, atol=1e-9).y[0]


@pytest.mark.parametrize("ratio", [0.0, 0.03])
def test_sums_of_motions_peak_where_those_of_scipy_do(ratio):
    """scipy.signal.lsim is exact for inputs that are linear between samples of equal steps: here, 1/40 of the record's.

    The record has 2.5 samples in a period of the fastest oscillator.
    """
    t, frequencies = 0.02 * np.arange(60), np.array([3.0, 8.0, 20.0])
    a = np.random.default_rng(1).normal(size=len(t))
    # Twenty periods of the slowest follow the record.
    dense = np.arange(40 * (len(t) - 1) + round(20 / frequencies[0] * 40 / 0.02) + 1) * 0.02 / 40
    ground = np.interp(dense, t, a)
    ground[dense > t[-1] + 1e-9] = 0.0
    factors = np.array([[1.0, 0.4], [-2.0, 0.0], [9.0, 30.0]])
    moved = []
    for w in 2 * np.pi * frequencies:
        system = StateSpace([[0, 1], [-(w**2), -2 * ratio * w]], [[0], [-1]], [[1, 0]], [[0]])
        moved.append(lsim(system, ground, dense, interp=True)[1])
    during = np.abs(np.array(moved).T @ factors)[: 40 * (len(t) - 1) + 1]
    found = spectrum_and_sums(t, a, frequencies, ratio, factors)[1]
    if ratio:
        np.testing.assert_allclose(found, during.max(axis=0), rtol=1e-3)
        assert np.all(during[::40].max(axis=0) < 0.99 * found)
    else:
        np.testing.assert_allclose(found, np.abs(np.array(moved).T @ factors).max(axis=0), rtol=1e-3)


def test_a_sum_that_is_largest_after_the_record_is_followed():
    """A push of 10 ms: two oscillators then swing freely, and their sum peaks when both do, some periods later."""
    t, a = np.array([0.0, 0.005, 0.01]), np.array([0.0, 1.0, 0.0])
    frequencies, factors = np.array([1.0, 1.25]), np.array([[1.0, 1.0], [1.0, -1.0]])
    dense = np.linspace(0, 6, 12001)
    parts = np.array([integrated(t, a, frequency, 0.01, dense) for frequency in frequencies])
    found = spectrum_and_sums(t, a, frequencies, 0.01, factors)[1]
    np.testing.assert_allclose(found, np.abs(parts.T @ factors).max(axis=0), rtol=1e-4)


def test_a_sum_of_one_oscillator_is_its_spectrum():
    """Whatever its factor, and whatever the damping: during the record and after it."""
    t, a = noise()
    for ratio in (0.0, 0.05, 0.6):
        spectrum, sums = spectrum_and_sums(t, a, np.array([6.0]), ratio, np.array([[-3.0]]))
        np.testing.assert_allclose(sums, 3.0 * spectrum.displacement, rtol=2e-5)


def test_peaks_between_and_after_uneven_samples_are_found():
    """Against a Runge-Kutta method of high order that goes on after the record."""
    t, a = noise()
    for frequency in (1.3, 9.0):
        dense = np.linspace(t[0], t[-1] + 1 / frequency, 4000)
        expected = integrated(t, a, frequency, 0.03, dense)
        found = response_spectrum(t, a, np.array([frequency]), 0.03).displacement[0]
        assert found == pytest.approx(np.abs(expected).max(), rel=1e-4)


def test_stiff_oscillators_feel_the_ground_itself_and_soft_ones_its_displacement():
    """S_a tends to the peak of the acceleration at high frequencies, S_d to that of the displacement at low ones."""
    t = np.linspace(0, 4, 2001)
    a = np.sin(np.pi * t / 2) * np.sin(2 * np.pi * t)
    found = response_spectrum(t, a, np.array([1e-4, 80.0]), 0.05)
    velocity = np.concatenate([[0], np.cumsum(0.5 * (a[1:] + a[:-1]) * np.diff(t))])
    place = np.concatenate([[0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * np.diff(t))])
    assert found.pseudo_acceleration[1] == pytest.approx(np.abs(a).max(), rel=2e-3)
    assert found.displacement[0] >= np.abs(place).max() * 0.999


@pytest.mark.parametrize(
    ("frequencies", "ratio"), [([0.0], 0.1), ([1.0], 1.0), ([1.0], -0.1), ([], 0.1), ([np.inf], 0)]
)
def test_oscillators_that_make_no_sense_are_refused(frequencies, ratio):
    with pytest.raises(ValueError, match="frequencies are positive"):
        response_spectrum(np.array([0.0, 1.0]), np.array([1.0, 1.0]), np.array(frequencies), ratio)
