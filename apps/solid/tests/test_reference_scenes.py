"""The formulas in the scenes that ship, against the closed forms in the coordinates of the textbooks."""

import numpy as np
import pytest

from restshape.application import application
from restshape.scene.load import load_scene

SCENES = application("solid").folder / "scenes"


def cartesian(rr, tt, rt, angle):
    """Stresses xx, yy, xy of polar ones at an angle."""
    c, s = np.cos(angle), np.sin(angle)
    xx = rr * c**2 + tt * s**2 - 2 * rt * s * c
    yy = rr * s**2 + tt * c**2 + 2 * rt * s * c
    return xx, yy, (rr - tt) * s * c + rt * (c**2 - s**2)


def kirsch(x, y, S, a):
    """Kirsch's stresses, from their polar form."""
    r, angle = np.hypot(x, y), np.arctan2(y, x)
    a2, a4 = (a / r) ** 2, (a / r) ** 4
    rr = S / 2 * (1 - a2) + S / 2 * (1 - 4 * a2 + 3 * a4) * np.cos(2 * angle)
    tt = S / 2 * (1 + a2) - S / 2 * (1 + 3 * a4) * np.cos(2 * angle)
    rt = -S / 2 * (1 + 2 * a2 - 3 * a4) * np.sin(2 * angle)
    return cartesian(rr, tt, rt, angle)


@pytest.mark.parametrize(("name", "normal"), [("right", 0), ("top", 1)])
def test_tractions_of_kirsch(name, normal):
    scene = load_scene(SCENES / "kirsch.toml", ["parameters.S=3", "parameters.a=0.2"])
    t = np.linspace(0.01, 0.7, 9)
    x, y = (np.full(9, 0.7), t) if normal == 0 else (t, np.full(9, 0.7))
    xx, yy, xy = kirsch(x, y, 3.0, 0.2)
    wanted = (xx, xy) if normal == 0 else (xy, yy)
    for value, stress in zip(scene.loads[name].traction, wanted):
        np.testing.assert_allclose(value.evaluate(x, y, scene.parameters), stress, atol=1e-13)


def test_the_tip_of_timoshenko_moves_by_0_0089():
    scene = load_scene(SCENES / "timoshenko.toml")
    v = scene.supports["exact"].fix["y"]
    assert v.evaluate(48.0, 0.0, scene.parameters) == pytest.approx(0.0089, rel=1e-13)


def test_the_end_shear_of_timoshenko_sums_to_its_load():
    scene = load_scene(SCENES / "timoshenko.toml")
    y, weights = np.polynomial.legendre.leggauss(3)
    shear = scene.loads["shear"].traction[1].evaluate(48.0, 6 * y, scene.parameters)
    assert 6 * weights @ shear == pytest.approx(1000, rel=1e-13)


def test_the_displacements_of_timoshenko_give_its_stresses():
    scene = load_scene(SCENES / "timoshenko.toml")
    p, fix, h = scene.parameters, scene.supports["exact"].fix, 1e-3
    x, y = np.array([7.0, 20.0, 41.0]), np.array([-4.0, 1.0, 5.5])

    def slope(direction, dx, dy):
        f = fix[direction]
        return (f.evaluate(x + dx, y + dy, p) - f.evaluate(x - dx, y - dy, p)) / (2 * h)

    e_xx, e_yy, shear = slope("x", h, 0), slope("y", 0, h), slope("x", 0, h) + slope("y", h, 0)
    E, nu = p["E"], p["nu"]
    np.testing.assert_allclose(E / (1 - nu**2) * (e_xx + nu * e_yy), -1000 * (48 - x) * y / 144, rtol=1e-5)
    np.testing.assert_allclose(E / (1 - nu**2) * (e_yy + nu * e_xx), 0, atol=1e-2)
    np.testing.assert_allclose(E / (2 * (1 + nu)) * shear, 1000 * (144 - 4 * y**2) / (8 * 144), rtol=1e-4)
    assert (scene.material["beam"].E, scene.material["beam"].nu) == (E, nu)
