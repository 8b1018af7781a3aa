"""`restshape explain` of cloth: what prediction would do."""

from restshape_studies.explain.prediction import prediction

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
