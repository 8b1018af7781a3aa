"""Pressures that follow the deformed boundary."""

import numpy as np
import pytest
from large import beam, solid
from small_scenes import make_replay, rows_of, write_scene

from restshape.fem.problem import FOLLOWERS
from restshape.interface.first_frame import first_frame

WIND = '\n[loads.wind]\non = "top"\npressure = 2000\n'


@pytest.mark.parametrize("order", [1, 2])
def test_the_wall_carries_the_pressure_on_the_bent_side(tmp_path, order):
    # A constant pressure on a curve pushes with p times the chord between its ends, turned by a right angle.
    text = beam(solid(), WIND).replace("order = 1", f"order = {order}")
    made = make_replay(write_scene(tmp_path, text + "\n[solve]\ntolerance = 1e-9\n"))
    (row,) = rows_of(made)
    analysis = made.analysis
    ends = [analysis.space.nodes_of(name)[0] for name in ("c", "d")]
    c, d = (analysis.space.X + analysis.x)[ends]
    assert np.hypot(*(analysis.x[ends[0]])) > 0.2
    push = 2000 * np.array([-(d - c)[1], (d - c)[0]])
    np.testing.assert_allclose([row["q_wall_x"], row["q_wall_y"]], -push, rtol=1e-6)


def test_without_large_deformation_a_pressure_is_dead(tmp_path):
    text = beam(solid(), WIND).replace("[effects.large_deformation]\n", "")
    (row,) = rows_of(make_replay(write_scene(tmp_path, text)))
    np.testing.assert_allclose([row["q_wall_x"], row["q_wall_y"]], [0, 2000], atol=1e-3)


def test_a_part_of_a_pressure_that_follows_is_that_part_of_its_forces(tmp_path):
    """Without any load the beam is straight, and a step's part of the push is p times its length, upwards or down."""
    analysis = first_frame(write_scene(tmp_path, beam(solid(), WIND)), ["loads.wind.pressure=1"]).analysis
    straight = np.zeros_like(analysis.x)
    whole, third = (_forces(analysis.problem.integrals(FOLLOWERS, part), straight) for part in (1.0, 1.0 / 3.0))
    np.testing.assert_allclose(third, whole / 3.0, rtol=1e-12, atol=1e-15)
    length = np.ptp(analysis.space.X[:, 0])
    np.testing.assert_allclose(np.abs(third.sum(axis=0)), [0.0, length / 3.0], atol=1e-12)


def _forces(integrals, x):
    out = np.zeros_like(x)
    for one in integrals:
        one.add_residual(x, out)
    return out


def test_an_even_pressure_all_around_a_block_is_borne_evenly(tmp_path):
    # Plane strain, sides x = 0 and y = 0 on rollers: the stretch l solves (lambda + mu)(l^2 - 1) l = -p l, for the
    # pressure acts on sides of length l.
    from small_scenes import HEAD, block, meshed

    E, nu, p = 1e6, 0.3, 3e4
    lam, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    text = HEAD + block() + f"[material.m]\nE = {E}\nnu = {nu}\n" + solid() + "\n[effects.large_deformation]\n"
    text += '[supports.x]\non = "left"\nfix = ["x"]\n[supports.y]\non = "bottom"\nfix = ["y"]\n'
    text += f'[loads.sea]\non = ["right", "top"]\npressure = {p}\n[solve]\ntolerance = 1e-10\n' + meshed(0.3)
    made = make_replay(write_scene(tmp_path, text))
    list(made.frames())
    stretch = np.sqrt(1 - p / (lam + mu))
    np.testing.assert_allclose(made.analysis.x, (stretch - 1) * made.analysis.space.X, atol=1e-9)
    # Cauchy's stress is the pressure.
    np.testing.assert_allclose(made.analysis.problem.stresses.cauchy(made.analysis.x)[:, :2], -p, rtol=1e-6)
