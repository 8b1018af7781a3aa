"""What explain says of prediction in scenes of cloth."""

import pytest
from drape_designs import BALL, CONTACT, HELD, sheet
from restshape_studies.explain.prediction import prediction
from small_scenes import write_scene, write_script

from restshape.application import application
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene, revise


def test_what_prediction_does_is_said():
    """Of nested meshes which one is predicted; where nothing is predicted, why."""
    folder = application("couture").folder
    scene = load_scene(folder / "scenes" / "longer.toml", ["predict.levels=2"])
    script = load_script(folder / "edits" / "longer.jsonl", scene)
    _, what, why = prediction(scene, script)
    assert what.startswith("drags on mesh 1 of 2, shown on mesh 2, from 10 samples at most, 16.7 ms of solver steps")
    assert why.endswith("solve.estimate = auto")
    _, what, _ = prediction(revise(scene, "predict.levels", 1), script)
    assert what.startswith("drags on the mesh, ")
    assert prediction(scene, None)[1:] == ("nothing", "there is no script, and so no drag")
    _, what, why = prediction(revise(scene, "mesh.relocation", "laplacian"), script)
    assert what == "nothing" and "springs relax the nodes" in why


@pytest.mark.parametrize(
    ("on", "what"),
    [("ball", "nothing"), ("supports.pins", "nothing"), ("pins", "nothing"), ("right", "drags"), (None, "nothing")],
)
def test_nothing_is_predicted_where_no_hand_holds_the_shape(tmp_path, on, what):
    """Of drags of a ball or of a pin, and of a script of a number that is set."""
    scene = load_scene(write_scene(tmp_path, sheet("hinge", HELD, BALL.format(friction=0.3), CONTACT, size=0.1)))
    hand = [{"do": "press", "on": on}, {"do": "drag", "to": [0.21, 0.1], "frames": 2}, {"do": "release"}]
    events = hand if on else [{"do": "set", "key": "material.cotton.rho", "value": 400}]
    _, said, why = prediction(scene, load_script(write_script(tmp_path, events), scene))
    assert said.startswith(what) and (why == "no hand holds the shape") == (what == "nothing")
