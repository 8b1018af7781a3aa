"""Hard cases of cloth: their own measures can fail, and what a fall, a rest and a small body are reported by, by
hand."""

import numpy as np
import pytest
from cloths import BALL, CONTACT, PIN, cloth, write_cloth
from petsc4py import PETSc
from restshape_studies.stability.case import Trial
from restshape_verification.couture.hard_scenes import (
    GRAVITY,
    ball,
    differenced,
    floor,
    pinned,
    played,
    resting,
    square,
    start,
)

from restshape import _kernels
from restshape.algebra.nonlinear.descent import Descent
from restshape.application import application
from restshape.cli.main import main
from restshape.errors import UserError
from restshape.physics.cloth.contact.contact import Contact
from restshape.physics.cloth.contact.thin_bodies import BORNE, borne
from restshape.scene.load import load_scene, revise
from restshape.scene.plan import plan

COUTURE = application("couture")
BAR = """
[bodies.bar]
capsule = { start = [0.2, -0.5, -0.3], end = [0.2, 1.5, -0.3], radius = "4 mm" }
"""


def statements(made, rows):
    return {s.must: s.holds for s in resting(made, rows)}


def test_rest_is_measured_by_what_the_solver_did_not_compute(tmp_path):
    made, rows = played(Trial(tmp_path), square(0.06, pinned("c", "d")))
    assert all(statements(made, rows).values())
    # Where it does not rest differences notice, whatever a row says.
    corners = made.analysis.problem.corner_number
    made.analysis.x[corners, 2] += 1e-4 * np.arange(len(corners))
    found = statements(made, rows)
    failed = [must for must, holds in found.items() if not holds]
    assert failed == ["residual by differences of the energy at most 0.0003"]
    # Every unknown or a few of them report the same norm.
    assert differenced(made, most=60) == pytest.approx(differenced(made), rel=0.5)


def test_differences_of_the_energy_are_the_residual(tmp_path):
    made, _ = played(Trial(tmp_path), square(0.06, pinned("c")))
    made.analysis.x[made.analysis.problem.corner_number, 2] *= 1.01
    assert differenced(made, most=10**6) == pytest.approx(made.analysis.residual_norm(), rel=1e-5)


def test_a_fall_ends_at_once_and_is_reported(tmp_path):
    made, (row,) = played(Trial(tmp_path), square(0.06, ball(1.0, 1.0), CONTACT))
    assert row["converged"] == 0 and row["tangent_positive_definite"] == -1 and row["relaxation_steps"] < 200
    assert row["note"].startswith("not converged: residual ") and row["note"].endswith("it falls without end")
    # In free fall the residual forces are the weight.
    assert made.analysis.residual_norm() == pytest.approx(row["residual"])


@pytest.mark.slow
def test_coarse_meshes_do_not_let_limp_cloth_past_its_ball(tmp_path):
    """Their triangles touch the ball between corners: nested meshes lead to rest, and no other start is made."""
    text = square(0.03, ball(0.35, 0.35, 0.2), CONTACT, side=0.7)
    limp = ['material.cotton.E="3.33 kPa"', "mesh.levels=3"]
    made, (row,) = played(Trial(tmp_path), text, overrides=limp)
    assert all(statements(made, [row]).values()) and row["tangent_positive_definite"] == 1 and row["note"] == ""
    # What nothing catches falls from both.
    _, (row,) = played(Trial(tmp_path), square(0.03, ball(1.5, 1.5), CONTACT, side=0.7), overrides=["mesh.levels=3"])
    assert row["converged"] == 0 and "it falls without end" in row["note"] and "made on one" not in row["note"]


def test_cloth_of_the_corotated_law_rests_after_an_edit(tmp_path):
    """A corner of the pattern is pulled: a tangent that was not definite in compression led up the energy."""
    pull = [{"do": "press", "on": "a", "at": [0, 0]}, {"do": "drag", "to": [-0.05, -0.05], "frames": 1}]
    text = square(0.04, ball(0.15, 0.15), CONTACT)
    _, rows = played(Trial(tmp_path), text, pull, overrides=['effects.cloth.membrane="corotated"'])
    assert all(row["converged"] == row["tangent_positive_definite"] == 1 for row in rows)


def test_too_few_steps_are_reported(tmp_path):
    _, (row,) = played(Trial(tmp_path), square(0.03, ball(0.15, 0.15), CONTACT), overrides=["effects.drape.steps=2"])
    assert row["converged"] == 0 and "2 steps are over" in row["note"] and "of the weight" in row["note"]


@pytest.mark.parametrize(
    ("place", "way", "passed"),
    [
        ((0.0, 0.0, 1.0), (0, 0, -1), False),  # above the ball
        ((0.0, 0.0, -1.0), (0, 0, -1), True),  # below it
        ((0.9, 0.0, 0.5), (0, 0, -1), False),  # beside it, higher: a vertical line misses, but nobody asks for lines
        ((0.9, 0.0, -0.01), (0, 0, -1), True),  # beside it, lower than its middle
        ((0.0, 0.0, -0.305), (0, 0, -1), False),  # touching from below
        ((0.0, 0.0, 1.0), (0, 0, 1), True),  # above it, and rising
    ],
)
def test_what_goes_away_from_a_ball(place, way, passed):
    contact = Contact([_kernels.Body.sphere((0, 0, 0), 0.3)], np.ones(1), 1e4, 0.01)
    assert contact.passed(np.array([place]), np.array(way, float)) == passed


@pytest.mark.parametrize(("depth", "passed"), [(0.1, False), (2.0, True)])
def test_a_ring_that_has_fallen_off_a_rough_ball_falls_on(depth, passed):
    """Points all around may stay on it as long as they could reach it."""
    angle = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
    ring = np.column_stack([0.32 * np.cos(angle), 0.32 * np.sin(angle), np.full(8, -depth)])
    contact = Contact([_kernels.Body.sphere((0, 0, 0), 0.3)], np.ones(8), 1e4, 0.01, friction=0.3)
    assert contact.passed(ring, np.array([0.0, 0.0, -9.81])) == passed


def test_a_floor_below_is_not_passed_and_a_support_holds(tmp_path):
    under, beside = np.array([[0, 0, -5.0]]), np.array([0, 0, -9.81])
    plane = _kernels.Body.plane((0, 0, -6.0), (0, 0, 1))
    assert not Contact([plane], np.ones(1), 1e4, 0.01).passed(under, beside)
    made, _ = played(Trial(tmp_path), square(0.06, pinned("c")))
    sheet = made.analysis.problem
    assert not sheet.falls(made.analysis.x)
    sheet.supports.mask[:] = False
    assert sheet.falls(made.analysis.x)
    # Held along x alone it falls, for gravity is along z.
    sheet.supports.mask[:, 0] = True
    assert sheet.falls(made.analysis.x)
    sheet.supports.mask[0, 2] = True
    assert not sheet.falls(made.analysis.x)


def fine(folder, *parts, overrides=()):
    """A square of cotton whose mesh is fine beside all bodies."""
    return cloth(folder, *parts, overrides=(*overrides, "mesh.size=0.01"))


def test_what_a_small_body_bears(tmp_path):
    """All of 1 m x 1 m on a ball of 0.5 m: 4 times its weight by area, with half to spare 6; on a bar of 8 mm 187.5.

    An edge that is sharp bears what hangs over it on a quarter of a circle of 2 mm.
    """
    assert borne(fine(tmp_path, BALL, CONTACT), 2e-3) == (BORNE, "")
    times, why = borne(fine(tmp_path, BALL, BAR, CONTACT), 2e-3)
    assert times == pytest.approx(1.5 / 0.008) and "bodies.bar" in why
    scene = fine(tmp_path, BALL, CONTACT, overrides=('bodies.ball.sphere.radius="5 cm"',))
    assert borne(scene, 2e-3)[0] == pytest.approx(1.5 / 0.1**2)
    boxed = fine(tmp_path, "[bodies.box]\nbox = { center = [0, 0, -1], half = [0.02, 3, 4] }", CONTACT)
    edge = 0.5 * 1.5 / (0.5 * np.pi * 2e-3)
    assert borne(boxed, 2e-3) == (pytest.approx(edge), "bodies.box has edges that cloth hangs over")
    drum = fine(tmp_path, '[bodies.drum]\ncylinder = { start = [0, 0, -1], end = [0, 0, 3], radius = "5 cm" }', CONTACT)
    assert borne(drum, 2e-3)[0] == pytest.approx(edge)
    coin = fine(
        tmp_path, '[bodies.coin]\ncylinder = { start = [0, 0, -1], end = [0, 0, "-98 cm"], radius = 2 }', CONTACT
    )
    assert borne(coin, 2e-3)[0] == pytest.approx(edge)
    rounded = revise(coin, "bodies.coin.cylinder.rounded", 0.01)
    assert borne(rounded, 2e-3)[0] == pytest.approx(1.5 / 0.02)
    plane = fine(tmp_path, "[bodies.floor]\nplane = { point = [0, 0, -1], normal = [0, 0, 1] }", CONTACT)
    assert borne(plane, 2e-3) == (BORNE, "")
    settings = plan(boxed, COUTURE).settings("contact")
    assert settings.stiffness == pytest.approx(8 * edge * 400 * 0.5e-3 * 9.81 / 2e-3)


def test_what_is_thin_beside_the_mesh_bears_triangles_by_points(tmp_path):
    """A bar of 8 mm under triangles of 48 mm has 4 times the load on a place, with 2 mm around it."""
    scene = cloth(tmp_path, BAR, CONTACT, overrides=("mesh.size=0.048",))
    assert borne(scene, 2e-3)[0] == pytest.approx(4.0 * 1.5 / 0.008)
    assert borne(revise(scene, "mesh.size", 0.012), 2e-3)[0] == pytest.approx(1.5 / 0.008)


def test_bodies_that_overlap_and_hold_cloth_between_them_are_refused(tmp_path, capsys):
    """One is above the cloth and one below, and both reach beyond it; beside each other they push it out."""
    low, high = (
        f"\n[bodies.{name}]\nbox = {{ center = [0.15, 0.15, {z}], half = [0.1, 0.1, 0.05], radius = 0.005 }}\n"
        for name, z in (("low", -0.04), ("high", 0.04))
    )
    beside = low.replace("low", "beside").replace("[0.15, 0.15", "[0.2, 0.15")
    with pytest.raises(UserError, match=r"bodies\.low and bodies\.high overlap where the cloth starts") as raised:
        played(Trial(tmp_path), square(0.06, low, high, floor(-0.2), CONTACT))
    assert "bodies.high" in raised.value.where and "start.move" in raised.value.do
    _, (row,) = played(Trial(tmp_path), square(0.06, low, beside, floor(-0.2), CONTACT, start(move=(0, 0, 0.02))))
    assert row["converged"] == 1
    path = tmp_path / "held.toml"
    path.write_text(square(0.06, low, high, floor(-0.2), CONTACT))
    assert main(["replay", str(path)]) == 2
    assert "overlap where the cloth starts" in capsys.readouterr().err


def test_cloth_that_does_not_resist_bending_has_no_slopes(tmp_path):
    limp = cloth(tmp_path, PIN, overrides=("material.cotton.bending=0",))
    assert plan(limp, COUTURE).settings("cloth").bending == "none"
    given = revise(limp, "effects.cloth", {"bending": "hinge"})
    assert plan(given, COUTURE).settings("cloth").bending == "hinge"
    path = write_cloth(tmp_path, PIN, '[material.silk]\nE = 1e6\nnu = 0\nrho = 1\nthickness = 1e-4\nregion = "patch"\n')
    with pytest.raises(UserError, match="does not resist bending"):
        plan(load_scene(path, ["material.silk.bending=0"]), COUTURE)


def test_cloth_without_mass_or_hold_comes_to_an_end(tmp_path):
    """Nothing holds its tangent up, neither supports nor mass: its stability is left open, and it ends."""
    text = square(0.1, kind="nonlinear").replace("500 kg/m^3", "0 kg/m^3").replace(GRAVITY, "")
    _, (row,) = played(Trial(tmp_path), text)
    assert row["converged"] == 1 and row["tangent_positive_definite"] == 0


class Valley:
    """The energy of a quartic valley, whose tangent is another one after each step."""

    constrained = np.empty(0, dtype=int)

    def __init__(self):
        self.matrix = PETSc.Mat().createAIJ((3, 3), nnz=3)
        self.matrix.setUp()

    def energy(self, x):
        return float(((x[0] - [1.0, 2.0, 3.0]) ** 4 / 4 + x[0] ** 2 / 2).sum())

    def residual(self, x, out):
        out[0] = (x[0] - [1.0, 2.0, 3.0]) ** 3 + x[0]

    def tangent(self, x):
        for k in range(3):
            for m in range(3):
                self.matrix.setValue(k, m, float(3 * (x[0, k] - k - 1.0) ** 2 + 1.0) * (k == m))
        self.matrix.assemble()
        return self.matrix


def test_a_descent_does_not_remember_another_one():
    """The second run from a place is the first one again, to the last digit, whatever was between."""
    descent = Descent(PETSc.COMM_SELF, "test_forgetful_", Valley(), (1, 3), slice(0, 3))
    ends = []
    for begin in ([5.0, -3.0, 0.0], [1.0, 1.0, 9.0], [5.0, -3.0, 0.0]):
        x = np.array([begin])
        assert descent.run(x, 1e-6, 40) <= 1e-6
        ends.append((descent.steps, x.tolist()))
    assert ends[0] == ends[2] != ends[1]
    # x + (x - a)^3 = 0 has one real root: for a = 1 about 0.3177.
    assert ends[0][1][0][0] == pytest.approx(0.31767219617, abs=1e-6)
    descent.destroy()


@pytest.mark.slow
def test_nodes_go_no_farther_than_bodies_are_small(tmp_path):
    """A ball that shrinks to a tenth lets nodes go a tenth as far in one step."""
    events = [{"do": "set", "key": "bodies.ball.sphere.radius", "value": 0.01}]
    made = Trial(tmp_path).replay(square(0.06, ball(0.15, 0.15), floor(-0.3), CONTACT), events)
    reach = [made.replay.analysis.state.solver.descent.reach for _ in made.rows()]
    assert reach == pytest.approx([0.05, 0.005])
    assert made.replay.analysis.state.solver.moving.steps.reach == pytest.approx(0.005)
