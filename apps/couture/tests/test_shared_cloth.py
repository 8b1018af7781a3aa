"""Cloth whose equations two ranks share, however small: its rests, saddles and reuse."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from restshape.application import application

SCENES = application("couture").folder / "scenes"
PROGRAM = Path(__file__).with_name("shared_cloth_program.py")
pytestmark = [pytest.mark.mpi, pytest.mark.weekly]


def shared(folder: Path, outside: dict[str, str], ranks: int, scene: str, *words: object) -> dict:
    """The summary of a scene on ranks that share its cloth."""
    command = ["mpiexec", "-n", str(ranks), sys.executable, str(PROGRAM), "replay", str(SCENES / scene)]
    words = (*words, "--json", f"{ranks}.json")
    done = subprocess.run(
        [*command, *map(str, words)], cwd=folder, env=outside, capture_output=True, text=True, timeout=280
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads((folder / f"{ranks}.json").read_text())


def test_a_saddle_is_left_on_two_ranks(tmp_path, outside):
    """A blade beyond its critical weight stands on edge, which is exact and unstable, and turns over to a side."""
    words = ("--set", "effects.gravity.g=[0, -0.2, 0]", "--set", "mesh.size=30 mm")
    found = [shared(tmp_path, outside, ranks, "blade.toml", *words)["quantities"] for ranks in (1, 2)]
    assert found[1]["sunk"] == pytest.approx(found[0]["sunk"], rel=1e-4)
    # Either side is as good.
    assert abs(found[1]["aside"][0]) == pytest.approx(abs(found[0]["aside"][0]), rel=1e-4)
    assert abs(found[0]["aside"][0]) > 0.4


def test_shared_cloth_on_a_ball_rests_as_on_one_rank(tmp_path, outside):
    words = ("--set", "mesh.size=50 mm")
    energies = [
        shared(tmp_path, outside, ranks, "sphere.toml", *words)["quantities"]["potential"][0] for ranks in (1, 2)
    ]
    assert energies[1] == pytest.approx(energies[0], rel=1e-4)
