"""A pulled arc goes through the hand; what it may not become is refused, and it can be undone."""

import numpy as np
import pytest
from petsc4py import PETSc
from restshape_studies.bench.maps import scripted
from restshape_studies.explain.prediction import prediction
from shape_scenes import scene_and_script

from restshape.application import application_of
from restshape.calibration import Calibration
from restshape.errors import UserError
from restshape.policy import policy
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.shape.hand.arc_grab import is_arc
from restshape.shape.session import EditSession
from restshape.shape.topology_edits import bulge_of

SCENE = """
format = "restshape-scene"
version = 1
app = "modes"
title = "lens"
shape.outline = ["low", "bc", "cd", "da"]
shape.vertices = {a = [0, 0], b = [2, 0], c = [2, 1], d = [0, 1]}
shape.edges.low = {arc = ["a", "b"], bulge = 0.2}
shape.edges.bc = {line = ["b", "c"]}
shape.edges.cd = {line = ["c", "d"]}
shape.edges.da = {line = ["d", "a"]}
material.steel = {name = "steel", thickness = "20 mm"}
effects.modal = {model = "plate", modes = 3}
mesh.size = 0.2
"""


def frames_of(tmp_path, events):
    return list(EditSession(*scene_and_script(tmp_path, events, SCENE)).frames())


def test_a_pulled_arc_goes_through_the_hand(tmp_path):
    events = [
        {"do": "pull", "on": "low"},
        {"do": "drag", "path": [[1.0, -0.3], [1.2, -0.5], [1.0, 0.0], [0.9, 0.3]]},
        {"do": "release"},
    ]
    frames = frames_of(tmp_path, events)
    assert [frame.change for frame in frames] == ["start", "none", "move", "move", "move", "move", "none"]
    for frame, place in zip(frames[2:], [(1.0, -0.3), (1.2, -0.5), (1.0, 0.0), (0.9, 0.3)]):
        outline = frame.outline
        assert outline.bulges[0] == pytest.approx(bulge_of(outline, 0, np.array(place)), abs=1e-12)
        np.testing.assert_array_equal(outline.points, frames[0].outline.points)
    # Flat in between, then to the other side: its sagitta over half its chord is its bulge.
    assert [np.sign(frame.outline.bulges[0].round(12)) for frame in frames[2:6]] == [1, 1, 0, -1]
    assert frames[2].outline.bulges[0] == pytest.approx(0.3)


def test_the_hand_may_hold_it_anywhere_and_beside_it(tmp_path):
    """The point of the arc that is nearest to the hand goes as far as the hand does."""
    outline = frames_of(tmp_path, [{"do": "idle"}])[0].outline
    hand, way = outline.point(0, 0.3)[0] + np.array([0.0, -0.05]), np.array([0.01, -0.2])
    events = [{"do": "pull", "on": "low", "at": hand.tolist()}, {"do": "drag", "to": (hand + way).tolist()}]
    moved = frames_of(tmp_path, [*events, {"do": "release"}])[2].outline
    fine = np.linspace(0.0, 1.0, 20001)
    before = outline.point(0, fine)
    grabbed = before[np.hypot(*(before - hand).T).argmin()]
    assert np.hypot(*(moved.point(0, fine) - grabbed - way).T).min() < 2e-4


def test_what_it_may_not_become_is_refused_and_a_pull_is_undone(tmp_path):
    events = [
        {"do": "pull", "on": "low"},
        {"do": "drag", "path": [[1.0, 0.5], [1.0, 1.2], [3.0, 0.0], [1e9, 0.0], [1.0, 0.6]]},
        {"do": "release"},
        {"do": "undo"},
        {"do": "redo"},
    ]
    frames = frames_of(tmp_path, events)
    assert [frame.refused is None for frame in frames[2:7]] == [True, False, False, False, True]
    assert "would cross edge bc" in frames[3].refused and "no arc passes through" in frames[4].refused
    assert frames[3].outline.bulges[0] == pytest.approx(-0.5) == frames[5].outline.bulges[0]
    assert frames[6].outline.bulges[0] == pytest.approx(-0.6)
    assert frames[8].outline.bulges[0] == 0.2 and frames[9].outline.bulges[0] == pytest.approx(-0.6)


def test_lines_and_pinned_arcs_are_pulled_as_before(tmp_path):
    outline = frames_of(tmp_path, [{"do": "idle"}])[0].outline
    assert is_arc(outline, "low") and not any(is_arc(outline, name) for name in ("bc", "a", "outline"))
    events = [{"do": "pull", "on": "low", "pins": ["a", "b"]}, {"do": "release"}, {"do": "pull", "on": "bc"}]
    frames = frames_of(tmp_path, events)
    assert all("no control point" in frame.refused for frame in (frames[1], frames[3]))


@pytest.mark.parametrize("predict", ["none", "linear"])
def test_nodes_follow_a_pulled_arc_and_its_tones_are_those_of_the_shape(tmp_path, predict):
    events = [{"do": "pull", "on": "low"}, {"do": "drag", "to": [1.0, -0.4], "frames": 8}, {"do": "release"}]
    scene, script = scene_and_script(tmp_path, events, SCENE)
    chosen = policy(scene.solve.policy)
    request = Request(scene, script, application_of(scene), chosen, Calibration.load(), predict=predict)
    replay = Replay(request, PETSc.COMM_SELF)
    rows = list(replay.frames())
    assert [row["level"] for row in rows[2:10]] == [1] * 8 and not any(row["predicted"] for row in rows)
    assert replay.session.outline.bulges[0] == pytest.approx(0.4)
    notes = {str(row["note"]) for row in rows[2:10]}
    assert notes == {"not predicted: bending an arc is not linear" if predict == "linear" else ""}
    assert replay.analysis.compare_cold().solution < 1e-8


def test_no_prediction_is_promised_of_an_arc(tmp_path):
    pulled = [{"do": "pull", "on": "low"}, {"do": "drag", "to": [1.0, -0.4]}, {"do": "release"}]
    pressed = [{"do": "press", "on": "low"}, *pulled[1:]]
    assert prediction(*scene_and_script(tmp_path, pulled, SCENE))[1:] == ("nothing", "bending an arc is not linear")
    assert prediction(*scene_and_script(tmp_path, pressed, SCENE))[1].startswith("drags on the mesh")
    scene, script = scene_and_script(tmp_path, pulled, SCENE)
    with pytest.raises(UserError, match="no frame of it drags a part"):
        scripted(scene, script)
