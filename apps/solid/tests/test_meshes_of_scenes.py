"""Scenes that ship name meshes that ship."""

import json
from pathlib import Path

from restshape.cli.main import main

SOLID = Path(__file__).parents[1]


def test_shipped_scenes_name_shipped_meshes_and_others_do_not(tmp_path, capsys):
    source = SOLID / "scenes" / "bracket.toml"
    assert main(["check", str(source)]) == 0
    deck = (SOLID.parents[1] / "meshes" / "bracket.inp").resolve()
    scene = tmp_path / "bracket.toml"
    scene.write_text(source.read_text().replace("../../../meshes/bracket.inp", str(deck)))
    assert main(["check", str(scene)]) == 2
    assert "--allow-path" in capsys.readouterr().err


def test_the_demo_drags_its_hole_through_at_least_160_frames(tmp_path):
    out, scene, edits = tmp_path / "check.json", SOLID / "scenes" / "plate.toml", SOLID / "edits" / "plate.jsonl"
    assert main(["check", str(scene), str(edits), "--json", str(out)]) == 0
    assert json.loads(out.read_text())["edits"]["changes"]["move"] >= 160
