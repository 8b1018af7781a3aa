"""The plan: only what the scene names is on."""

from dataclasses import replace
from pathlib import Path

import pytest

from restshape.application import application
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.physics.elasticity.elasticity_declaration import PLANE_SOLIDS
from restshape.scene.load import load_scene, revise
from restshape.scene.plan import as_written, plan


def test_only_what_is_named_is_on(scene_file):
    planned = plan(load_scene(scene_file), application("plane"))
    assert planned.on("solid") and not planned.on("gravity") and not planned.on("heat")
    assert planned.settings("solid").model == "plane_stress"
    assert planned.settings("gravity") is None
    reasons = {effect.name: effect.why for effect in planned.effects}
    assert reasons == {
        "solid": "the scene names it in [effects.solid]",
        "gravity": "the scene has no [effects.gravity]",
        "large_deformation": "the scene has no [effects.large_deformation]",
        "buckling": "the scene has no [effects.buckling]",
    }


def test_named_with_defaults(scene_file):
    planned = plan(load_scene(scene_file, ["effects.gravity={}"]), application("plane"))
    assert planned.on("gravity") and planned.settings("gravity").g == [0.0, -9.81]


def test_what_the_application_cannot_do_without_is_on(scene_file):
    scene_file.write_text(scene_file.read_text().replace('[effects.solid]\nmodel = "plane_stress"\n', ""))
    planned = plan(load_scene(scene_file), application("plane"))
    assert planned.on("solid")
    assert planned.effects[0].why == "plane always has it"


SECOND_ORDER = replace(application("plane"), physics=(replace(PLANE_SOLIDS, orders=(1, 2)),))
RUBBER = ["material.steel.nu=0.4999", 'effects.solid.model="plane_strain"']


def decided(scene_file, *overrides: str):
    scene = load_scene(scene_file, [*RUBBER, *overrides])
    return scene, plan(scene, SECOND_ORDER)


@pytest.fixture
def rubber(scene_file, monkeypatch):
    """A scene file whose application has second-order elements, too, and those of first order by default."""
    monkeypatch.setattr("restshape.scene.load.application", lambda name, where=None: SECOND_ORDER)
    return scene_file


def test_nearly_incompressible_body_in_plane_strain_gets_the_mean_dilatation(rubber):
    scene, planned = decided(rubber)
    assert scene.mesh.order == planned.order == 2
    assert planned.settings("solid").element == "mean_dilatation"
    why = planned.effects[0].why
    assert "mean dilatation on second-order triangles, for nu = 0.4999 of material.steel is above 0.49" in why


def test_first_order_asked_for_by_name_stays_and_says_that_it_locks(rubber):
    scene, planned = decided(rubber, "mesh.order=1")
    assert scene.mesh.order == planned.order == 1
    assert planned.settings("solid").element == "displacement"
    assert "first-order triangles lock" in planned.effects[0].why and "mesh.order" in planned.effects[0].why


def test_displacement_elements_can_be_asked_for(rubber):
    scene, planned = decided(rubber, 'effects.solid.element="displacement"')
    assert scene.mesh.order == 2 and planned.settings("solid").element == "displacement"
    assert "slow to converge" in planned.effects[0].why


def test_an_application_of_first_order_only_says_that_it_locks(rubber, monkeypatch):
    only_first = replace(SECOND_ORDER, physics=(replace(PLANE_SOLIDS, orders=(1,)),))
    monkeypatch.setattr("restshape.scene.load.application", lambda name, where=None: only_first)
    scene = load_scene(rubber, RUBBER)
    assert scene.mesh.order == 1
    assert "first-order triangles lock" in plan(scene, only_first).effects[0].why
    with pytest.raises(UserError, match="no elements of order 2"):
        load_scene(rubber, ["mesh.order=2"])


@pytest.mark.parametrize("overrides", [["material.steel.nu=0.49"], ['effects.solid.model="plane_stress"']])
def test_compressible_bodies_and_plane_stress_need_nothing(rubber, overrides):
    scene, planned = decided(rubber, *overrides)
    assert scene.mesh.order == planned.order == 1
    assert planned.settings("solid").element == "displacement"
    assert planned.effects[0].why == "the scene names it in [effects.solid]"


def test_mean_dilatation_asked_for_brings_its_order(rubber):
    scene, planned = decided(rubber, "material.steel.nu=0.3", 'effects.solid.element="mean_dilatation"')
    assert scene.mesh.order == planned.order == 2
    assert "for the scene asks for it" in planned.effects[0].why


@pytest.mark.parametrize(
    ("overrides", "what"),
    [
        (['effects.solid.model="plane_stress"'], "in plane stress nothing locks"),
        (["mesh.order=1"], "needs second-order triangles"),
    ],
)
def test_mean_dilatation_without_sense_is_refused(rubber, overrides, what):
    with pytest.raises(UserError, match=what) as caught:
        decided(rubber, 'effects.solid.element="mean_dilatation"', *overrides)
    assert "effects.solid.element" in caught.value.where and rubber.name in caught.value.where


def test_an_edit_that_makes_the_body_incompressible_asks_for_another_mesh(rubber):
    scene = load_scene(rubber, ['effects.solid.model="plane_strain"'])
    revised = revise(scene, "material.steel.nu", 0.4999)
    assert scene.mesh.order == 1 and revised.mesh.order == 2
    assert plan(revised, SECOND_ORDER).settings("solid").element == "mean_dilatation"
    back = revise(revised, "material.steel.nu", 0.3)
    assert back.mesh == scene.mesh
    assert revise(scene, "material.steel.E", 1e9).mesh is scene.mesh


def test_an_edit_does_not_override_an_order_that_is_named(rubber):
    scene = load_scene(rubber, ['effects.solid.model="plane_strain"', "mesh.order=1"])
    revised = revise(scene, "material.steel.nu", 0.4999)
    assert revised.mesh is scene.mesh
    assert "first-order triangles lock" in plan(revised, SECOND_ORDER).effects[0].why


def test_what_makes_an_answer_bad_is_a_warning():
    app = application("plane")
    column = Path(__file__).parents[1] / "scenes" / "column.toml"
    assert plan(load_scene(column), app).warnings == ()
    (reported,) = plan(load_scene(column, ["mesh.order=1"]), app).warnings
    assert reported.startswith("effects.buckling: first-order triangles bend too stiffly")


def test_plane_solids_have_second_order_elements_where_nothing_says_otherwise(scene_file):
    app = application("plane")
    planned = plan(as_written(load_scene(scene_file)), app)
    assert planned.order == load_scene(scene_file).mesh.order == 2
    assert planned.order_why.startswith("the default of plane: at equal time of a frame")
    named = plan(as_written(load_scene(scene_file, ["mesh.order=1"])), app)
    assert named.order == 1 and named.order_why == "the scene says so in mesh.order"
    assert first_frame(scene_file).analysis.space.cells.shape[1] == 6
    assert first_frame(scene_file, ["mesh.order=1"]).analysis.space.cells.shape[1] == 3


def test_a_plan_is_made_once_a_scene(scene_file):
    scene, plane = load_scene(scene_file), application("plane")
    first = plan(scene, plane)
    revised = revise(scene, "effects.solid.model", "plane_strain")
    assert plan(revised, plane).settings("solid").model == "plane_strain"
    assert plan(scene, plane) is first
    assert plan(scene, replace(plane, summary="another")) is not first
