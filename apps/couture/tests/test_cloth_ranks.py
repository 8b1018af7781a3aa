"""Cloth that touches itself and bodies comes to the same rest on two ranks as on one."""

import json

import pytest
from restshape_verification.couture.drapes import drapes

from restshape.application import application

SCENES = application("couture").folder / "scenes"
SEWN = {name: (SCENES / f"{name}.toml").read_text() for name in ("sewn_skirt", "collar", "lined_skirt")}
PANELS = """
format = "restshape-scene"
version = 1
app = "couture"
[panels.front]
outline = ["hem", "right", "top", "left"]
vertices = { a = [0, 0], b = [0.2, 0], c = [0.2, 0.15], d = [0, 0.15] }
edges = { hem = { line = ["a", "b"] }, right = { line = ["b", "c"] }, top = { line = ["c", "d"] }, left = { line = ["d", "a"] } }
move = [0, 0, 0.5]
turn = ["90 deg", 0, 0]
[panels.back]
outline = ["hem", "right", "top"]
vertices = { a = [0, 0], b = [0.15, 0], c = [0.15, 0.15] }
edges = { hem = { line = ["a", "b"] }, right = { line = ["b", "c"] }, top = { line = ["c", "a"] } }
move = [0, 0.3, 0.5]
[supports.pins]
on = ["front.top", "back.top"]
fix = ["x", "y", "z"]
[material.cotton]
E = "0.2 MPa"
nu = 0.3
rho = "500 kg/m^3"
thickness = "0.3 mm"
[effects.gravity]
[effects.drape]
tolerance = 1e-8
[mesh]
size = 0.05
[quantities]
potential = { energy = "potential" }
"""  # noqa: E501 (a line of TOML)
pytestmark = [pytest.mark.mpi, pytest.mark.slow]


LAYERED = [
    pytest.param(name, size, marks=pytest.mark.weekly) for name, size in (("collar", 0.05), ("lined_skirt", 0.08))
]


@pytest.mark.parametrize(("name", "size"), [("skirt", 0.08), ("poncho", 0.07), ("sewn_skirt", 0.05), *LAYERED])
def test_ranks_come_to_the_same_rest(tmp_path, on_ranks, name, size):
    """Cloth of few nodes is whole on each rank, and numbered otherwise than on one."""
    path, energies = tmp_path / f"{name}.toml", []
    path.write_text(SEWN.get(name) or drapes()[name])
    for ranks in (1, 2):
        done = on_ranks(ranks, "replay", path, "--json", f"{ranks}.json", "--set", f"mesh.size={size}")
        assert done.returncode == 0, done.stdout + done.stderr
        summary = json.loads((tmp_path / f"{ranks}.json").read_text())
        energies += summary["quantities"]["potential"]
    assert energies[1] == pytest.approx(energies[0], rel=1e-4)


def test_frames_of_cloth_are_those_of_cold_solves_on_two_ranks(tmp_path, on_ranks):
    """Cloth of few nodes is whole on each rank."""
    (tmp_path / "edits.jsonl").write_text(
        '{"format": "restshape-edits", "version": 1, "scene": "strip.toml", "units": "m"}\n'
        '{"t": 0.1, "do": "set", "key": "effects.gravity.g", "value": [0, 0, -0.02]}\n'
    )
    words = ("--edits", tmp_path / "edits.jsonl", "--parity", "--set", "mesh.size=0.1")
    done = on_ranks(2, "replay", SCENES / "strip.toml", *words)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "parity with cold solves: holds for all" in done.stdout


def test_panels_come_to_the_same_rest_on_two_ranks(tmp_path, on_ranks):
    """Pieces of the mesh go to either rank."""
    energies = []
    (tmp_path / "panels.toml").write_text(PANELS)
    for ranks in (1, 2):
        done = on_ranks(ranks, "replay", tmp_path / "panels.toml", "--json", f"{ranks}.json")
        assert done.returncode == 0, done.stdout + done.stderr
        energies += json.loads((tmp_path / f"{ranks}.json").read_text())["quantities"]["potential"]
    assert energies[1] == pytest.approx(energies[0], rel=1e-6)
