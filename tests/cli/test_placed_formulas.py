"""Formulas of x and y without a number on their part of the shape: refused by `check` as by the first frame."""

import json

import pytest
from small_scenes import plate, write_scene, write_script

from restshape.cli.main import main
from restshape.cli.placed_formulas import refuse_without_number
from restshape.errors import UserError
from restshape.scene.load import load_scene
from restshape.shape.build import outline_of

ROOT = 'loads.snow={on="top",traction=[0,"sqrt(1-x)"]}'
INSERT = 'shape.regions.insert={polygon=[["1.2","0.2"],["1.6","0.2"],["1.6","0.4"]]}'


@pytest.mark.parametrize(
    ("overrides", "key", "place"),
    [
        ((ROOT,), "loads.snow.traction.1", "y = 1 m"),
        (('supports.wall.fix={x="sqrt(y-0.3)",y=0}',), "supports.wall.fix.x", "x = 0 m"),
        (('loads.heavy={on="all",body=[0,"1/(x-x)"]}',), "loads.heavy.body.1", "not a finite number"),
        ((INSERT, 'loads.heavy={on="insert",body=[0,"sqrt(x-1.3)"]}'), "loads.heavy.body.1", "x = 1.2"),
    ],
)
def test_check_refuses_what_the_first_frame_does(tmp_path, capsys, overrides, key, place):
    scene = write_scene(tmp_path, plate(0.2))
    words = [word for one in overrides for word in ("--set", one)]
    for command in ("check", "replay"):
        assert main([command, str(scene), *words]) == 2
        err = capsys.readouterr().err
        assert "the expression is not a finite number" in err
        if command == "check":
            assert key in err and place in err and "try: change " in err


@pytest.mark.parametrize("traction", ["1/sqrt(x)", "1/(2-x)", "sqrt(2-x)"])
def test_a_load_on_second_order_elements_needs_no_number_at_the_ends_of_an_edge(tmp_path, traction):
    given = f'loads.snow={{on="top",traction=[0,"{traction}"]}}'
    scene = write_scene(tmp_path, plate(0.2))
    for order, code in ((2, 0), (1, 0 if traction == "sqrt(2-x)" else 2)):
        words = [str(scene), "--set", given, "--set", f"mesh.order={order}"]
        assert main(["check", *words]) == main(["replay", *words]) == code


def test_parts_elsewhere_count_for_nothing(tmp_path):
    file = write_scene(tmp_path, plate(0.2))

    def refused(on):
        scene = load_scene(file, [INSERT, f'loads.heavy={{on="{on}",body=[0,"sqrt(x-1.19)*sqrt(0.41-y)"]}}'])
        try:
            refuse_without_number(scene, outline_of(scene))
        except UserError as error:
            return str(error)
        return ""

    assert refused("insert") == ""
    assert "not a finite number" in refused("all")


def test_edits_after_which_there_is_no_number_are_refused(tmp_path, capsys):
    """One that gives such a formula, and one that moves an edge to where a formula has none."""
    scene = write_scene(tmp_path, plate(0.2))
    events = [
        {"do": "set", "key": "loads.snow.traction", "value": [0, "sqrt(1-x)"]},
        {"do": "press", "on": "right", "at": [2, 0.5]},
        {"do": "drag", "path": [[2.05, 0.5], [2.3, 0.5], [2.06, 0.5]]},
        {"do": "release"},
    ]
    script, out = write_script(tmp_path, events), tmp_path / "out.json"
    words = [str(scene), str(script), "--set", 'loads.snow={on="top",traction=[0,"sqrt(2.1-x)"]}']
    assert main(["check", *words, "--json", str(out)]) == 1
    refused = [(one["frame"], one["do"]) for one in json.loads(out.read_text())["edits"]["refused"]]
    assert refused == [(1, "set"), (4, "drag")]
    assert main(["replay", *words, "--json", str(out)]) == 0
    values = json.loads(out.read_text())["quantities"]["energy"]
    assert [i for i, value in enumerate(values) if value is None] == [1, 4]
