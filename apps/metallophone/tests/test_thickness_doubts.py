"""A script may ask for an undercut as deep as the bar: that frame is refused, and the command does not fail."""

import re
from pathlib import Path

from restshape.cli.doubts import script_doubts
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene
from restshape.shape.build import outline_of

SCENE = Path(__file__).parents[1] / "template/undercut/scene.toml"


def test_a_script_that_leaves_no_thickness_is_no_error_of_ours(tmp_path):
    thickness = 'thickness = "20 mm - depth*exp(-((x - 0.1)/0.06)^2)"'
    text = re.sub(r"(?m)^thickness = .*$", thickness, SCENE.read_text())
    path = tmp_path / "bar.toml"
    path.write_text(text.replace("[parameters]", '[parameters]\ndepth = "8 mm"'))
    scene = load_scene(path)
    edits = tmp_path / "edits.jsonl"
    event = '{"t": 0, "do": "set", "key": "parameters.depth", "value": "25 mm"}'
    edits.write_text(f'{{"format": "restshape-edits", "version": 1}}\n{event}\n')
    assert script_doubts(scene, outline_of(scene), load_script(edits, scene)) == []
