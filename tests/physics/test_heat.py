"""Conduction: rates of convergence, closed forms, balance of heat, decay in time, derivatives by the design."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from restshape_studies.stability.scenery import across, drag, make_replay, rows_of, write_scene, write_script
from restshape_studies.validation.norms import errors
from thermal_scenes import ANNULUS, COOLING, HEAD, MANUFACTURED, SQUARE, solved, steady

from restshape.algebra.reuse.traits import Traits
from restshape.analysis.frame import Frame
from restshape.errors import UserError
from restshape.fem.elements import OSEEN
from restshape.fem.problem import INTERNAL
from restshape.fem.residuals import design_rates, unconstrained_residual
from restshape.physics.heat.conduction import HeatConduction
from restshape.policy import POLICIES


def gradient(X):
    """The gradient (n, 1, 2) of the manufactured temperature."""
    x, y = X.T
    return np.stack(
        [
            np.pi * np.cos(np.pi * x) * np.sin(np.pi * y) + 2 * x * y,
            np.pi * np.sin(np.pi * x) * np.cos(np.pi * y) + x * x,
        ],
        axis=1,
    )[:, None]


@pytest.mark.parametrize(("order", "l2", "h1"), [(1, 2.0, 1.0), (2, 3.0, 2.0)])
def test_rates_of_a_manufactured_solution(tmp_path, order, l2, h1):
    found = []
    for size in (0.1, 0.05, 0.025):
        analysis = solved(tmp_path, MANUFACTURED, f"mesh.size={size}", f"mesh.order={order}").analysis
        space = analysis.space
        found.append((len(space.cells) ** -0.5, *errors(space, analysis.x, lambda X: steady(X)[:, None], gradient)))
    h, *errs = np.log(np.array(found)).T
    for error, rate in zip(errs, (l2, h1)):
        assert (error[-1] - error[0]) / (h[-1] - h[0]) == pytest.approx(rate, abs=0.15)


def test_a_pipe_in_air_in_closed_form(tmp_path):
    # The resistances of wall and film in series: ln(b/a)/(2 pi k) + 1/(2 pi b h).
    flow = 2 * np.pi * 100 / (np.log(2) / 15 + 1 / (0.2 * 50))
    row = solved(tmp_path, ANNULUS).row
    assert row["q_outer"] == pytest.approx(300 + flow / (2 * np.pi * 0.2 * 50), rel=1e-5)
    assert row["q_entered"] == pytest.approx(-flow, rel=1e-4)
    assert row["q_left1"] + row["q_left2"] == pytest.approx(-row["q_entered"], rel=1e-8)


@pytest.mark.parametrize("order", [1, 2])
def test_heat_that_enters_leaves_in_every_frame(tmp_path, order):
    edges = ("left", "bottom", "right", "top")
    text = MANUFACTURED + "[quantities]\n"
    text += "".join(f'{edge} = {{ heat_flow = true, at = "{edge}" }}\n' for edge in (*edges, "pipe"))
    script = write_script(tmp_path, drag("pipe", (0.5, 0.5), across((0.5, 0.5), (0.6, 0.58), 5)))
    made = make_replay(write_scene(tmp_path, text.replace("order = 2", f"order = {order}")), script)
    for row in made.frames():
        out = np.zeros_like(made.analysis.x)
        made.analysis.problem.integrals(INTERNAL)[0].add_residual(np.zeros_like(out), out)
        leaving = sum(row[f"q_{edge}"] for edge in (*edges, "pipe"))
        assert leaving == pytest.approx(-out.sum(), rel=1e-8)


@pytest.mark.parametrize("name", POLICIES)
def test_a_linear_temperature_is_exact_under_each_policy(tmp_path, name):
    text = (
        HEAD + SQUARE + "[shape.holes.pipe]\ncircle = { center = [0.5, 0.5], radius = 0.2 }\n"
        '[material.m]\nconductivity = 2\n[supports.round]\non = ["outline", "pipe"]\n'
        'fix = { temperature = "300 + 20*x - 7*y" }\n[solve]\ntolerance = 1e-12\n[mesh]\nsize = 0.12\n'
    )
    script = write_script(tmp_path, drag("pipe", (0.5, 0.5), across((0.5, 0.5), (0.65, 0.6), 10)))
    made = make_replay(write_scene(tmp_path, text), script, name)
    for _ in made.frames():
        X = made.analysis.space.X
        np.testing.assert_allclose(made.analysis.x[:, 0], 300 + X @ [20, -7], rtol=1e-10)
        assert made.analysis.compare_cold().solution < 1e-9


def test_design_derivative_by_the_taylor_remainder(tmp_path):
    made = solved(tmp_path, MANUFACTURED)
    problem, space, x = made.analysis.problem, made.analysis.space, made.analysis.x
    X, rng = space.X.copy(), np.random.default_rng(3)
    dX = 0.01 * np.stack([np.sin(3 * X[:, 1]), np.cos(2 * X[:, 0])], axis=1) + 1e-4 * rng.uniform(-1, 1, X.shape)
    rates, prescribed = design_rates(problem, x, dX)
    before = unconstrained_residual(problem, x)
    remainders = []
    for h in (0.5, 0.25):
        space.X[:] = X + h * dX
        problem.update()
        # Prescribed temperatures follow their place; at free nodes nothing changes.
        change = unconstrained_residual(problem, x + h * prescribed) - before
        remainders.append(np.linalg.norm(change - h * rates))
    assert np.log2(remainders[0] / remainders[1]) > 1.9


@pytest.mark.parametrize(("theta", "rate"), [(1.0, 1.0), (0.5, 2.0)])
@pytest.mark.parametrize(("capacity", "order", "near"), [("consistent", 2, 2e-4), ("lumped", 1, 3e-3)])
def test_the_first_mode_decays_as_it_should(tmp_path, theta, rate, capacity, order, near):
    decay, until, found = 2 * np.pi**2 / 300, 16.0, []
    for dt in (2.0, 1.0, 0.5):
        given = (f"effects.storage.time_step={dt}", f"effects.storage.theta={theta}", f"mesh.order={order}")
        made = solved(tmp_path, COOLING, *given, f"effects.storage.capacity={capacity}")
        analysis = made.analysis
        mode = np.sin(np.pi * analysis.space.X[:, :1])
        analysis.begin(mode, 0 * mode)
        for _ in range(round(until / dt)):
            frame = Frame(analysis.space, np.empty(0, np.int32), None, analysis.state.scene, (None, (0.0, 0.0)))
            analysis.solve(frame)
        assert analysis.time == pytest.approx(until)
        found.append(analysis.x)
    coarse, fine = (np.linalg.norm(a - b) for a, b in pairwise(found))
    assert np.log2(coarse / fine) == pytest.approx(rate, abs=0.1)
    limit = found[-1] + (found[-1] - found[-2]) / (2**rate - 1)
    np.testing.assert_allclose(limit, mode * np.exp(-decay * until), atol=near)


def test_heat_in_time_balances_what_is_stored(tmp_path):
    text = COOLING.replace("initial = 0", "initial = 350").replace("temperature = 0", "temperature = 300")
    text += '[quantities]\nleft = { heat_flow = true, at = "left" }\nright = { heat_flow = true, at = "right" }\n'
    script = write_script(tmp_path, [{"t": 0.0, "do": "idle", "frames": 12}])
    made = make_replay(write_scene(tmp_path, text), script)
    stored = []
    for row in made.frames():
        body = made.analysis.body
        stored.append(body.mass.momentum(made.analysis.x).sum())
        if len(stored) > 2:
            # Backward Euler: the flows at the end of a step take out what the step has lost.
            assert row["q_left"] + row["q_right"] == pytest.approx((stored[-2] - stored[-1]) / 0.5, rel=1e-6)
    assert stored[0] > stored[-1]


def test_a_body_that_nothing_holds_is_refused(tmp_path):
    text = MANUFACTURED[: MANUFACTURED.index("[supports.walls]")] + "[mesh]\nsize = 0.1\n"
    with pytest.raises(UserError, match="nothing holds the temperature"):
        solved(tmp_path, text)


def test_a_body_without_capacity_is_refused_in_time(tmp_path):
    with pytest.raises(UserError, match="without heat capacity"):
        solved(tmp_path, COOLING.replace("specific_heat = 3\n", ""))


def test_prediction_and_estimate_come_with_the_problem(tmp_path):
    script = write_script(tmp_path, drag("pipe", (0.5, 0.5), across((0.5, 0.5), (0.53, 0.52), 4)))
    rows = rows_of(make_replay(write_scene(tmp_path, MANUFACTURED), script, predict="linear"))
    assert any(row["predicted"] for row in rows)
    assert all(0 < row["estimate"] < 0.2 for row in rows)


STRIPS = (
    HEAD
    + SQUARE
    + "[material.m]\nconductivity = 2\n"
    + '[supports.cold]\non = "left"\nfix = { temperature = 300 }\n'
    + '[supports.hot]\non = "right"\nfix = { temperature = 310 }\n[quantities]\n'
    + "".join(f'{edge} = {{ heat_flow = true, at = "{edge}" }}\n' for edge in ("left", "right", "top", "bottom"))
    + 'all_round = { heat_flow = true, at = "outline" }\n'
)
CORE = "[shape.regions.core]\ncircle = { center = [0.5, 0.5], radius = 0.2 }\n"


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("size", [0.3, 2.0])
def test_an_insulated_edge_between_fixed_ones_passes_nothing(tmp_path, order, size):
    # Of the coarser mesh the insulated edges are one side each, both of whose ends are fixed.
    row = solved(tmp_path, STRIPS + f"[mesh]\nsize = {size}\norder = {order}\n").row
    assert row["q_left"] == pytest.approx(20.0, rel=1e-9) and row["q_right"] == pytest.approx(-20.0, rel=1e-9)
    assert row["q_top"] == row["q_bottom"] == 0.0
    assert row["q_all_round"] == pytest.approx(0.0, abs=1e-8)


def test_heat_through_the_border_of_an_inner_region_is_refused(tmp_path):
    text = STRIPS + 'q = { heat_flow = true, at = "core" }\n[mesh]\nsize = 0.3\n'
    with pytest.raises(UserError, match=r"at 'core', which lies inside"):
        solved(tmp_path, text.replace("[material.m]", CORE + "[material.m]"))


@pytest.mark.parametrize("theta", [1.0, 0.5])
def test_the_error_of_one_step_is_estimated(tmp_path, theta):
    """A step that begins on the first mode ends beside its exact decay, exp(-decay dt)."""
    decay, dt = 2 * np.pi**2 / 300, 2.0
    given = (f"effects.storage.time_step={dt}", f"effects.storage.theta={theta}", "mesh.order=2")
    analysis = solved(tmp_path, COOLING, *given).analysis
    mode = np.sin(np.pi * analysis.space.X[:, :1])
    analysis.begin(mode, 0 * mode)
    frame = Frame(analysis.space, np.empty(0, np.int32), None, analysis.state.scene, (None, (0.0, 0.0)))
    analysis.solve(frame)
    wrong = np.abs(analysis.x - np.exp(-decay * dt) * mode).max() / np.abs(analysis.x).max()
    assert analysis.errors()["estimate_time"] == pytest.approx(wrong, rel=0.15)


def test_no_heat_flows_through_a_body_of_one_temperature(tmp_path):
    """At time 0, whatever sources do later: the edge has the temperature of the body."""
    text = COOLING + '[loads.warm]\non = "all"\nsource = 1000\n[quantities]\n'
    text += 'left = { heat_flow = true, at = "left" }\nright = { heat_flow = true, at = "right" }\n'
    made = make_replay(write_scene(tmp_path, text), write_script(tmp_path, [{"t": 0.0, "do": "idle", "frames": 2}]))
    first, *_, last = rows_of(made)
    assert abs(first["q_left"]) < 1e-9 and abs(first["q_right"]) < 1e-9 < last["q_left"]


def test_unsymmetric_matrices_are_compared_without_an_energy_and_get_gmres(tmp_path, monkeypatch):
    # Conduction declared unsymmetric: its matrices are what they were, and nothing is least of an energy.
    monkeypatch.setattr(HeatConduction, "traits", lambda plan: Traits(False, False, 1, rigid_motions=False))
    analysis = solved(tmp_path, MANUFACTURED).analysis
    assert analysis.solver.ksp.getType() == "fgmres" and analysis.warm_system().energy is None
    compared = analysis.compare_cold()
    assert compared.entries < 1e-12 and compared.solution < 1e-8
    assert analysis.quantity_errors is None


def test_an_element_that_is_not_symmetric_is_noticed_where_its_physics_says_it_is(tmp_path, monkeypatch):
    integrals = HeatConduction.integrals

    def skewed(self, kind, part=1.0):
        found = integrals(self, kind, part)
        return [replace(one, element=OSEEN["tri6"]) for one in found] if kind == INTERNAL else found

    monkeypatch.setattr(HeatConduction, "integrals", skewed)
    with pytest.raises(ValueError, match="'heat' declares symmetric matrices, and the tangent of oseen"):
        solved(tmp_path, MANUFACTURED)
