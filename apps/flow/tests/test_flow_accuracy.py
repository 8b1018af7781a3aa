"""What a study of accuracy of flow varies: time steps, schemes and what nodes take along, of flow in time alone."""

from pathlib import Path

import pytest
from restshape_apps import flow, thermal
from restshape_studies.accuracy.setting import Choice, scale_of, settings

from restshape.application import application_of
from restshape.scene.load import load_scene

TIMED = {"effects.flow.time_step", "effects.flow.scheme", "effects.flow.carry"}
SCENES, HEATED = (Path(app.__file__).parent / "scenes" for app in (flow, thermal))


@pytest.mark.parametrize(
    ("path", "wanted"),
    [
        (SCENES / "flow.toml", TIMED),
        (SCENES / "steady_flow.toml", set()),
        (HEATED / "thermal.toml", TIMED | {"effects.heat.coupling"}),
    ],
)
def test_what_is_varied(path, wanted):
    scene = load_scene(path)
    tried, _ = settings(path, (), application_of(scene), Choice())
    assert {setting.varied for setting in tried} - {"", "solve.tolerance"} == wanted
    assert ("effects.flow.time_step" in wanted) == any("effects.flow.steps=2" in one.overrides for one in tried)


@pytest.mark.parametrize(("path", "count"), [(SCENES / "flow.toml", 3.0), (HEATED / "thermal.toml", 4.0)])
def test_unknowns_of_a_node_count(path, count):
    scene = load_scene(path)
    assert scale_of(scene, application_of(scene)).per_node == count
