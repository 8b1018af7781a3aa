"""`restshape bench eigen`: solvers that share nothing find the same frequencies; no time is asserted."""

import json

import pytest
from modal import EDITS, SCENES

pytestmark = pytest.mark.cli

SMALL = ("--set", 'mesh.size="12 mm"', "--set", "mesh.layers=1", "--set", "effects.modal.modes=3")


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
def test_all_solvers_find_the_same(tmp_path, command):
    words = ("--edits", SCENES / "bar_100_short.jsonl", *SMALL)
    done = command("bench", "eigen", SCENES / "bar_100.toml", *words, "--json", "a.json")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "a.json").read_text())
    assert found["frames"] == 21
    solvers = found["solvers"]
    assert {"restshape", "Krylov-Schur", "GD", "JD", "LOBPCG"} <= set(solvers)
    for name in ("restshape", "Krylov-Schur", "Krylov-Schur, factor in blocks", "GD", "GD, modes of three frames"):
        assert solvers[name]["problems"] == 0, name
        assert solvers[name]["residual"] <= 1.1e-3 and solvers[name]["error"] < 1e-5, name
    assert solvers["restshape"]["substitutions"] < solvers["GD"]["substitutions"]
    assert "substitutions a frame" in done.stdout and "LOBPCG" in done.stdout
    assert "times as long" in done.stdout and "not included" in done.stdout


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
def test_what_has_no_modes_is_refused(command):
    done = command("bench", "eigen", SCENES / "plate.toml", "--edits", EDITS / "plate.jsonl")
    assert done.returncode == 2 and "no eigenproblem" in done.stderr and "take a scene of" in done.stderr
