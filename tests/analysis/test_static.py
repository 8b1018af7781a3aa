"""The static analysis: exact displacements on moving meshes, and what it reuses."""

import numpy as np
import pytest
from petsc4py import PETSc
from small_scenes import (
    HEAD,
    HOLE,
    PATCH,
    PATCH_GRADIENT,
    across,
    block,
    drag,
    make_replay,
    meshed,
    rows_of,
    write_scene,
    write_script,
)

from restshape.analysis.guess import Guess
from restshape.analysis.static import steady
from restshape.mesh.mesh import Mesh
from restshape.policy import POLICIES

A = np.array(PATCH_GRADIENT)


@pytest.mark.parametrize("name", POLICIES)
def test_patch_test_in_every_frame_of_a_drag(tmp_path, name):
    # Supports that depend on the place follow the nodes; the answer is linear on every distorted mesh.
    script = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.7, 0.6), 12)))
    made = make_replay(write_scene(tmp_path, PATCH), script, name)
    places = []
    for row in made.frames():
        X = made.analysis.space.X
        np.testing.assert_allclose(made.analysis.x, X @ A.T, atol=1e-13)
        assert row["residual"] < 1.1e-12
        places.append(X[made.analysis.space.nodes_of("window")].mean(axis=0))
    np.testing.assert_allclose(places[-1], [0.7, 0.6], atol=1e-2)


def test_energy_is_half_of_the_work(tmp_path):
    # Clapeyron: the strain energy of a body under a point load is half of force times displacement.
    text = (
        HEAD
        + block()
        + HOLE
        + '[material.m]\nE = 1e9\nnu = 0.3\nthickness = 1\n[effects.solid]\nmodel = "plane_stress"\n'
        + '[supports.wall]\non = "left"\nfix = ["x", "y"]\n[loads.f]\non = "c"\nforce = [300, -700]\n'
        + "[solve]\ntolerance = 1e-10\n"
        + meshed(0.12)
        + '[quantities]\nenergy = { energy = "strain" }\nx = { displacement = "x", at = "c" }\n'
        + 'y = { displacement = "y", at = "c" }\n'
    )
    script = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.6, 0.6), 4)))
    for row in rows_of(make_replay(write_scene(tmp_path, text), script)):
        assert row["q_energy"] == pytest.approx(0.5 * (300 * row["q_x"] - 700 * row["q_y"]), rel=1e-8)


class TestGuess:
    """Guesses from the last two solutions."""

    one, two = np.array([[1.0, 2.0]]), np.array([[2.0, 0.0]])

    def test_along_a_line(self):
        guess, gesture = Guess(True), object()
        guess.keep(self.one, (gesture, (0.0, 0.0)))
        guess.keep(self.two, (gesture, (1.0, 0.0)))
        np.testing.assert_allclose(guess(self.two, (gesture, (1.5, 0.0))), [[2.5, -1.0]])
        np.testing.assert_allclose(guess(self.two, (gesture, (0.0, 0.0))), self.one)
        # Across the last step nothing is known; far along it no more than twice the step is believed.
        np.testing.assert_allclose(guess(self.two, (gesture, (1.0, 1.0))), self.two)
        np.testing.assert_allclose(guess(self.two, (gesture, (99.0, 0.0))), [[4.0, -4.0]])

    def test_another_gesture_starts_again(self):
        guess, gesture = Guess(True), object()
        guess.keep(self.one, (gesture, (0.0, 0.0)))
        guess.keep(self.two, (gesture, (1.0, 0.0)))
        assert guess(self.two, (object(), (2.0, 0.0))) is self.two
        guess.restart()
        assert guess(self.two, (gesture, (2.0, 0.0))) is self.two

    def test_without_extrapolation(self):
        guess, gesture = Guess(False), object()
        guess.keep(self.one, (gesture, (0.0, 0.0)))
        guess.keep(self.two, (gesture, (1.0, 0.0)))
        assert guess(self.two, (gesture, (2.0, 0.0))) is self.two


def test_a_scene_that_stays_is_planned_once(tmp_path, monkeypatch):
    asked = []
    monkeypatch.setattr(steady, "planned", lambda *of: asked.append(of))
    script = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.6, 0.5), 3)))
    levels = [row["level"] for row in make_replay(write_scene(tmp_path, PATCH), script, "rebuild").frames()]
    assert levels.count(3) > 2
    assert not asked


@pytest.mark.parametrize(("kind", "transferred"), [("cholesky", False), ("icc", True)])
def test_a_solution_is_transferred_where_a_solve_starts_from_it(tmp_path, monkeypatch, kind, transferred):
    asked = []
    project = Mesh.project
    monkeypatch.setattr(Mesh, "project", lambda *of: asked.append(of) or project(*of))
    scene = PATCH.replace('fix = { x = "1*(1e-3*x + 4e-4*y)", y = "1*(-2e-4*x + 7e-4*y)" }', 'fix = ["x", "y"]')
    scene = scene.replace('["outline", "window"]', '["left"]') + '[loads.f]\non = "c"\nforce = [3, -7]\n'
    script = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.78, 0.5), 3)))
    options = PETSc.Options()
    options.setValue("solid_pc_type", kind)
    try:
        made = make_replay(write_scene(tmp_path, scene), script, "auto")
        assert 3 in [row["level"] for row in list(made.frames())[1:]]
    finally:
        options.delValue("solid_pc_type")
    assert bool(asked) == transferred
