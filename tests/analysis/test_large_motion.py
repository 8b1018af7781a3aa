"""Large motions: small ones are linear, energy is kept, steps too long are refused, reuse equals a cold solve."""

import numpy as np
import pytest
from large import LARGE, gravity
from small_scenes import across, drag, make_replay, rows_of, write_scene, write_script
from vibrating import DAMPED, SHAKEN, dynamics, idle, tower

from restshape.errors import ReplayProblem
from restshape.policy import POLICIES
from restshape.replay.parity import Parity

SOFT = '\n[effects.solid]\nmodel = "plane_strain"\n'


def swinging(tmp_path, *parts, name="auto", dt=0.01, steps=5, script=None, **more):
    return make_replay(tower(tmp_path, SOFT, LARGE, dynamics(dt, steps), *parts, **more), script, name)


def work_of_weight(analysis, g):
    """What gravity along x has done on the tower [J]: on a triangle, what it does at its centre."""
    X, cells = analysis.space.X, analysis.space.cells
    corners = X[cells]
    areas = 0.5 * np.abs(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    return 0.1 * 1000 * g * float(areas @ analysis.x[cells, 0].mean(axis=1))


@pytest.mark.parametrize("settings", [{}, {"beta": 0.3, "gamma": 0.55}])
@pytest.mark.parametrize("damped", ["", DAMPED])
def test_a_small_motion_is_linear(tmp_path, damped, settings):
    weak = SHAKEN.replace("acceleration = 3.0", "acceleration = 1e-4")
    script = write_script(tmp_path, [{"do": "idle", "frames": 8}])

    def swing(law):
        made = make_replay(tower(tmp_path, SOFT, law, dynamics(0.01, 5, **settings), weak, damped), script)
        return np.array([[row["q_sway"], row["q_energy"]] for row in rows_of(made)])

    large, linear = swing(LARGE), swing("")
    assert np.abs(linear[:, 0]).max() > 1e-7
    for found, wanted in zip(large.T, linear.T):
        np.testing.assert_allclose(found, wanted, atol=1e-4 * np.abs(wanted).max())


@pytest.mark.slow
def test_energy_is_the_work_of_gravity(tmp_path):
    # The sum of kinetic and strain energy less the work of the weight stays 0 to the order of the step squared.
    found = []
    for dt in (4e-3, 2e-3):
        made = swinging(tmp_path, gravity(15, 0), dt=dt, steps=round(0.4 / dt))
        list(made.frames())
        for _ in range(3):
            idle(made)
        analysis = made.analysis
        work = work_of_weight(analysis, 15)
        found.append(abs(analysis.energy() - work) / analysis.energy())
    assert found[1] < 1e-3 and found[1] < 0.5 * found[0]


@pytest.mark.slow
def test_a_step_too_long_is_refused(tmp_path):
    script = write_script(tmp_path, [{"do": "idle", "frames": 60}])
    made = swinging(tmp_path, gravity(40, 0), dt=0.15, steps=10, script=script)
    rows = rows_of(made)
    refused = [row["refused"] for row in rows if row["refused"]]
    assert refused and "time_step smaller" in refused[0]
    assert np.isfinite(made.analysis.x).all()


@pytest.mark.slow
@pytest.mark.parametrize("edited", [False, True])
def test_energy_gained_little_by_little_is_refused(tmp_path, edited):
    # A side of the tower is dragged by very little in each frame, or nothing is.
    frames, start = 90, (1.0, 1.0)
    path = across(start, (1.0 + 1e-7, 1.0), frames)
    events = drag("right", start, path) if edited else [{"do": "idle", "frames": frames}]
    slower = {"do": "set", "key": "effects.dynamics.time_step", "value": 1e-3}
    script = write_script(tmp_path, [*events, slower, {"do": "idle", "frames": 4}])
    made = swinging(tmp_path, gravity(25, 0), dt=0.1, steps=1, script=script)
    energies, gains = [], []

    def look(row):
        energies.append(made.analysis.energy())
        gains.append(energies[-1] - work_of_weight(made.analysis, 25))

    rows = rows_of(made, look)
    refused = [k for k, row in enumerate(rows) if row["refused"]]
    assert "gained" in rows[refused[0]]["refused"] and "time_step smaller" in rows[refused[0]]["refused"]
    shown = slice(0, refused[0])
    largest = np.maximum.accumulate(energies)
    # No frame gained much by itself, and none is shown in which all has grown by more than half of what was there.
    assert np.diff(gains[shown]).max() < 0.1 * largest[-1]
    assert np.all(gains[shown] <= 0.51 * (largest[shown] - gains[shown])) and max(gains[shown]) > 0.1 * largest[-1]
    # Nothing goes on until the step is made smaller, and then it does.
    last = next(k for k, row in enumerate(rows) if row["event"] == "set")
    assert refused == list(range(refused[0], last))
    assert np.ptp(np.array(gains)[last:]) < 1e-3 * largest[-1]


@pytest.mark.slow
@pytest.mark.parametrize("name", POLICIES)
def test_reuse_equals_a_cold_step(tmp_path, name):
    events = drag("window", (0.5, 1.4), across((0.5, 1.4), (0.45, 0.9), 8))
    made = swinging(tmp_path, gravity(10, 0), name=name, steps=3, script=write_script(tmp_path, events), window=True)
    check = Parity(made)
    rows = rows_of(made, lambda row: row.update(check()))
    assert [row["refused"] for row in rows if row["refused"]] == []
    assert check.summary()["entries"] <= 1e-13 and check.summary()["solution"] <= 1e-8
    assert max(row["q_sway"] for row in rows) > 0.01


def test_a_failed_step_leaves_the_motion_as_it_was(tmp_path):
    made = swinging(tmp_path, gravity(10, 0))
    list(made.frames())
    idle(made)
    analysis = made.analysis
    x, v, time = analysis.x.copy(), analysis.v.copy(), analysis.time
    analysis.body.problem.params[3] = 1e12
    with pytest.raises(ReplayProblem, match="smaller"):
        idle(made)
    np.testing.assert_array_equal(analysis.x, x)
    np.testing.assert_array_equal(analysis.v, v)
    assert analysis.time == time


BAND = """
format = "restshape-scene"
version = 1
app = "moving"
[shape]
outline = ["bottom", "right", "top", "left"]
vertices = { a = [0, 0], b = [0.15, 0], c = [0.15, 0.05], d = [0, 0.05] }
edges.bottom = { line = ["a", "b"] }
edges.right = { line = ["b", "c"] }
edges.top = { line = ["c", "d"] }
edges.left = { line = ["d", "a"] }
holes.hole = { circle = { center = [0.05, 0.025], radius = 0.01 } }
[material.rubber]
E = 1e6
nu = 0.4999
rho = 1100
thickness = 0.02
[effects]
solid = { model = "plane_strain" }
large_deformation = {}
gravity = {}
dynamics = { time_step = 1e-3, steps = 10 }
[supports.wall]
on = "left"
fix = ["x", "y"]
[mesh]
size = 0.02
"""


def test_a_nearly_incompressible_motion_that_is_refused_names_nu(tmp_path):
    """Nodes that move change volumes: with nu = 0.45 the same drag goes through."""
    moved = drag("hole", (0.05, 0.025), across((0.05, 0.025), (0.1, 0.025), 8))
    script = write_script(tmp_path, [{"do": "idle", "frames": 5}, *moved])
    refused, shown = (
        [row["refused"] for row in rows_of(make_replay(write_scene(tmp_path, BAND), script, overrides=given))]
        for given in ([], ["material.rubber.nu=0.45"])
    )
    assert any("or nu while the shape moves, which changes volumes" in why for why in refused) and not any(shown)
