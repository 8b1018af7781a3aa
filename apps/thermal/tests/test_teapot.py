"""The teapot that is heated from below: its size, on one rank and on two, and what an edit does to it."""

import json

import numpy as np
import pytest
from restshape_apps.thermal import application

SCENE = application.folder / "scenes" / "thermal.toml"
HEAD = {"format": "restshape-edits", "version": 1, "units": "mm"}
DRAG = [
    {"do": "idle", "frames": 12},
    {"do": "press", "on": "mouth", "at": [47, 35]},
    {"do": "drag", "path": [[50, 37]], "frames": 6},
    {"do": "release"},
]


def test_the_teapot_has_as_many_triangles_as_the_thesis(command, tmp_path):
    done = command("replay", SCENE, "--json", "out.json")
    assert done.returncode == 0, done.stderr
    assert json.loads((tmp_path / "out.json").read_text())["elements"] == pytest.approx(1938, rel=0.02)


@pytest.mark.slow
def test_heat_that_enters_converges_as_cells_become_smaller(command, tmp_path):
    (tmp_path / "still.jsonl").write_text("".join(json.dumps(line) + "\n" for line in (HEAD, {"t": 0, **DRAG[0]})))
    found = []
    for size in (1.82, 1.3, 0.91):
        settings = [f"mesh.size={size}mm", f"mesh.near.bottom={size / 1.82}mm"]
        asked = [word for setting in settings for word in ("--set", setting)]
        done = command("replay", SCENE, "--edits", "still.jsonl", *asked, "--json", "out.json")
        assert done.returncode == 0, done.stderr
        found.append(json.loads((tmp_path / "out.json").read_text())["quantities"]["nusselt"][-1])
    first, second = np.diff(found)
    # With temperatures that jump at the corners both are alike: each halving adds as much.
    assert abs(second) < 0.65 * abs(first)


@pytest.mark.slow
def test_two_ranks_heat_the_teapot_as_one_does(on_ranks, tmp_path):
    lines = [HEAD, *({"t": 0.5 * i, **event} for i, event in enumerate(DRAG))]
    (tmp_path / "short.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    found = []
    for ranks in (1, 2):
        done = on_ranks(
            ranks, "replay", SCENE, "--edits", tmp_path / "short.jsonl", "--parity", "--json", f"{ranks}.json"
        )
        assert done.returncode == 0, done.stderr
        found.append(json.loads((tmp_path / f"{ranks}.json").read_text()))
    for name in ("mean", "heating", "fastest"):
        one, two = (np.array(summary["quantities"][name]) for summary in found)
        assert np.abs(one - two).max() < 1e-4 * np.abs(one).max()
    mean = np.array(found[0]["quantities"]["mean"])
    assert found[0]["levels"]["1"] > 0 and (np.diff(mean[:13]) > 0).all()
