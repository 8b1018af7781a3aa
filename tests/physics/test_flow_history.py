"""What the mesh does to the history of a flow: fields that nodes keep or take again."""

import numpy as np
import pytest
from flow_scenes import CYLINDER
from restshape_studies.stability.scenery import across, drag, make_replay, set_value, write_scene, write_script
from restshape_verification.flow.heated_scenes import in_time as heated_in_time
from restshape_verification.flow.heated_scenes import warm_everywhere
from restshape_verification.flow.scenes import channel, everywhere, in_time

from restshape.errors import ReplayProblem
from restshape.physics.flow.carry import VelocityCorrection, courant, divergence
from restshape.physics.flow.flow_search import FlowSearch
from restshape.physics.flow.history import Level

DRAG = drag("window", (0.4, 0.5), across((0.4, 0.5), (0.75, 0.75), 30))
"""Nodes move, edges flip, and a mesh is new."""
FAR = drag("window", (0.4, 0.5), across((0.4, 0.5), (0.8, 0.75), 3))
STEADY_SHEAR = '["y", 0]'
MESH = '[quantities]\ndrag = { drag = true, at = "body" }\nlift = { lift = true, at = "body" }\n'
MESH += "[mesh]\nsize = 0.12\nnear = { body = 0.05 }\n"
SIZE = "[mesh]\nsize = 0.12\n"


def rows(folder, scene, events, look=lambda made, row: None, policy="auto"):
    """The rows of a replay of a scene, a file or text; `look` sees the replay after each."""
    path = write_scene(folder, scene) if isinstance(scene, str) else scene
    made, found = make_replay(path, write_script(folder, events), policy), []
    for row in made.frames():
        look(made, row)
        found.append(dict(row))
    return found


def shear(X):
    return np.column_stack([X[:, 1], 0 * X[:, 1], 0 * X[:, 1]])


def test_the_courant_number_of_a_mesh_in_closed_form():
    """A right triangle with legs of 2 m has a side of 2 m; the fastest corner counts, and no area is infinitely bad."""
    X, cells = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]]), np.array([[0, 1, 2]], np.int32)
    level = Level(np.zeros((3, 2)), X, cells)
    assert courant(level, X.copy()) == 0.0
    assert courant(level, X + np.array([[0.3, 0.0], [0.0, -3.0], [1.8, 2.4]])) == pytest.approx(1.5)
    assert courant(Level(level.values, X, cells[:, ::-1].copy()), X + 1.0) == np.inf


def test_interpolation_leaves_the_divergence_that_there_was(tmp_path):
    """What is added to a velocity on the way changes it no more, up to what stabilisation leaves."""
    made = make_replay(write_scene(tmp_path, CYLINDER + in_time(0.1) + MESH))
    for _ in made.frames():
        analysis = made.analysis
    problem, equations, newton = analysis.problem, analysis.state.equations, analysis.state.system.newton
    X, before = analysis.space.X.copy(), Level.of(problem, analysis.x)
    bump = np.sin(np.pi * X[:, :1]) * np.sin(np.pi * X[:, 1:]) * np.array([[0.05, -0.02]])
    bump[problem.boundary.mask[:, 0] > 0] = 0.0
    polluted = Level(before.values + bump, X, before.cells)
    newton.begin(True, False, None)
    was, area = divergence(before)
    outcome, after = VelocityCorrection(problem, equations, newton, 0.1, 1e-10)(polluted, was / area, 0.0)
    (is_now, _), (bad, _) = (divergence(level) for level in (after, polluted))
    assert outcome.converged and np.linalg.norm(is_now - was) < 0.1 * np.linalg.norm(bad - was)
    held = problem.boundary.mask[:, :2] > 0
    np.testing.assert_array_equal(after.values[held], polluted.values[held])
    assert problem.advecting is None and np.array_equal(analysis.space.X, X)


def off_the_shear(folder, effects, script, fails=frozenset(), monkeypatch=None):
    """The largest error of a steady shear in a replay that begins with it, and its levels of reuse.

    Searches for the flow in frames of the indices `fails` find none.
    """
    levels, worst, near, now = set(), [], FlowSearch.near, [0]

    def failing(search, *starts):
        if now[0] + 1 in fails:
            raise ReplayProblem("no flow is found, for a test")
        return near(search, *starts)

    def look(made, row):
        analysis = made.analysis
        exact = shear(analysis.space.X)
        if row["index"] == 0:
            analysis.begin(exact)
        worst.append(float(np.abs(analysis.x - exact)[:, :2].max()))
        levels.add(row["level"] if row["index"] else 0)
        assert (row["index"] in fails) is bool(row["refused"]), row
        now[0] = row["index"]

    if fails:
        monkeypatch.setattr(FlowSearch, "near", failing)
    rows(folder, everywhere(STEADY_SHEAR, effects), script, look)
    return max(worst), levels


@pytest.mark.parametrize(("script", "seen"), [(DRAG, {1, 2, 3}), (FAR, {3})])
@pytest.mark.parametrize("carry", ["ale", "remap", "auto"])
@pytest.mark.parametrize("scheme", ["bdf2", "backward_euler"])
def test_a_steady_shear_stays_one_whatever_carry_says(tmp_path, carry, scheme, script, seen):
    worst, levels = off_the_shear(tmp_path, in_time(scheme=scheme, carry=carry), script)
    assert worst < 1e-8 and levels >= seen


@pytest.mark.parametrize("carry", ["ale", "remap"])
@pytest.mark.parametrize("script", [DRAG, FAR])
def test_a_stream_that_grows_steadily_stays_uniform_whatever_carry_says(tmp_path, carry, script):
    """u = (t, 0), which a linear pressure drives: past values are prescribed at the times that they are of."""
    worst = []

    def look(made, row):
        analysis = made.analysis
        if row["index"] == 0:
            analysis.begin(0.0 * analysis.x)
        worst.append(float(np.abs(analysis.x[:, :2] - [analysis.time, 0.0]).max()))

    rows(tmp_path, everywhere('["t", 0]', in_time(carry=carry)), script, look)
    assert max(worst) < 1e-7


@pytest.mark.parametrize("scheme", ["bdf2", "backward_euler"])
@pytest.mark.parametrize("carry", ["ale", "remap"])
@pytest.mark.parametrize("script", [DRAG, FAR])
def test_a_steady_linear_temperature_stays_one_whatever_carry_says(tmp_path, carry, scheme, script):
    effects = heated_in_time(scheme=scheme).replace("steps = 1", f'carry = "{carry}"')
    worst = []

    def look(made, row):
        analysis = made.analysis
        exact = np.column_stack([shear(analysis.space.X), 300 + 2 * analysis.space.X[:, 1]])
        if row["index"] == 0:
            analysis.begin(exact)
        worst.append(float(np.abs(analysis.x - exact)[:, [0, 1, 3]].max()))

    rows(tmp_path, warm_everywhere(STEADY_SHEAR, '"300 + 2*y"', effects), script, look)
    assert max(worst) < 1e-7


@pytest.mark.parametrize("carry", ["ale", "remap"])
@pytest.mark.parametrize("fails", [{5}, {20, 21}, {24}, {27}, {26, 27, 28}])
def test_a_flow_goes_on_after_a_step_without_solution(tmp_path, monkeypatch, carry, fails):
    """Also where edges flip in such a frame, and where the mesh is new."""
    worst, _ = off_the_shear(tmp_path, in_time(carry=carry), DRAG, fails, monkeypatch)
    assert worst < 1e-8


def test_a_step_without_solution_takes_no_time(tmp_path, monkeypatch):
    """A drag whose second frame fails, once for good, once to be repeated: both end with the same flow."""
    found, near, calls = [], FlowSearch.near, []

    def failing(search, *starts):
        calls.append(1)
        if len(calls) == 6:
            raise ReplayProblem("no flow is found, for a test")
        return near(search, *starts)

    there = [(1.02, 0.5), (1.04, 0.5), (1.04, 0.5), (1.06, 0.5)]
    for path, change in ((there[:2] + there[3:], False), (there, True)):
        if change:
            monkeypatch.setattr(FlowSearch, "near", failing)
        events = [{"do": "idle", "frames": 3}, *drag("body", (1.0, 0.5), path)]
        seen = rows(tmp_path, CYLINDER + in_time(0.05) + MESH, events)
        assert [row["index"] for row in seen if row["refused"]] == ([6] if change else [])
        found.append((seen[-1]["time"], seen[-1]["q_drag"]))
    assert found[0] == pytest.approx(found[1], rel=1e-5)


@pytest.mark.parametrize("carry", ["ale", "remap"])
def test_velocities_stay_with_their_nodes_where_edges_flip(tmp_path, carry):
    seen = []

    def look(made, row):
        past = made.analysis.state.past
        if row["level"] == 2 and carry == "ale":
            np.testing.assert_array_equal(past.before.values, seen[-1].values)
            np.testing.assert_array_equal(past.before.X, seen[-1].X)
        if row["level"] == 2 and carry == "remap":
            np.testing.assert_array_equal(past.before.X, made.analysis.space.X)
        assert row["level"] == 3 or not seen or len(seen[-1].X) == len(past.last.X)
        seen.append(past.last)

    found = rows(tmp_path, everywhere(STEADY_SHEAR, in_time(carry=carry)), DRAG, look)
    assert any(row["level"] == 2 for row in found)


@pytest.mark.slow
@pytest.mark.parametrize("carry", ["ale", "remap"])
@pytest.mark.parametrize(("end", "frames"), [((1.1, 0.52), 3), ((1.3, 0.56), 6), ((1.3, 0.56), 1), ((2.2, 0.52), 1)])
def test_a_body_that_is_dragged_and_brought_back_has_the_forces_that_it_had(tmp_path, carry, end, frames):
    """The flow forgets the drag: three seconds later its forces are those of a body that was never touched.

    They are within a part in ten thousand of the drag on the same mesh, two in a thousand where edges have flipped,
    and a hundredth where the mesh is new.
    """
    there, back = across((1.0, 0.5), end, frames), across(end, (1.0, 0.5), frames)
    text, idle = CYLINDER + in_time(0.1, carry=carry) + MESH, {"do": "idle", "frames": 30}
    dragged = rows(tmp_path, text, [idle, *drag("body", (1.0, 0.5), [*there, *back]), idle])
    kept = rows(tmp_path, text, [idle | {"frames": len(dragged) - 1}])
    assert max(abs(row["q_drag"] - kept[30]["q_drag"]) for row in dragged[31:]) > 0.05
    bound = {2: 2e-3, 3: 1e-2}.get(max(row["level"] for row in dragged[1:]), 1e-4) * kept[-1]["q_drag"]
    for force in ("q_drag", "q_lift"):
        assert abs(dragged[-1][force] - kept[-1][force]) < bound


def test_holes_come_and_go_in_a_stream(tmp_path):
    """Where a body has vanished there was no fluid: it has what the fluid around has, and the flow goes on."""
    idle = {"do": "idle", "frames": 4}
    hole = {"do": "hole", "name": "other", "center": [2.0, 0.5], "radius": 0.1}
    events = [idle | {"frames": 8}, hole, idle, {"do": "delete", "on": "body"}, idle]
    speeds = []

    def look(made, row):
        inside = np.linalg.norm(made.analysis.space.X - [1.0, 0.5], axis=1) < 0.15
        speeds.append(float(np.linalg.norm(made.analysis.x[inside, :2], axis=1).max(initial=0.0)))

    found = rows(
        tmp_path, CYLINDER + in_time(0.1) + "[quantities]\nkinetic = { kinetic = true }\n" + SIZE, events, look
    )
    assert [row["index"] for row in found if row["level"] == 3] == [0, 9, 14]
    energies = np.array([row["q_kinetic"] for row in found[8:]])
    assert np.abs(np.diff(energies)).max() < 0.05 * energies.max() and not any(row["refused"] for row in found)
    assert speeds[13] == 0.0 and 0.2 < speeds[14] < 1.5


def test_formulas_need_no_number_where_nodes_were(tmp_path):
    """A channel becomes so low that its mesh is new: where the inlet was, its velocity has no number now."""
    text = channel(3, 1, "rho = 1\nmu = 0.1\n", "sqrt(y*(H - y))", "[parameters]\nH = 1\n")
    text = text.replace("c = [3, 1]", 'c = [3, "H"]').replace("d = [0, 1]", 'd = [0, "H"]')
    events = [{"do": "idle", "frames": 3}, *set_value("parameters.H", 0.2), {"do": "idle", "frames": 2}]
    found = rows(tmp_path, text + in_time(0.1) + "[quantities]\nfast = { speed = true }\n" + SIZE, events)
    assert found[4]["level"] == 3 and not any(row["refused"] for row in found)
    assert 0.1 < found[-1]["q_fast"] < 0.3
