"""Load stepping: the whole load or none of it, against paths and bent strips that are known."""

import logging
import pathlib
import re

import numpy as np
import pytest
from large import beam, solid
from petsc4py import PETSc
from restshape_studies.validation.elastica import stretched_elastica
from scipy.integrate import solve_bvp
from scipy.special import ellipe, ellipk
from small_scenes import make_replay, rows_of, write_scene, write_script

from restshape.algebra.nonlinear.newton_convergence import Outcome
from restshape.analysis.static.load_stepping import SEARCHED, SHORTEST, step_load
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame

ELASTICA = pathlib.Path(__file__).parents[1] / "scenes" / "elastica.toml"
CUT = re.compile(r"Load step cut to (\S+) of the load, at (\S+): (.+)")
DONE = Outcome(True, 0, 0, False, True)


class Path:
    """Equilibria x = s^2 at the part s of the load; a guess is good enough within a radius, or with a line search."""

    def __init__(self, radius, end=1.0, searched_radius=0.0):
        self.radius, self.end, self.searched_radius = radius, end, searched_radius
        self.parts, self.found, self.searches, self.newton = [], [], 0, 0

    def attempt(self, x, added, searched):
        part = 1.0 if added is None else 1.0 - added[0, 0]
        self.parts.append(part)
        self.searches += searched
        near = abs(x[0, 0] - part**2) <= (self.searched_radius if searched else self.radius)
        self.found.append(near and part <= self.end)
        if not self.found[-1]:
            x[:] = np.nan
            self.newton += 15
            return Outcome(False, 15, 0, False, False), "too far"
        x[:] = part**2
        self.newton += 3
        return Outcome(True, 3, 0, False, True), ""

    def follow(self, most=1000):
        zero = np.zeros((1, 1))
        return step_load(self.attempt, zero, np.ones((1, 1)), lambda x, part: None, DONE, most)


def test_steps_are_halved_and_doubled():
    path = Path(0.07)
    found = path.follow()
    assert found.reached == 1.0 and not found.why and found.x[0, 0] == 1.0
    # s^2 leaves a guess at a^2 behind by more than 0.07 until steps are short enough; an easy one is doubled.
    assert path.parts[:7] == [1.0, 0.5, 0.25, 0.75, 0.5, 0.375, 0.3125]
    assert path.parts[-1] == 1.0 and found.outcome.newton == path.newton and not path.searches


def test_the_whole_load_or_none_of_it():
    path = Path(0.07)
    path.follow()
    enough = len(path.parts)
    for most in range(1, enough):
        found = Path(0.07).follow(most)
        assert found.reached < 1.0 and f"more than {most} load steps" in found.why and "load_steps" in found.why
        # What it holds is the equilibrium that it says.
        assert found.x[0, 0] == found.reached**2
    assert Path(0.07).follow(enough).reached == 1.0


def test_each_step_that_is_cut_is_logged_with_its_reason(caplog):
    caplog.set_level(logging.INFO, "restshape.analysis")
    path = Path(0.07)
    path.follow()
    cuts = [CUT.fullmatch(record.getMessage()) for record in caplog.records]
    # A guess that is too far off is a step that is cut: to half the way from the last equilibrium to where it was.
    failed = [k for k, part in enumerate(path.parts) if not path.found[k]]
    assert len(cuts) == len(failed) > 2 and {cut[3] for cut in cuts} == {"too far"}
    for k, cut in zip(failed, cuts):
        step, reached = float(cut[1]), float(cut[2])
        assert reached == max([0.0, *(part for part, found in zip(path.parts[:k], path.found) if found)])
        assert path.parts[k + 1] == pytest.approx(reached + step)


def test_cut_steps_of_a_bent_strip_are_logged(caplog):
    caplog.set_level(logging.INFO, "restshape.analysis")
    first_frame(ELASTICA, ["effects.large_deformation.load_steps=24"], PETSc.COMM_WORLD)
    cuts = [CUT.fullmatch(record.getMessage()) for record in caplog.records if "cut" in record.getMessage()]
    # The whole load at once fails first, which is half a step from nothing, and each cut halves what is left of it.
    assert cuts and all(cuts) and (float(cuts[0][1]), float(cuts[0][2])) == (0.5, 0.0)
    assert all(cut[3] for cut in cuts)


def test_a_limit_is_met_within_the_shortest_step():
    found = Path(0.07, end=0.6).follow()
    assert found.why == "too far" and 0.6 - 2 * SHORTEST <= found.reached <= 0.6
    assert found.x[0, 0] == found.reached**2


def test_short_steps_are_searched():
    path = Path(1e-5, searched_radius=0.07)
    assert path.follow().reached == 1.0 and path.searches > 0
    assert Path(1e-8).follow().reached < SEARCHED


@pytest.mark.parametrize("steps", [1, 2, 3, 4])
def test_too_few_load_steps_are_refused(steps):
    with pytest.raises(UserError, match=f"more than {steps} load steps would be needed"):
        first_frame(ELASTICA, [f"effects.large_deformation.load_steps={steps}"], PETSc.COMM_WORLD)


def test_enough_load_steps_bear_the_whole_load():
    # K. Mattiasson, Int. J. Numer. Meth. Engng 17 (1981) 145.
    row = first_frame(ELASTICA, ["effects.large_deformation.load_steps=24"], PETSc.COMM_WORLD).row
    assert (-row["q_down"], -row["q_back"]) == pytest.approx((0.493457, 0.160642), rel=2e-4)


def test_the_other_reference_agrees_with_elliptic_integrals():
    assert stretched_elastica(10, 1e-4) == pytest.approx((0.810609, 0.554996), rel=1e-4)


@pytest.mark.parametrize("load", [100, 1000])
def test_a_strip_far_softer_in_bending_than_in_tension(load):
    # The goal is far below the forces of stretching that steps along the bent strip bring up.
    row = first_frame(ELASTICA, [f"parameters.load={load}"], PETSc.COMM_WORLD).row
    assert (-row["q_down"], -row["q_back"]) == pytest.approx(stretched_elastica(load), rel=2e-3)


@pytest.mark.parametrize(("angle", "aside"), [(60, 1e-4), (100, 1e-4), (120, 1e-3), (130, 5.3e-4), (148.5, 7.4e-4)])
def test_a_column_is_followed_past_its_buckling_load(angle, aside):
    """S. P. Timoshenko, J. M. Gere, Theory of Elastic Stability, 1961, 2.7: the load at which its tip has an angle.

    The last ones are at two and three times its buckling load, pushed aside by 1e-4 of the load.
    """
    k = np.sin(np.radians(angle) / 2)
    K, E = ellipk(k * k), ellipe(k * k)
    axial = f"-{K * K}*E*h^3/12"
    values = [f"parameters.load={aside}", f'loads.tip.force=["{axial}","-load*E*h^3/12"]']
    row = first_frame(ELASTICA, values, PETSc.COMM_WORLD).row
    assert (-row["q_down"], -row["q_back"]) == pytest.approx((2 * k / K, 2 - 2 * E / K), rel=4e-3)


def pressed_elastica(pressure, rigidity):
    """Tip (x, y) and angle of an inextensible strip of length 1, clamped along x, pressed down by what follows it.

    Args:
        pressure: force [N] a length [m].
        rigidity: E I [N m^2].
    """
    s = np.linspace(0, 1, 400)
    y = np.zeros((6, len(s)))
    y[0] = s
    for p in pressure * np.linspace(0.1, 1, 10):

        def slopes(s, y, p=p):
            _, _, angle, bend, fx, fy = y
            sine, cosine = np.sin(angle), np.cos(angle)
            return np.array([cosine, sine, bend, (fx * sine - fy * cosine) / rigidity, -p * sine, p * cosine])

        found = solve_bvp(slopes, lambda a, b: np.array([*a[:3], *b[3:]]), s, y, tol=1e-6, max_nodes=100_000)
        assert found.success, found.message
        s, y = found.x, found.y
    return y[:3, -1]


def test_a_pressure_that_follows_is_put_on_in_steps(tmp_path):
    # No dead load takes it away: a strip that curls up by 116 degrees is not met by steps that try to.
    height, pressure = 0.02, 10.0
    strip = beam(solid(), f'\n[loads.p]\non = "top"\npressure = {pressure}\n', height=height, size=0.02)
    (row,) = rows_of(make_replay(write_scene(tmp_path, strip), overrides=["mesh.order=2"]))
    x, y, angle = pressed_elastica(pressure, 1e6 * height**3 / 12 / (1 - 0.3**2))
    corner = x - height / 2 * np.sin(angle) - 1, y + height / 2 * (np.cos(angle) - 1)
    assert angle < -2 and (row["q_x"], row["q_y"]) == pytest.approx(corner, abs=0.012)


def test_a_bent_strip_that_is_drawn_out_takes_no_longer_than_one_from_rest(tmp_path):
    # What keeps its shape on the longer strip is a load under which it is unstable: short steps lead nowhere.
    events = [{"do": "press", "on": "right"}, {"do": "drag", "to": [1.15, 0], "frames": 3}]
    script = write_script(tmp_path, [{"t": 0.1 * k} | event for k, event in enumerate(events)])
    first, _, *rows = rows_of(make_replay(ELASTICA, script, overrides=["parameters.load=5"]))
    assert all(row["newton"] < 1.5 * first["newton"] for row in rows)
    length = 1.15
    tip = stretched_elastica(5 * length**2)
    assert (-rows[-1]["q_down"], -rows[-1]["q_back"]) == pytest.approx(tuple(length * u for u in tip), rel=2e-3)
