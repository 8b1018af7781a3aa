"""Forces and heat after a flow begins suddenly: at time 0, and where values of the scene jump."""

import numpy as np
from flow_scenes import CHANNEL, CYLINDER
from restshape_studies.stability.scenery import make_replay, set_value, write_scene, write_script
from restshape_verification.flow.heated_scenes import BUOYANT, CAVITY
from restshape_verification.flow.heated_scenes import in_time as heated_in_time
from restshape_verification.flow.scenes import in_time
from thermal_scenes import solved

from restshape.analysis.frame import Frame

MESH = '[quantities]\ndrag = { drag = true, at = "body" }\n[mesh]\nsize = 0.15\nnear = { body = 0.08 }\n'


def idle(frames):
    return {"do": "idle", "frames": frames}


def replayed(folder, text, events):
    return [dict(row) for row in make_replay(write_scene(folder, text), write_script(folder, events)).frames()]


def test_the_step_after_an_impulse_has_none_of_it(tmp_path):
    """Half of it came back with the other sign. The step that has it says so; it grows as the step becomes shorter."""
    long, short = (replayed(tmp_path, CYLINDER + in_time(dt) + MESH, [idle(4)]) for dt in (0.02, 0.01))
    for rows in (long, short):
        first, *later = (row["q_drag"] for row in rows[1:])
        assert first > 2.5 * later[0] and min(later) > 0.1 * later[-1]
        assert ["began suddenly" in row["note"] for row in rows[1:4]] == [True, False, False]
    assert short[1]["q_drag"] > 1.3 * long[1]["q_drag"]


def test_an_inlet_that_is_set_pushes_once(tmp_path):
    """And one whose change is undone."""
    faster = set_value("boundary.inlet.velocity", ["6*y*(1 - y)", 0])
    rows = replayed(tmp_path, CYLINDER + in_time(0.02) + MESH, [idle(8), *faster, idle(2), {"do": "undo"}, idle(2)])
    assert not any(row["refused"] for row in rows)
    sudden = [k for k, row in enumerate(rows) if "began suddenly" in row["note"]]
    drag = [row["q_drag"] for row in rows]
    assert len(sudden) == 3
    _, set_at, undone_at = sudden
    before = drag[set_at - 1]
    assert drag[set_at] > 3 * before and 0.9 * before < drag[set_at + 1] < 3 * before
    assert drag[undone_at] < 0.0 < drag[undone_at + 1] < drag[undone_at - 1]


def test_a_wall_that_becomes_warmer_gives_off_what_it_conducts(tmp_path):
    """Not what its nodes seem to store: 15 times as much, and a quarter with the other sign in the next step."""
    text = CAVITY + heated_in_time(1e-4) + BUOYANT + "[mesh]\nsize = 0.1\n"
    rows = replayed(tmp_path, text, [idle(3), *set_value("boundary.hot.temperature", "301.5 K"), idle(3)])
    hot = np.array([row["q_hot"] for row in rows])
    jump = int(np.argmax(np.diff(hot))) + 1
    after = hot[jump:]
    assert len(after) >= 3 and np.all(after > 1.5 * hot[jump - 1])
    np.testing.assert_allclose(after, after[-1], rtol=0.2)


def test_a_smooth_start_is_no_sudden_one(tmp_path):
    analysis = solved(tmp_path, CHANNEL + in_time(0.05) + "[mesh]\nsize = 0.15\n").analysis
    space, scene = analysis.space, analysis.state.scene
    y = space.X[:, 1]
    analysis.begin(np.column_stack([4 * y * (1 - y), 0 * y, 0.8 * (3 - space.X[:, 0])]))
    analysis.solve(Frame(space, np.empty(0, np.int32), None, scene, (None, (0.0, 0.0))))
    assert analysis.state.past.before is not None and not analysis.state.past.sudden


def test_short_steps_on_new_meshes_say_what_these_add_to_forces(tmp_path):
    """Against the same drag on a mesh that moves along: where forces are far off, a note says so."""
    edits = [
        idle(4),
        {"do": "press", "on": "body", "at": [0.5, 0.5]},
        {"do": "drag", "path": [[0.56, 0.5]], "frames": 3},
    ]
    script, off, noted = write_script(tmp_path, edits), [], []
    for dt in (0.002, 0.1):
        scene = write_scene(tmp_path, CYLINDER + in_time(dt) + MESH)
        kept, new = ([dict(row) for row in make_replay(scene, script, name).frames()] for name in ("auto", "rebuild"))
        off.append(max(abs(b["q_drag"] / a["q_drag"] - 1.0) for a, b in list(zip(kept, new))[-3:]))
        noted.append(["free of divergence" in row["note"] for row in new[-3:]])
        assert not any("free of divergence" in row["note"] for row in kept)
    assert off[0] > 0.2 and noted[0] == [True, True, True]
    assert off[1] < 0.03 and noted[1] == [False, False, False]
