"""Flow: exact flows, also while the mesh moves; rates of convergence, forces that balance, reuse beside cold solves."""

from itertools import pairwise

import numpy as np
import pytest
from counted_replays import begin_log, kernels, watched
from flow_scenes import CHANNEL, CYLINDER
from restshape_studies.stability.scenery import across, drag, make_replay, write_scene, write_script
from restshape_verification.flow.scenes import HEAD, SLOW, SQUARE, STEADY, everywhere, in_time, kovasznay
from thermal_scenes import solved

from restshape.analysis.frame import Frame
from restshape.fem.elements import MASS
from restshape.fem.residuals import design_rates
from restshape.physics.flow.flow_declaration import FlowSettings
from restshape.physics.flow.history import Level, Past
from restshape.policy import POLICIES
from restshape.replay.parity import Parity

DRAG = drag("window", (0.4, 0.5), across((0.4, 0.5), (0.6, 0.55), 8))
FAR = drag("window", (0.4, 0.5), across((0.4, 0.5), (0.7, 0.6), 3))


def largest_error(folder, text, script, exact, policy="auto"):
    """The largest error of the velocity in frames that begin with the exact one, and their levels of reuse."""
    made, worst, levels = make_replay(write_scene(folder, text), write_script(folder, script), policy), 0.0, set()
    for row in made.frames():
        analysis = made.analysis
        velocity = exact(analysis.space.X)
        if row["index"] == 0 and "time_step" in text:
            analysis.begin(np.column_stack([velocity, np.zeros(len(velocity))]))
        worst = max(worst, float(np.abs(analysis.x[:, :2] - velocity).max()))
        levels.add(row["level"])
    return worst, levels


def uniform(X):
    return np.broadcast_to([1.0, 0.3], X.shape)


def shear(X):
    return np.column_stack([X[:, 1], 0.0 * X[:, 1]])


@pytest.mark.parametrize("policy", POLICIES)
@pytest.mark.parametrize("effects", [STEADY, SLOW, in_time(), in_time(scheme="backward_euler", steps=2)])
def test_a_uniform_stream_stays_one_while_a_body_is_dragged(tmp_path, effects, policy):
    worst, _ = largest_error(tmp_path, everywhere("[1, 0.3]", effects), DRAG, uniform, policy)
    assert worst < 1e-8


@pytest.mark.parametrize("script", [DRAG, FAR])
@pytest.mark.parametrize(
    "effects", [STEADY, in_time(), in_time(scheme="backward_euler"), in_time(convection=False), in_time(steps=3)]
)
def test_a_steady_shear_stays_one_while_a_body_is_dragged(tmp_path, effects, script):
    """u = (y, 0), which is linear in space, is no other for any motion of the mesh, flips and new meshes."""
    worst, levels = largest_error(tmp_path, everywhere('["y", 0]', effects), script, shear)
    assert worst < 1e-8 and 3 in levels


RE = 40
DECAY = RE / 2 - np.sqrt(RE**2 / 4 + 4 * np.pi**2)
KOVASZNAY = kovasznay(float(DECAY), 1 / RE) + "[solve]\ntolerance = 1e-10\n"


def behind_a_grid(X):
    """Velocity and pressure (n, 3), of mean 0. Source: Kovasznay, Proc. Camb. Phil. Soc. 44 (1948) 58."""
    x, y = X.T
    e = np.exp(DECAY * x)
    mean = -(np.exp(2 * DECAY) - 1) / (4 * DECAY)
    return np.column_stack(
        [1 - e * np.cos(2 * np.pi * y), DECAY / (2 * np.pi) * e * np.sin(2 * np.pi * y), -e * e / 2 - mean]
    )


@pytest.mark.slow
def test_rates_of_kovasznays_flow(tmp_path):
    found = []
    for size in (0.05, 0.025, 0.0125):
        analysis = solved(tmp_path, KOVASZNAY + f"[mesh]\nsize = {size}\n").analysis
        x, space = analysis.x.copy(), analysis.space
        x[:, 2] = analysis.problem.pressure(x)
        found.append((len(space.cells) ** -0.5, *l2_errors(space, x - behind_a_grid(space.X))))
    h, velocity, pressure = np.log(np.array(found)).T
    assert (velocity[-1] - velocity[0]) / (h[-1] - h[0]) > 1.9
    assert (pressure[-1] - pressure[0]) / (h[-1] - h[0]) > 1.4


def l2_errors(space, off):
    """The norms of nodal errors of velocity and of pressure."""
    mass = MASS["tri3"]
    parts = (off[:, :2], np.column_stack([off[:, 2], np.zeros(len(off))]))
    return [np.sqrt(2 * mass.energy(space.X, np.ascontiguousarray(p), space.cells, np.ones(1)).sum()) for p in parts]


def test_a_channel_without_a_body_in_closed_form(tmp_path):
    """u = 4 y (1 - y): friction 4 mu L on each wall, and 8 mu of pressure a metre."""
    text = CHANNEL + "[shape.points]\np = [0.5, 0.5]\nq = [2.5, 0.5]\n" + SLOW
    text += '[mesh]\nsize = 0.06\n[quantities]\ntop = { drag = true, at = "top" }\n'
    text += 'bottom = { drag = true, at = "bottom" }\ndrop = { pressure_drop = { from = "p", to = "q" } }\n'
    text += 'out = { flux = true, at = "outlet" }\nfast = { speed = true }\nenergy = { kinetic = true }\n'
    text += 'force = { drag_coefficient = { speed = 2, length = 0.5 }, at = "top" }\n'
    row = solved(tmp_path, text, "fluid.depth=2").row
    # At the ends the inlet has its part of what holds the corner.
    assert row["q_top"] == pytest.approx(2 * 1.2, rel=0.04) and row["q_bottom"] == pytest.approx(row["q_top"], rel=0.02)
    assert row["q_force"] == pytest.approx(row["q_top"] / (0.5 * 1.5 * 4 * 0.5 * 2), rel=1e-12)
    assert row["q_drop"] == pytest.approx(1.6, rel=0.01)
    assert row["q_out"] == pytest.approx(2 * 2 / 3, rel=0.01)
    assert row["q_fast"] == pytest.approx(1.0, rel=0.01)
    assert row["q_energy"] == pytest.approx(2 * 0.5 * 1.5 * 3 * 8 / 15, rel=0.02)


def test_a_solution_is_the_velocity_alone(tmp_path):
    """Which has a norm: pressures have another unit."""
    analysis = solved(tmp_path, CYLINDER + STEADY + "[mesh]\nsize = 0.2\n").analysis
    found = analysis.solution()
    assert found.name == "velocity"
    np.testing.assert_array_equal(found.field, analysis.x[:, :2])


BODY = '[quantities]\ndrag = { drag = true, at = "body" }\nlift = { lift = true, at = "body" }\n'
MOVED = drag("body", (1.0, 0.5), across((1.0, 0.5), (1.3, 0.6), 5))


@pytest.mark.parametrize("policy", POLICIES)
@pytest.mark.parametrize("effects", [STEADY, in_time(0.1)])
def test_reuse_gives_what_cold_solves_give(tmp_path, effects, policy):
    text = CYLINDER + effects + BODY + "[mesh]\nsize = 0.12\nnear = { body = 0.05 }\n"
    made = make_replay(write_scene(tmp_path, text), write_script(tmp_path, MOVED), policy)
    check = Parity(made)
    for _ in made.frames():
        check()
    assert check.summary()["holds"], check.summary()


RING = """
[shape]
outline = ["lower", "upper"]
vertices = { west = [-2, 0], east = [2, 0] }
edges.lower = { arc = ["west", "east"], bulge = 1 }
edges.upper = { arc = ["east", "west"], bulge = 1 }
holes.bore = { circle = { center = [0, 0], radius = 1 } }
[fluid]
rho = 1
mu = 1
[boundary.turning]
on = "bore"
velocity = ["-2*y", "2*x"]
[mesh]
size = 0.1
"""
"""Between two circles, of which the inner one turns."""


@pytest.mark.parametrize("policy", ["auto", "refactor"])
def test_a_ring_agrees_with_cold_solves_on_its_way_back(tmp_path, policy):
    """The residual of Newton's last step is smooth: with one next to the tolerance the flow was off by 1.5 times as
    much."""
    events = [*drag("bore", (0, 0), across((0, 0), (0.4, 0), 5)), {"do": "undo", "t": 9.0}]
    made = make_replay(write_scene(tmp_path, HEAD + RING + STEADY), write_script(tmp_path, events), policy)
    check = Parity(made)
    for _ in made.frames():
        check()
    assert check.summary()["holds"], check.summary()


@pytest.mark.slow
def test_a_body_that_is_brought_back_has_the_forces_that_it_had(tmp_path):
    there, back = across((1.0, 0.5), (1.2, 0.56), 3), across((1.2, 0.56), (1.0, 0.5), 3)
    text = CYLINDER + STEADY + BODY + "[solve]\ntolerance = 1e-9\n[mesh]\nsize = 0.1\nnear = { body = 0.04 }\n"
    made = make_replay(write_scene(tmp_path, text), write_script(tmp_path, drag("body", (1.0, 0.5), [*there, *back])))
    rows = [dict(row) for row in made.frames()]
    assert rows[-1]["level"] < 3 and abs(rows[4]["q_drag"] - rows[0]["q_drag"]) > 0.01
    assert rows[-1]["q_drag"] == pytest.approx(rows[0]["q_drag"], rel=1e-8)


@pytest.mark.slow
def test_drag_follows_its_derivative_by_the_design(tmp_path):
    """The remainder of first order, when nodes move, is of second order."""
    made = solved(tmp_path, CYLINDER + STEADY + BODY + "[solve]\ntolerance = 1e-12\n[mesh]\nsize = 0.12\n")
    analysis = made.analysis
    problem, space, x = analysis.problem, analysis.space, analysis.x
    X = space.X.copy()
    dX = 0.02 * np.stack([np.sin(np.pi * X[:, 1]) * X[:, 0] * (3 - X[:, 0]), X[:, 1] * (1 - X[:, 1])], axis=1)
    rates, prescribed = design_rates(problem, x, dX)
    problem.boundary.zero(rates)
    dx = prescribed - analysis.linear_solve(rates, 1e-12)
    frame = Frame(space, np.empty(0, np.int32), None, analysis.state.scene, (None, (0.0, 0.0)))
    remainders = []
    for h in (0.5, 0.25):
        space.X[:] = X + h * dX
        space.geometry += 1
        analysis.solve(frame)
        remainders.append(np.linalg.norm(analysis.x - x - h * dx))
    assert np.log2(remainders[0] / remainders[1]) > 1.9


def test_frames_are_predicted_along_a_drag(tmp_path):
    text = CYLINDER + STEADY + BODY + "[mesh]\nsize = 0.12\nnear = { body = 0.05 }\n"
    script = write_script(tmp_path, drag("body", (1.0, 0.5), across((1.0, 0.5), (1.04, 0.51), 4)))
    solved_rows, rows = (
        [dict(row) for row in make_replay(write_scene(tmp_path, text), script, predict=way).frames()]
        for way in ("none", "linear")
    )
    assert any(row["predicted"] for row in rows)
    for row, other in zip(rows, solved_rows):
        assert row["q_drag"] == pytest.approx(other["q_drag"], rel=5e-3)


VORTICES = (
    HEAD
    + SQUARE
    + "[fluid]\nrho = 1\nmu = 0.05\n"
    + '[boundary.sides]\non = "outline"\nvelocity = ["-cos(pi*x)*sin(pi*y)*exp(-0.1*pi^2*t)", '
    + '"sin(pi*x)*cos(pi*y)*exp(-0.1*pi^2*t)"]\n[solve]\ntolerance = 1e-10\n'
)


def vortices(X, t):
    """Velocity and pressure (n, 3). Source: Taylor and Green, Proc. R. Soc. Lond. A 158 (1937) 499."""
    x, y = np.pi * X.T
    decay = np.exp(-0.1 * np.pi**2 * t)
    return np.column_stack(
        [
            -np.cos(x) * np.sin(y) * decay,
            np.sin(x) * np.cos(y) * decay,
            -0.25 * (np.cos(2 * x) + np.cos(2 * y)) * decay**2,
        ]
    )


def test_a_difference_of_two_lengths_is_exact_for_parabolas():
    """u = t^2 and X = t^2 at 0, 0.1 and 0.3 s have the rates 0.6."""
    cells = np.zeros((1, 3), np.int32)
    first, second = (Level(np.full((1, 2), t**2), np.full((1, 2), t**2), cells) for t in (0.0, 0.1))
    past = Past(0.1, second, first, 0.1)
    step = past.step(np.full((1, 2), 0.09), FlowSettings(time_step=0.2))
    assert step.time == pytest.approx(0.3)
    np.testing.assert_allclose(step.rate * 0.09 + step.past, 0.6)
    np.testing.assert_allclose(step.mesh_velocity, 0.6)
    longer = past.step(np.full((1, 2), 0.09), FlowSettings(time_step=0.3))
    assert longer.rate == pytest.approx(1 / 0.3)


@pytest.mark.slow
@pytest.mark.parametrize(("scheme", "order"), [("bdf2", 2.0), ("backward_euler", 1.0)])
@pytest.mark.parametrize("moves", [False, True])
def test_order_in_time_of_decaying_vortices(tmp_path, scheme, order, moves):
    found = []
    for steps in (8, 16, 32):
        dt = 1.6 / steps
        analysis = solved(tmp_path, VORTICES + in_time(dt, scheme) + "[mesh]\nsize = 0.05\n").analysis
        space, scene = analysis.space, analysis.state.scene
        X = space.X.copy()
        analysis.begin(vortices(X, 0.0))
        for k in range(steps):
            if moves:
                bump = np.sin(np.pi * X[:, 0]) * np.sin(np.pi * X[:, 1]) * np.sin(2 * np.pi * (k + 1) / steps)
                space.X[:] = X + 0.05 * bump[:, None]
                space.geometry += 1
            analysis.solve(Frame(space, np.empty(0, np.int32), None, scene, (None, (0.0, 0.0))))
        assert analysis.time == pytest.approx(1.6)
        np.testing.assert_allclose(space.X, X, atol=1e-12)
        found.append(analysis.x[:, :2].copy())
    first, second = (np.linalg.norm(a - b) for a, b in pairwise(found))
    assert np.log2(first / second) > order - 0.25
    np.testing.assert_allclose(found[-1], vortices(X, 1.6)[:, :2], atol=0.02)


def test_what_is_off_makes_no_element_call(tmp_path):
    """Convection, time and the motion of the mesh each have elements of their own."""
    begin_log()
    moved_only, still = drag("window", (0.4, 0.5), [(0.42, 0.5)]), [{"do": "idle", "frames": 2}]
    scene = {name: everywhere('["y", 0]', effects) for name, effects in (("slow", SLOW), ("steady", STEADY))}
    # The scheme of second order takes a step of Oseen's equations where a flow begins suddenly.
    scene["in_time"] = everywhere('["y", 0]', in_time(scheme="backward_euler"))
    called = {}
    for name, text in scene.items():
        for motion, script in (("moved", moved_only), ("still", still)):
            path = write_scene(tmp_path, text)
            called[name, motion] = {
                one for one in kernels(watched(path, write_script(tmp_path, script))[0]) if "flow" in one
            }
    assert called["slow", "moved"] == called["slow", "still"] == {"slow_flow_tri3"}
    assert called["steady", "moved"] == {"flow_tri3"}
    assert called["in_time", "still"] == {"unsteady_flow_tri3"}
    assert called["in_time", "moved"] == {"unsteady_flow_tri3", "unsteady_flow_on_moving_mesh_tri3"}
