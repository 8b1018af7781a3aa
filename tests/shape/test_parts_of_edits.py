"""What edits have made of a shape: loads may name it, and a loaded edge may be cut again, and made whole."""

import pytest
from small_scenes import CURVED, make_replay, rows_of, write_scene, write_script

from restshape.cli.main import main
from restshape.shape.session import EditSession

MID = {"do": "insert", "on": "right", "name": "mid", "s": 0.5}
PULL = {"do": "set", "key": "loads.more", "value": {"on": "mid", "force": [1e5, 0]}}
PLATE = CURVED.replace("nu = 0.3", "nu = 0.3\nthickness = 0.01")
LOADED = PLATE.replace('groups.pair = ["window", "top"]', 'groups.pair = ["window", "right"]').replace(
    'on = "right"\ntraction', 'on = "pair"\ntraction'
)


def frames_after(folder, text, *events):
    made = make_replay(write_scene(folder, text), write_script(folder, list(events)))
    assert isinstance(made.session, EditSession)
    return made, rows_of(made)


def test_what_edits_have_made_bears_loads(tmp_path):
    """A load on an inserted vertex is that on a vertex of the scene; a hole that was cut has one, too."""
    hole = {"do": "hole", "name": "new", "center": [1.5, 0.5], "radius": 0.1}
    blown = {"do": "set", "key": "loads.blow", "value": {"on": "new", "pressure": 1e6}}
    twice = {"do": "set", "key": "loads.more.force", "value": [2e5, 0]}
    held = {"do": "set", "key": "supports.held", "value": {"on": "mid", "fix": ["y"]}}
    made, rows = frames_after(tmp_path, PLATE, MID, PULL, twice, hole, blown, held)
    assert [row["refused"] for row in rows if row["refused"]] == []
    assert list(made.session.scene.loads) == ["right", "more", "blow"]


@pytest.mark.parametrize(
    ("event", "why"),
    [
        ({"do": "delete", "on": "mid"}, "mid is needed by loads.more"),
        ({"do": "set", "key": "loads.others", "value": {"on": "mit", "force": [1, 0]}}, "no entity 'mit'"),
        ({"do": "set", "key": "loads.others", "value": {"on": "mid", "pressure": 1}}, "cannot act on 'mid'"),
    ],
)
def test_what_a_load_names_is_there_and_can_bear_it(tmp_path, event, why):
    *_, last = frames_after(tmp_path, PLATE, MID, PULL, event)[1]
    assert why in last["refused"]


def test_after_an_undo_nothing_is_left_to_load(tmp_path):
    *_, last = frames_after(tmp_path, PLATE, MID, {"do": "undo"}, PULL)[1]
    assert "no entity 'mid'" in last["refused"]
    _, rows = frames_after(tmp_path, PLATE, MID, PULL, *2 * [{"do": "undo"}], *2 * [{"do": "redo"}])
    assert [row["refused"] for row in rows if row["refused"]] == []


def test_an_edge_of_a_loaded_group_is_cut_and_made_whole(tmp_path):
    """Its parts are in the group, whatever their names; the part that goes leaves the load to the one that stays."""
    again = {"do": "insert", "on": "right.1", "name": "quarter", "s": 0.5}
    whole = [{"do": "delete", "on": "quarter"}, {"do": "delete", "on": "mid"}]
    made, rows = frames_after(tmp_path, LOADED, MID, again, *whole)
    assert [row["refused"] for row in rows if row["refused"]] == []
    assert len(made.session.outline.entity("pair").edges) == 5


def test_a_part_that_another_edge_takes_is_missed(tmp_path):
    """With c the upper half of the loaded edge and the top become one edge."""
    *_, last = frames_after(
        tmp_path, LOADED.replace('"window", "right"', '"window", "right", "top"'), MID, {"do": "delete", "on": "c"}
    )[1]
    assert last["refused"] == "top is needed by loads.right (set loads.right.on to another place first)"


def test_a_part_that_a_load_names_itself_is_not_cut(tmp_path):
    on = {"do": "set", "key": "loads.more", "value": {"on": "right.1", "traction": [1e5, 0]}}
    *_, last = frames_after(tmp_path, PLATE, MID, on, {"do": "insert", "on": "right.1", "name": "quarter", "s": 0.5})[1]
    assert last["refused"].startswith("right.1 is needed by loads.more (set loads.more.on")


@pytest.mark.parametrize("command", ["check", "replay"])
def test_a_name_that_a_drawing_does_not_have_is_refused_with_one_that_it_has(tmp_path, capsys, command):
    (tmp_path / "plate.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="9mm" height="9mm" viewBox="0 0 9 9">'
        '<rect id="border" x="1" y="1" width="7" height="7"/></svg>'
    )
    scene = write_scene(
        tmp_path,
        'format = "restshape-scene"\nversion = 1\napp = "plane"\n[shape]\nfile = "plate.svg"\n'
        "[material.m]\nE = 1\nnu = 0.3\nthickness = 1\n[effects]\nsolid = {}\n"
        '[supports.hold]\non = "borders"\nfix = ["x", "y"]\n[mesh]\nsize = 0.002\n',
    )
    assert main([command, str(scene)]) == 2
    said = capsys.readouterr().err
    assert "supports.hold" in said and "no entity named 'borders'" in said and "did you mean 'border" in said
