"""Cloth on two ranks: the same rest where it is the only one, and the same bytes from run to run."""

import csv
import json

import numpy as np
import pytest
from cloths import BALL, CONTACT, write_cloth

pytestmark = pytest.mark.mpi
CLAMP = '[supports.clamp]\non = "left"\nfix = ["x", "y", "z", "slope"]\n'
TIP = '[quantities]\ntip = { displacement = "z", at = "c" }\nback = { displacement = "x", at = "c" }\n'
TIP += 'potential = { energy = "potential" }\nhold = { reaction = "z", at = "left" }\n'


def found(tmp_path, on_ranks, scene, ranks, *words):
    name = f"{ranks}-{len(words)}"
    done = on_ranks(ranks, "replay", scene, "--json", f"{name}.json", "--csv", f"{name}.csv", *words)
    assert done.returncode == 0, done.stdout + done.stderr
    with (tmp_path / f"{name}.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert all(
        row["converged"] == row["tangent_positive_definite"] == "1" and float(row["residual"]) <= 1e-4 for row in rows
    )
    return json.loads((tmp_path / f"{name}.json").read_text())


@pytest.mark.parametrize("bending", ["morley", "hinge"])
def test_a_cantilever(tmp_path, on_ranks, bending):
    scene = write_cloth(tmp_path, CLAMP, TIP)
    edits = tmp_path / "edits.jsonl"
    edits.write_text(
        '{"format": "restshape-edits", "version": 1, "scene": "cloth.toml", "units": "m"}\n'
        '{"t": 0, "do": "press", "on": "c"}\n{"t": 0.1, "do": "drag", "to": [1.02, 1.01], "frames": 2}\n'
    )
    words = ("--edits", edits, "--parity", "--set", "effects.drape.tolerance=1e-7", "--set", "mesh.size=0.2")
    words += ("--set", f"effects.cloth.bending={bending}", "--set", "material.cotton.bending=0.05")
    one, two = (found(tmp_path, on_ranks, scene, ranks, *words) for ranks in (1, 2))
    assert one["refused"] == two["refused"] == 0 and one["parity"]["holds"] and two["parity"]["holds"]
    for name in ("tip", "back", "potential", "hold"):
        np.testing.assert_allclose(two["quantities"][name], one["quantities"][name], rtol=1e-5, atol=1e-7)


def test_on_a_ball_residual_and_energy(tmp_path, on_ranks):
    """Folds are not unique, and both come to the same ones: steps of a fall are exact."""
    scene = write_cloth(tmp_path, BALL, CONTACT, TIP.replace('hold = { reaction = "z", at = "left" }\n', ""))
    words = ("--set", "mesh.size=0.12", "--set", "effects.cloth.bending=hinge")
    one, two = (found(tmp_path, on_ranks, scene, ranks, *words) for ranks in (1, 2))
    a, b = (summary["quantities"]["potential"][0] for summary in (one, two))
    assert b == pytest.approx(a, rel=1e-4)
    again = found(tmp_path, on_ranks, scene, 2, *words)
    assert again["quantities"] == two["quantities"]
