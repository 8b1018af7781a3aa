"""Large deformation, static: exact states on moving meshes, what is reused, and derivatives by the kept factor."""

import numpy as np
import pytest
from large import LARGE, WALL, beam, gravity, solid
from small_scenes import HEAD, HOLE, across, block, drag, make_replay, meshed, rows_of, write_scene, write_script

from restshape.analysis.guess import CurvedGuess
from restshape.analysis.static.nonlinear import NonlinearSteadyAnalysis
from restshape.policy import POLICIES
from restshape.replay.parity import Parity

STRETCH = np.array([[0.2, 0.15], [-0.1, 0.25]])
END = ("b", (1.0, 0.0))


def turned(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c - 1, -s], [s, c - 1]])


def held_all_around(A):
    fix = 'fix = {{ x = "1*({:.17g}*x + {:.17g}*y)", y = "1*({:.17g}*x + {:.17g}*y)" }}\n'.format(*A.ravel())
    return (
        HEAD
        + block()
        + HOLE
        + "[material.m]\nE = 1e6\nnu = 0.3\n"
        + solid()
        + LARGE
        + '[supports.round]\non = ["outline", "window"]\n'
        + fix
        + "[solve]\ntolerance = 1e-11\n"
        + meshed(0.12)
        + '[quantities]\nenergy = { energy = "strain" }\n'
    )


def bent(tmp_path, *parts, name="auto", frames=12, **more):
    script = write_script(tmp_path, drag(END[0], END[1], across(END[1], (1.1, -0.05), frames)))
    return make_replay(write_scene(tmp_path, beam(*parts)), script, name, **more)


@pytest.mark.parametrize("name", POLICIES)
def test_an_even_stretch_is_met_in_every_frame_of_a_drag(tmp_path, name):
    # Stress is the same everywhere, and so in equilibrium on every mesh, whatever the law.
    script = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.6, 0.55), 8)))
    made = make_replay(write_scene(tmp_path, held_all_around(STRETCH)), script, name)
    for row in made.frames():
        assert not row["refused"]
        np.testing.assert_allclose(made.analysis.x, made.analysis.space.X @ STRETCH.T, atol=1e-9)
        assert row["residual"] < 1.5e-11


@pytest.mark.parametrize("predict", ["none", "linear"])
def test_the_residual_that_is_reported_is_that_of_the_displacement(tmp_path, predict):
    made = bent(tmp_path, predict=predict)
    for row in made.frames():
        analysis = made.analysis
        lacking = np.linalg.norm(analysis.state.equations.full_residual(analysis.x))
        # Predicted frames are compared with the load of the last solved one.
        load = analysis.state.scale if row["predicted"] else np.linalg.norm(analysis.state.equations.load())
        assert row["residual"] == pytest.approx(lacking / load, rel=1e-6)


@pytest.mark.parametrize("angle", [0.3, 1.0])
def test_a_turned_body_has_no_energy(tmp_path, angle):
    made = make_replay(write_scene(tmp_path, held_all_around(turned(angle))))
    (row,) = rows_of(made)
    np.testing.assert_allclose(made.analysis.x, made.analysis.space.X @ turned(angle).T, atol=1e-8)
    assert abs(row["q_energy"]) < 1e-6


def test_a_small_load_bends_as_in_the_linear_theory(tmp_path):
    loads = (solid(), gravity(0, -1e-4))
    (large,) = rows_of(make_replay(write_scene(tmp_path, beam(*loads) + "\n[solve]\ntolerance = 1e-10\n")))
    linear_text = beam(*loads).replace(LARGE, "") + "\n[solve]\ntolerance = 1e-10\n"
    (linear,) = rows_of(make_replay(write_scene(tmp_path, linear_text, "linear.toml")))
    assert linear["newton"] == 0 < large["newton"]
    assert large["q_y"] == pytest.approx(linear["q_y"], rel=1e-4)


def test_the_wall_carries_the_weight(tmp_path):
    for row in rows_of(bent(tmp_path)):
        # rho g times the area of a trapezium of 1 m by 0.2 m of which one lower corner moves.
        assert row["q_wall_x"] == pytest.approx(0.0, abs=1e-2)
    scene = write_scene(tmp_path, beam())
    (row,) = rows_of(make_replay(scene))
    assert row["q_wall_y"] == pytest.approx(1000 * 10 * 0.2, rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("name", POLICIES)
@pytest.mark.parametrize("loads", [(), (solid("plane_stress"), '\n[loads.wind]\non = "top"\npressure = 800\n')])
def test_reuse_equals_a_cold_solve(tmp_path, name, loads):
    made = bent(tmp_path, *loads, name=name)
    check = Parity(made)
    rows = rows_of(made, lambda row: row.update(check()))
    assert not any(row["refused"] for row in rows)
    assert check.summary()["holds"], check.summary()
    assert all(row["residual"] <= 1e-6 for row in rows)


def test_a_drag_costs_few_steps_and_few_factors(tmp_path):
    auto = [row for row in rows_of(bent(tmp_path, frames=60)) if row["level"] == 1]
    fresh = [row for row in rows_of(bent(tmp_path, name="refactor", frames=60)) if row["level"] == 1]
    assert len(auto) == len(fresh) == 60
    # The first two frames of a drag know no parabola yet.
    assert max(row["newton"] for row in auto[3:]) <= 2
    assert sum(row["pc_rebuilt"] for row in auto) < 0.4 * len(auto)
    assert all(row["pc_rebuilt"] for row in fresh)
    # The steps are saved by the guess alone, which both have; the factors by reuse.
    steps = sum(row["newton"] for row in auto)
    last = [row for row in rows_of(bent(tmp_path, name="refactor", frames=60, guess="last")) if row["level"] == 1]
    assert steps <= 1.1 * sum(row["newton"] for row in fresh) < 0.8 * sum(row["newton"] for row in last)


@pytest.mark.parametrize("wind", ["", '\n[loads.wind]\non = "top"\npressure = 800\n'])
def test_linear_solve_is_the_derivative_of_the_answer(tmp_path, wind):
    # dx / dg by a solve with the tangent, against differences of answers to other loads.
    def at(g):
        text = beam(solid(), gravity(0, g), wind) + "\n[solve]\ntolerance = 1e-11\n"
        made = make_replay(write_scene(tmp_path, text))
        list(made.frames())
        return made.analysis

    analysis, h = at(-10.0), 1e-3
    assert isinstance(analysis, NonlinearSteadyAnalysis)
    rest = np.zeros_like(analysis.x)
    per_g = at(-11.0).state.equations.full_residual(rest) - analysis.state.equations.full_residual(rest)
    found = analysis.linear_solve(per_g, 1e-10)
    wanted = (at(-10.0 + h).x - at(-10.0 - h).x) / (2 * h)
    np.testing.assert_allclose(found, wanted, atol=1e-6 * np.abs(wanted).max())
    # The solve stands beside the frames: the solution is what it was.
    assert analysis.residual_norm() <= 1e-11


def test_the_next_frame_goes_on_from_what_was_accepted(tmp_path):
    made = bent(tmp_path)
    rows = made.frames()
    for _ in range(6):
        row = next(rows)
    analysis, solved = made.analysis, made.analysis.x.copy()
    analysis.predictor.set_values(solved + 1e-3 * np.sin(7 * analysis.space.X))
    assert analysis.observe()["y"] != row["q_y"]
    assert analysis.residual_norm() > 1e-6
    after = next(rows)
    assert after["residual"] <= 1e-6 and after["newton"] >= 1
    fresh = rows_of(bent(tmp_path, name="refactor"))[after["index"]]
    assert after["q_y"] == pytest.approx(fresh["q_y"], rel=1e-5)


def test_idle_frames_solve_nothing(tmp_path):
    script = write_script(tmp_path, [{"do": "idle", "frames": 3}])
    rows = rows_of(make_replay(write_scene(tmp_path, beam()), script))
    assert [row["newton"] for row in rows[1:]] == [0, 0, 0]


def test_flips_and_new_meshes(tmp_path):
    window = "\n[shape.holes]\nwindow = { circle = { center = [0.3, 0.25], radius = 0.08 } }\n"
    text = HEAD + block(1.0, 0.5) + window + '\n[material.rubber]\nE = "1 MPa"\nnu = 0.3\nrho = 1000\n' + WALL + LARGE
    text += solid() + gravity(0, -20) + meshed(0.06) + '[quantities]\ny = { displacement = "y", at = "c" }\n'
    script = write_script(tmp_path, drag("window", (0.3, 0.25), across((0.3, 0.25), (0.8, 0.27), 30)))
    made = make_replay(write_scene(tmp_path, text), script)
    check = Parity(made)
    rows = rows_of(made, lambda row: row.update(check()))
    assert {2, 3} & {row["level"] for row in rows} and not any(row["refused"] for row in rows)
    assert check.summary()["holds"], check.summary()


class TestCurvedGuess:
    """Guesses along a parabola."""

    def solutions(self, *ways):
        # A field that is quadratic along a drag that bends evenly.
        for s in ways:
            yield np.array([[1 + 2 * s + 3 * s * s, -s * s]]), (s, 0.5 * s * s)

    def test_a_parabola_is_met(self):
        guess, gesture = CurvedGuess(True), object()
        for x, c in self.solutions(0.0, 0.1, 0.22):
            guess.keep(x, (gesture, c))
            last = x
        ((wanted, c),) = self.solutions(0.3)
        plain = guess.last + (0.08 / 0.12) * (guess.last - guess.before)
        found = guess(last, (gesture, c))
        assert np.abs(found - wanted).max() < 0.1 * np.abs(plain - wanted).max()

    def test_a_straight_drag_is_met_exactly(self):
        guess, gesture = CurvedGuess(True), object()
        for s in (0.0, 0.1, 0.22):
            guess.keep(np.array([[s * s - s]]), (gesture, (s, 2 * s)))
        np.testing.assert_allclose(guess(guess.last, (gesture, (0.3, 0.6))), [[0.3**2 - 0.3]], rtol=1e-12)

    def test_a_turn_is_no_parabola(self):
        guess, gesture = CurvedGuess(True), object()
        for s, x in ((0.0, 1.0), (0.1, 2.0), (0.2, 5.0)):
            guess.keep(np.array([[x]]), (gesture, (s, 0.0)))
        # Back along the last step: the line, as far as it reaches.
        np.testing.assert_allclose(guess(np.array([[5.0]]), (gesture, (0.1, 0.0))), [[2.0]])
