"""Sweeps of furniture: runs that show no suggestions seek none, and those whose script takes one find it."""

import json
from pathlib import Path

import pytest
from restshape_apps.furniture.guidance.design import Design

SCENES = Path(__file__).parents[1] / "scenes"


def swept(command, folder: Path, *words: object) -> list[dict]:
    """The runs of a sweep, as --json has them."""
    done = command("sweep", *words, "--json", folder / "sweep.json")
    assert done.returncode == 0, done.stderr
    return json.loads((folder / "sweep.json").read_text())["runs"]


def test_no_run_seeks_what_would_mend_it(command, tmp_path, monkeypatch):
    scene, key = SCENES / "table.toml", "wood.thickness"
    searched = property(lambda self: pytest.fail("suggestions are sought"))
    with monkeypatch.context() as patched:
        patched.setattr(Design, "suggestion_list", searched)
        runs = swept(command, tmp_path, scene, "--set", f"{key}=18mm,20mm")
    assert [one["constraint_status"] for one in runs] == ["fails", "fails"]
    for thickness, run in zip(("18mm", "20mm"), runs):
        own = command("replay", scene, "--set", f"{key}={thickness}", "--json", "own.json")
        assert own.returncode == 0 and "suggestions in frame 0" in own.stdout
        (frame,) = json.loads((tmp_path / "own.json").read_text())["guidance"]["frames"]
        assert run["quantities"]["utilisation"]["last"] == pytest.approx(frame["utilisation"], rel=1e-9)


def test_a_run_whose_script_takes_a_suggestion_finds_it(command, tmp_path):
    header = {"format": "restshape-edits", "version": 1, "scene": "table.toml", "units": "m"}
    script = tmp_path / "choose.jsonl"
    script.write_text(f"{json.dumps(header)}\n" + '{"t": 0.0, "do": "choose", "number": 1}\n')
    words = (SCENES / "table.toml", script, "--set", "floor.friction=0.5,0.6")
    for run in swept(command, tmp_path, *words):
        assert run["refused"] == 0 and run["constraint_status"] == "holds"
