"""Scenes in which an edit has changed one table: the same as if all of them had been validated again."""

from pathlib import Path

import pytest

from restshape.application import applications
from restshape.errors import UserError
from restshape.scene import overrides
from restshape.scene.load import load_scene, remade, revise
from restshape.scene.overrides import branched, put
from restshape.scene.source import split_key
from restshape.shape.gradual import sweep

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"


def leaves(table, key=()):
    """The keys of all numbers of plain tables, and of texts that are numbers with units, with their values."""
    for name, value in table.items():
        if isinstance(value, dict):
            yield from leaves(value, (*key, name))
        elif isinstance(value, float | int) and not isinstance(value, bool):
            yield (*key, name), 1.01 * value
        elif isinstance(value, str) and value[0].isdigit():
            yield (*key, name), f"1{value}"


def values_of(scene):
    return {name: getattr(scene, name) for name in type(scene).model_fields}


SCENES = [path for app in applications().values() for path in sorted((app.folder / "scenes").glob("*.toml"))[:2]]


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_number_that_an_edit_changes_gives_the_scene_that_all_of_its_tables_give(path):
    scene = load_scene(path)
    found = [*leaves(scene.raw)]
    for key, value in found[:: 1 + len(found) // 12]:
        raw = branched(scene.raw, key)
        put(raw, key, value, "a test")
        try:
            expected = remade(scene, raw)
        except UserError as error:
            with pytest.raises(UserError) as refused:
                revise(scene, ".".join(key), value)
            assert (refused.value.what, refused.value.do) == (error.what, error.do)
            continue
        revised = revise(scene, ".".join(key), value)
        for one in (revised, revise(revised, ".".join(key), value)):
            assert values_of(one) == values_of(expected) and one.raw == raw
            assert one.as_read.model_fields_set == expected.as_read.model_fields_set


def test_tables_that_stay_are_not_validated_again():
    scene = load_scene(EXAMPLES / "bracket.toml")
    (load, *_) = scene.loads
    key = next(key for key, _ in leaves(scene.raw) if key[0] == "material")
    found = revise(scene, ".".join(key), dict(leaves(scene.raw))[key])
    assert found.as_read.loads[load] is scene.as_read.loads[load]
    assert found.as_read.material is not scene.as_read.material
    assert found.material != scene.material


def test_a_value_that_does_not_suit_its_key_is_refused_as_in_a_file():
    scene = load_scene(EXAMPLES / "bracket.toml")
    key = next(".".join(key) for key, _ in leaves(scene.raw) if key[0] == "material")
    with pytest.raises(UserError) as refused:
        revise(scene, key, "2 parsecs")
    assert refused.value.where.endswith(key) and split_key(key)[0] in refused.value.where


def test_keys_of_all_scenes_are_set_without_the_tables_of_physics(monkeypatch):
    """To look for these loads all that are installed."""
    monkeypatch.setattr(overrides, "_named_of_physics", lambda: 1 / 0)
    raw = {"mesh": {}, "parameters": {"t": 1.0}, "bodies": {"ball": {}}, "shape": {"vertices": {"a": [0.0, 0.0]}}}
    for key, value in (
        (("mesh", "size"), 0.1),
        (("effects", "gravity", "g"), [0.0, 1.0]),
        (("parameters", "t"), 2.0),
        (("bodies", "ball", "radius"), 3.0),
        (("shape", "vertices", "a", "0"), 4.0),
    ):
        put(raw, key, value, "a test")
    assert (raw["mesh"]["size"], raw["parameters"]["t"], raw["bodies"]["ball"]["radius"]) == (0.1, 2.0, 3.0)
    assert raw["shape"]["vertices"]["a"] == [4.0, 0.0] and raw["effects"] == {"gravity": {"g": [0.0, 1.0]}}
    for key in (("parameters", "u"), ("shape", "vertices", "b"), ("loads", "wind", "force")):
        with pytest.raises(UserError, match="there is no"):
            put({"loads": {}} | raw, key, 1.0, "a test")
    with pytest.raises(ZeroDivisionError):
        put(raw, ("bodies", "cube", "size"), 1.0, "a test")


def test_a_support_that_lists_its_directions_takes_a_number_of_one():
    scene = load_scene(EXAMPLES / "bracket.toml")
    listed = scene.raw["supports"]["wall"]["fix"]
    pulled = revise(scene, "supports.wall.fix.x", "2 mm")
    assert listed == scene.raw["supports"]["wall"]["fix"] == ["x", "y"]
    assert pulled.supports["wall"].fix == {"x": 2e-3, "y": 0.0}
    half = sweep(scene, "supports.wall.fix.x", "2 mm")(scene, 0.5)
    assert half.supports["wall"].fix == pytest.approx({"x": 1e-3, "y": 0.0})
    with pytest.raises(UserError, match="no place in it"):
        revise(scene, "shape.outline.x", 1.0)
