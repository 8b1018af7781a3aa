"""Cloth on two ranks: the same rest where it is the only one, and the same bytes from run to run."""

import csv
import json

import numpy as np
import pytest
from body_meshes import ball, write
from cloths import BALL, CONTACT, write_cloth

from restshape import _kernels

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


@pytest.mark.skipif(not _kernels.has_cgal, reason="bodies of triangles need CGAL")
@pytest.mark.parametrize("size", [0.25, pytest.param(0.12, marks=pytest.mark.weekly)])
def test_on_a_body_of_triangles(tmp_path, on_ranks, size):
    """Contact and energies of one rank; weekly the rest comes back from perturbed positions, too."""
    write(tmp_path / "ball.obj", ball(6, 0.25))
    mesh = 'file = "ball.obj", unit = "m", move = [0.5, 0.5, -0.3], spacing = 0.05, band = 0.06'
    own = '[quantities]\nlowest = { displacement = "z", reduce = "min" }\npotential = { energy = "potential" }\n'
    scene = write_cloth(tmp_path, f"[bodies.ball]\nmesh = {{ {mesh} }}\nfriction = 0.3\n", CONTACT, own)
    words = (
        "--set",
        f"mesh.size={size}",
        "--set",
        "effects.cloth.bending=hinge",
        *(["--parity"] if size < 0.2 else []),
    )
    one, two = (found(tmp_path, on_ranks, scene, ranks, *words) for ranks in (1, 2))
    assert size > 0.2 or (one["parity"]["holds"] and two["parity"]["holds"])
    # Energies at rest are stationary; the lowest tip of a fold is not.
    for name, within in (("potential", 1e-3), ("lowest", 5e-3)):
        np.testing.assert_allclose(two["quantities"][name], one["quantities"][name], rtol=within)
