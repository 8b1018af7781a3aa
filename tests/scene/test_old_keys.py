"""Keys of version 0.1 are read by alias, with a note."""

import pytest
from old_recordings import SCENE as PLANE

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.scene.load import load_scene, revise

QUANTITIES = """\
peak = { stress = "von_mises", take = "mean", limit = "3 kPa" }
far = { displacement = "x", at = "right", at_least = "1 um", exact = "2 um" }
"""
SCENE = PLANE + QUANTITIES


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return path


def test_old_keys_are_read(path):
    quantities = load_scene(path).quantities
    assert (quantities["peak"].reduce, quantities["peak"].max) == ("mean", 3000.0)
    assert (quantities["far"].min, quantities["far"].reference) == (pytest.approx(1e-6), pytest.approx(2e-6))


def test_both_names_of_a_key_are_refused_at_its_place(path):
    path.write_text(SCENE.replace('limit = "3 kPa"', 'limit = "3 kPa", max = "4 kPa"'))
    with pytest.raises(UserError, match=r"quantities.peak.*two names of one key"):
        load_scene(path)


def test_an_error_in_an_old_key_names_its_line(path):
    path.write_text(SCENE.replace('"3 kPa"', '"3 mm"'))
    with pytest.raises(UserError, match=r"quantities.peak.max \(line 25\)"):
        load_scene(path)


def test_an_edit_of_the_new_key_replaces_the_old_one(path):
    scene = revise(load_scene(path), "quantities.peak.max", "5 kPa")
    assert scene.quantities["peak"].max == 5000.0 and "limit" not in scene.raw["quantities"]["peak"]
    assert revise(scene, "quantities.peak.limit", "6 kPa").quantities["peak"].max == 6000.0


def test_commands_note_the_names_of_today(path, capsys):
    assert main(["check", str(path)]) == 0
    assert "quantities.peak.limit is called max now" in capsys.readouterr().out
    assert main(["replay", str(path)]) == 0
    assert "note: quantities.far.exact is called reference now" in capsys.readouterr().out
