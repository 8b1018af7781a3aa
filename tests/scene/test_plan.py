"""The plan: only what the scene names is on."""

from restshape.application import application
from restshape.scene.load import load_scene
from restshape.scene.plan import plan


def test_only_what_is_named_is_on(scene_file):
    planned = plan(load_scene(scene_file), application("solid"))
    assert planned.on("solid") and not planned.on("gravity") and not planned.on("heat")
    assert planned.settings("solid").model == "plane_stress"
    assert planned.settings("gravity") is None
    reasons = {effect.name: effect.why for effect in planned.effects}
    assert reasons == {
        "solid": "the scene names it in [effects.solid]",
        "gravity": "the scene has no [effects.gravity]",
    }


def test_named_with_defaults(scene_file):
    planned = plan(load_scene(scene_file, ["effects.gravity={}"]), application("solid"))
    assert planned.on("gravity") and planned.settings("gravity").g == [0.0, -9.81]


def test_what_the_application_cannot_do_without_is_on(scene_file):
    scene_file.write_text(scene_file.read_text().replace('[effects.solid]\nmodel = "plane_stress"\n', ""))
    planned = plan(load_scene(scene_file), application("solid"))
    assert planned.on("solid")
    assert planned.effects[0].why == "solid always has it"
