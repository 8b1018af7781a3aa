"""Bending of planks against beams of Euler and Bernoulli in closed form."""

import numpy as np
import pytest
from restshape_apps.furniture.pieces import cantilever
from restshape_apps.furniture.small_pieces import bench

from restshape.physics.furniture import Compliance, Furniture
from restshape.physics.plank_bending import plank_bending

G = 9.80665


def test_a_cantilever_sags_by_its_load_and_weight() -> None:
    arm, kilograms = 0.4, 0.3
    furniture = Furniture(cantilever(arm=arm, kilograms=kilograms))
    furniture.test()
    found = plank_bending(furniture, 2)
    EI = 2.5e9 * 0.06 * 0.012**3 / 12
    own = furniture.geometry().mass[2] * G / arm
    assert found.sag == pytest.approx(kilograms * G * arm**3 / (3 * EI) + own * arm**4 / (8 * EI), rel=1e-4)
    moment = kilograms * G * arm + own * arm**2 / 2
    assert found.stress == pytest.approx(moment * 0.006 / (0.06 * 0.012**3 / 12), rel=1e-4)


def test_a_plank_on_two_supports_sags_between_them() -> None:
    # Legs that turn freely: thin, without friction; the board hangs over by 0.1 m at each end.
    furniture = Furniture(bench(0.0, mu=0.0, kilograms=20.0), Compliance(least_overlap=1e-6))
    furniture.test()
    found = plank_bending(furniture, 0)
    EI = 11e9 * 0.3 * 0.02**3 / 12
    w, P, L, a = furniture.geometry().mass[0] * G / 1.2, 20.0 * G, 1.0, 0.1
    expected = 5 * w * L**4 / (384 * EI) + P * L**3 / (48 * EI) - w * a**2 / 2 * L**2 / (8 * EI)
    assert np.abs(np.interp(0.0, found.s, found.deflection)) == pytest.approx(expected, rel=1e-3)
    assert np.abs(found.moment).max() == pytest.approx(P * L / 4 + w * L**2 / 8 - w * a**2 / 2, rel=1e-3)


def test_the_moment_ends_at_nothing() -> None:
    # Up to the load times what it displaces, which the beam does not know.
    furniture = Furniture(bench(0.3, leg=0.02))
    furniture.test()
    for plank in range(3):
        found = plank_bending(furniture, plank)
        assert abs(found.moment[-1]) < 1e-6 * 20.0 * G * 0.5
