"""Ways of a hand: one that comes back over its start goes along the same way, and none is known beyond its reach."""

import json

import numpy as np
import pytest
from furniture_scenes import write_bench, write_edits
from restshape_apps.furniture.session.plank_session import PlankSession

from restshape.cli.main import main
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

PRESS = {"do": "press", "on": "left", "at": [-0.5, 0.0, 0.25]}
OVER = {"do": "drag", "path": [[-0.4, 0.0, 0.25], [-0.6, 0.0, 0.25]], "frames": 6}


def test_on_the_other_side_of_its_start_the_hand_is_on_the_same_way(tmp_path):
    scene = load_scene(write_bench(tmp_path))
    session = PlankSession(scene, load_script(write_edits(tmp_path, PRESS, OVER), scene))
    # Of the bench's leg the middle follows the hand, whatever the way is called.
    seen = []
    for frame in session.frames():
        middle = frame.design.furniture.moved(frame.gamma).planks[frame.design.piece.index("left")].centre[0]
        seen.append((frame.gesture, frame.c[0], middle))
    ways = [way for way, _, _ in seen[2:8]]
    assert all(way is ways[0] for way in ways)
    assert ways[0].name == "left: move along (1, 0, 0)"
    assert [at for _, at, _ in seen[2:8]] == pytest.approx(np.array([1, 2, 3, 1, -1, -3]) / 30.0)
    assert [x for _, _, x in seen[2:8]] == pytest.approx(-0.5 + np.array([1, 2, 3, 1, -1, -3]) / 30.0)


def test_a_hand_farther_than_was_looked_at_is_inside_of_nothing_known(tmp_path):
    # A whole turn about its own upright axis brings the leg back to where it was: there the bench holds.
    press = {"do": "press", "on": "left", "parameter": "turn y"}
    events = press, {"do": "drag", "by": "5 deg"}, {"do": "drag", "by": "360 deg"}, {"do": "drag", "by": "200 deg"}
    words = ["replay", str(write_bench(tmp_path)), "--edits", str(write_edits(tmp_path, *events))]
    assert main([*words, "--json", str(tmp_path / "run.json")]) == 0
    _, _, near, far, wrong = json.loads((tmp_path / "run.json").read_text())["guidance"]["frames"]
    assert (near["constraint_status"], far["constraint_status"]) == ("holds", "holds")
    ((low, high),) = far["ranges"]
    assert low <= near["at"] <= high < far["at"] == pytest.approx(2.0 * np.pi)
    assert near["inside"] is True and far["inside"] is None
    # What does not hold is in no range at any rate.
    assert wrong["constraint_status"] == "fails" and wrong["inside"] is False
