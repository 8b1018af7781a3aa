"""What `explain` says of furniture: every effect that can be left out has a price, and shares sum to one."""

import json

import pytest
from jobs_here import jobs_run_here
from restshape_studies.explain.price import ANOTHER_WAY
from restshape_studies.explain.variants import Difference, variants
from restshape_studies.explain.without import without

from restshape.application import application
from restshape.cli.main import main
from restshape.scene.load import load_scene
from restshape.scene.plan import plan

APP = application("furniture")
OPTIONAL = ("gravity", "push", "bending", "ranges", "suggestions")


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The rows of the scene that furniture starts from, by effect."""
    folder = tmp_path_factory.mktemp("explain")
    assert main(["new", "furniture", str(folder / "bench")]) == 0
    words = ["explain", str(folder / "bench" / "scene.toml"), "--seconds", "3", "--json", str(folder / "found.json")]
    with jobs_run_here():
        assert main(words) == 0
    return {row["effect"]: row for row in json.loads((folder / "found.json").read_text())}


@pytest.mark.slow
def test_every_effect_that_can_be_left_out_is_priced(found):
    # The clock of a machine that does other things besides may leave small ones without a price.
    reported = {name: found[name]["how"] for name in OPTIONAL}
    assert reported["bending"] == "by difference"
    assert {how.partition(":")[2] for how in reported.values()} <= {"", ANOTHER_WAY.partition(":")[2]}
    assert sum(row["share"] for row in found.values()) == pytest.approx(1.0, abs=1e-9)
    # Two cases of three planks each, in Python: it is what takes most of such a frame.
    assert found["bending"]["share"] > found["push"]["share"] and found["bending"]["share"] > 0.25
    assert found["nails"]["required"] and found["guidance"]["required"]


@pytest.mark.slow
@pytest.mark.parametrize("name", OPTIONAL)
def test_a_scene_without_quantities_can_do_without_each(name):
    app = application("furniture")
    scene = load_scene(app.folder / "template" / "scene.toml")
    left = without(scene, app, [name])
    assert "quantities" not in left.raw and left.planks == scene.planks
    assert left.effects != scene.effects


def test_quantities_of_an_effect_go_with_it(tmp_path):
    app = application("furniture")
    path = tmp_path / "scene.toml"
    text = (app.folder / "template" / "scene.toml").read_text()
    path.write_text(text + "[quantities]\nsag = { deflection = true }\nmass = { mass = true }\n")
    scene = load_scene(path)
    assert set(without(scene, app, ["bending"]).quantities) == {"mass"}
    assert set(without(scene, app, ["push"]).quantities) == {"sag", "mass"}


def test_what_is_done_for_each_case_of_loads_is_no_part_of_the_price_of_a_push():
    found = variants(plan(load_scene(APP.folder / "template" / "scene.toml"), APP), APP)
    each = frozenset(["bending", "ranges", "suggestions"])
    assert found.differences["push"] == Difference(each, each | {"push"})
    # Every push stands beside the weights.
    assert found.differences["gravity"] == Difference(each | {"push"}, each | {"push", "gravity"})
    # Searches look at the bending of each piece that they try.
    searches = frozenset(["ranges", "suggestions"])
    assert found.differences["bending"] == Difference(searches, searches | {"bending"})
    assert set(found.differences) == {"gravity", "push", "bending", "ranges", "suggestions"}
