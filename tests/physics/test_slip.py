"""Slip: at any angle and on curved edges, in closed form, while edges are dragged, and its derivatives."""

import json

import numpy as np
import pytest
from restshape_studies.stability.scenery import drag, make_replay, write_scene, write_script
from restshape_verification.flow.heated_scenes import BUOYANT, CAVITY
from restshape_verification.flow.heated_scenes import STEADY as HEATED
from restshape_verification.flow.scenes import HEAD, SLOW, STEADY, in_time
from thermal_scenes import solved

from restshape.analysis.frame import Frame
from restshape.fem.residuals import design_rates
from restshape.fem.sliding import Sliding
from restshape.policy import POLICIES
from restshape.replay.parity import Parity

FORCES = '[quantities]\ndrag = { drag = true, at = "body" }\nlift = { lift = true, at = "body" }\n'


def channel(angle, effects, radius=0.0, tolerance=1e-11, size=0.12):
    """A channel of 3 m by 1 m at an angle, with slip on both sides and a stream of 1 m/s along it."""
    along = np.array([np.cos(angle), np.sin(angle)])
    corners = {name: x * along + y * np.array([-along[1], along[0]]) for name, x, y in PLACES}
    center = corners.pop("center").tolist()
    body = f"[shape.holes.body]\ncircle = {{ center = {center}, radius = {radius} }}\n" if radius else ""
    vertices = ", ".join(f"{name} = {at.tolist()}" for name, at in corners.items())
    return (
        HEAD
        + f'[shape]\noutline = ["bottom", "outlet", "top", "inlet"]\nvertices = {{ {vertices} }}\n[shape.edges]\n'
        + 'bottom = { line = ["a", "b"] }\noutlet = { line = ["b", "c"] }\n'
        + 'top = { line = ["c", "d"] }\ninlet = { line = ["d", "a"] }\n'
        + f"{body}[fluid]\nrho = 1.5\nmu = 0.05\n"
        + f'[boundary.in]\non = "inlet"\nvelocity = {along.tolist()}\n[boundary.out]\non = "outlet"\noutflow = true\n'
        + '[boundary.sides]\non = ["top", "bottom"]\nslip = true\n'
        + f"{effects}{FORCES if radius else ''}[solve]\ntolerance = {tolerance}\n[mesh]\nsize = {size}\n"
    )


PLACES = (("a", 0, 0), ("b", 3, 0), ("c", 3, 1), ("d", 0, 1), ("center", 1, 0.5))
LEVER = [{"do": "press", "on": "c"}, {"do": "drag", "path": [[2.6, 2.3], [2.0, 2.5]], "frames": 6}, {"do": "release"}]


@pytest.mark.parametrize("policy", POLICIES)
@pytest.mark.parametrize("effects", [STEADY, SLOW, in_time()])
def test_a_stream_along_an_inclined_channel_stays_uniform_while_it_is_dragged(tmp_path, effects, policy):
    """The channel is 0.6 rad steep; its inlet is dragged along the channel, and back."""
    along = np.array([np.cos(0.6), np.sin(0.6)])
    there = [(-0.2 * k * along + 0.5 * np.array([-along[1], along[0]])).tolist() for k in (1, 2, 3, 2, 1)]
    script = write_script(tmp_path, drag("inlet", tuple(0.5 * np.array([-along[1], along[0]])), there))
    made = make_replay(write_scene(tmp_path, channel(0.6, effects)), script, policy)
    for row in made.frames():
        analysis = made.analysis
        if row["index"] == 0 and "time_step" in effects:
            analysis.begin(np.column_stack([np.tile(along, (len(analysis.x), 1)), np.zeros(len(analysis.x))]))
        assert np.abs(analysis.x[:, :2] - along).max() < 1e-8 and not row["refused"]
    assert np.abs(analysis.x[:, 2]).max() < 1e-8


@pytest.mark.parametrize("effects", [STEADY, SLOW])
def test_an_inclined_channel_is_the_parallel_one_turned(tmp_path, effects):
    angle = 0.7
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    parallel = solved(tmp_path, channel(0.0, effects, 0.15)).analysis
    turned = solved(tmp_path, channel(angle, effects, 0.15)).analysis.state.scene
    space, x = parallel.space, parallel.x.copy()
    space.X[:] = space.X @ turn
    space.geometry += 1
    parallel.solve(Frame(space, np.empty(0, np.int32), None, turned, (None, (0.0, 0.0))))
    np.testing.assert_allclose(parallel.x[:, :2], x[:, :2] @ turn, atol=1e-8)
    np.testing.assert_allclose(parallel.x[:, 2], x[:, 2], atol=1e-8)
    assert np.ptp(x[:, 2]) > 0.5


def test_nothing_slides_at_a_corner_and_nothing_passes_an_edge():
    """A square whose upper edge has a kink of 0.1 rad: there the normal is that of both parts."""
    X = np.array([[0, 0], [1, 0], [1, 1], [0.5, 1.025], [0, 1.0]])
    facets = np.array([[0, 1], [1, 2], [2, 3], [3, 4]], dtype=np.int32)
    sliding = Sliding(facets, np.arange(4), np.array([0]))
    sliding.update(X)
    assert sliding.nodes.tolist() == [1, 2, 3, 4]
    u = np.ones((5, 3))
    sliding.project(u)
    assert np.all(u[[1, 2], :2] == 0.0) and np.all(u[:, 2] == 1.0)
    np.testing.assert_allclose(u[3, :2], [1.0, 0.0], atol=1e-12)
    assert u[4, :2] @ [-0.05, 1.0] == pytest.approx(0.0, abs=1e-12)


def annulus(velocity, effects, size, mu=0.7):
    """Fluid between two circles, of radii 1 and 0.4, with slip on the inner one."""
    outer = '[shape]\noutline = ["up", "down"]\nvertices = { r = [1, 0], l = [-1, 0] }\n[shape.edges]\n'
    outer += 'up = { arc = ["r", "l"], through = [0, 1] }\ndown = { arc = ["l", "r"], through = [0, -1] }\n'
    return (
        HEAD
        + outer
        + "[shape.holes.body]\ncircle = { center = [0, 0], radius = 0.4 }\n"
        + f"[fluid]\nrho = 1\nmu = {mu}\n[boundary.far]\non = 'outline'\nvelocity = {velocity}\n"
        + f"[boundary.bubble]\non = 'body'\nslip = true\n{effects}{FORCES}[solve]\ntolerance = 1e-11\n"
        + f"[mesh]\nsize = {size}\n"
    )


def test_a_stiff_rotation_passes_a_circle_with_slip(tmp_path):
    """It has no friction: without the part of the friction that curvature makes the circle would hold it back."""
    analysis = solved(tmp_path, annulus('["-y", "x"]', SLOW, 0.1)).analysis
    X, x = analysis.space.X, analysis.x
    np.testing.assert_allclose(x[:, :2], np.column_stack([-X[:, 1], X[:, 0]]), atol=2e-3)


def bubble(X, radius=0.4):
    """Slow flow (n, 2) about a circle without friction: u_r = ln(r/R) cos, u_t = -(1 + ln(r/R)) sin.

    Source: the stream function r ln(r/R) sin, biharmonic, with no shear at r = R; its drag is 4 pi mu.
    """
    r = np.linalg.norm(X, axis=1)
    c, s = X.T / r
    log = np.log(r / radius)
    return np.column_stack([log * c * c + (1 + log) * s * s, log * c * s - (1 + log) * c * s])


def test_order_of_the_slow_flow_around_a_circle_with_slip(tmp_path):
    r, log = "(x^2 + y^2)", "0.5*log((x^2 + y^2)/0.16)"
    far = f'["({log}*x^2 + (1 + {log})*y^2)/{r}", "-x*y/{r}"]'
    found = []
    for size in (0.1, 0.05, 0.025):
        made = solved(tmp_path, annulus(far, SLOW, size))
        X, x = made.analysis.space.X, made.analysis.x
        off = np.sqrt(np.mean((x[:, :2] - bubble(X)) ** 2))
        found.append((len(X) ** -0.5, off, abs(made.row["q_drag"] / (4 * np.pi * 0.7) - 1)))
    h, velocity, _ = np.log(np.array(found)).T
    assert (velocity[-1] - velocity[0]) / (h[-1] - h[0]) > 1.8
    assert found[-1][2] < 0.01


def test_unknowns_follow_their_derivative_by_the_design(tmp_path):
    """Normals that turn are in it: the remainder of first order is of second order."""
    far = '["1 + 0.3*y", "0.2*x"]'
    analysis = solved(tmp_path, annulus(far, STEADY, 0.15, 0.1)).analysis
    problem, space, x = analysis.problem, analysis.space, analysis.x
    X = space.X.copy()
    inside = (1 - np.sum(X**2, axis=1))[:, None]
    dX = 0.2 * inside * np.column_stack([np.sin(2 * X[:, 1]), X[:, 0] ** 2 + X[:, 1]])
    rates, prescribed = design_rates(problem, x, dX)
    problem.boundary.zero(rates)
    dx = prescribed - analysis.linear_solve(rates, 1e-12)
    frame = Frame(space, np.empty(0, np.int32), None, analysis.state.scene, (None, (0.0, 0.0)))
    remainders = []
    for h in (0.4, 0.2, 0.1):
        space.X[:] = X + h * dX
        space.geometry += 1
        analysis.solve(frame)
        remainders.append(np.linalg.norm(analysis.x - x - h * dx))
    assert np.log2(remainders[1] / remainders[2]) > 1.9


@pytest.mark.slow
def test_two_ranks_give_what_one_gives(on_ranks, tmp_path):
    """Each projects the rows of its own nodes."""
    scene, found = write_scene(tmp_path, channel(0.3, STEADY, 0.12, 1e-8)), []
    script = write_script(tmp_path, LEVER)
    for ranks in (1, 2):
        done = on_ranks(ranks, "replay", scene, "--edits", script, "--parity", "--json", f"{ranks}.json")
        assert done.returncode == 0, done.stderr
        found.append(json.loads((tmp_path / f"{ranks}.json").read_text())["quantities"]["drag"])
    np.testing.assert_allclose(found[0], found[1], rtol=1e-5)


@pytest.mark.parametrize("policy", POLICIES)
def test_reuse_gives_what_cold_solves_give_where_slip_turns(tmp_path, policy):
    text = channel(0.3, STEADY, 0.12, 1e-6)
    made = make_replay(write_scene(tmp_path, text), write_script(tmp_path, LEVER), policy)
    check = Parity(made)
    for row in made.frames():
        assert not row["refused"]
        check()
    assert check.summary()["holds"], check.summary()


@pytest.mark.parametrize("coupling", ["monolithic", "split"])
def test_a_heated_vessel_with_slip_is_the_same_when_it_is_turned_with_gravity(tmp_path, coupling):
    """Velocity, pressure and temperature in one matrix, or in turn: what slides are the first two of each node."""
    walls = CAVITY.replace("wall = true", "slip = true") + '[boundary.ends]\non = ["top", "bottom"]\nslip = true\n'
    effects = HEATED.replace("heat = {}", f'heat = {{ coupling = "{coupling}" }}') + BUOYANT
    text = walls + effects + "[solve]\ntolerance = 1e-10\n[mesh]\nsize = 0.12\n"
    turn = np.array([[np.cos(0.5), np.sin(0.5)], [-np.sin(0.5), np.cos(0.5)]])
    down = np.array([0.0, -1.0]) @ turn
    vessel = solved(tmp_path, text).analysis
    turned = solved(tmp_path, text.replace('[0, "-1 m/s^2"]', str(down.tolist()))).analysis.state.scene
    space, x = vessel.space, vessel.x.copy()
    space.X[:] = space.X @ turn
    space.geometry += 1
    vessel.solve(Frame(space, np.empty(0, np.int32), None, turned, (None, (0.0, 0.0))))
    speed = np.abs(x[:, :2]).max()
    np.testing.assert_allclose(vessel.x[:, :2], x[:, :2] @ turn, atol=1e-6 * speed)
    np.testing.assert_allclose(vessel.x[:, 3], x[:, 3], atol=1e-6)
    on_top = np.isclose(space.X @ turn.T, 1.0)[:, 1]
    assert speed > 5.0 and np.abs(x[on_top, 0]).max() > 0.3 * speed and np.abs(x[on_top, 1]).max() < 1e-12
