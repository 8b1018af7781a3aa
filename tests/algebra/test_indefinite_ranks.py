"""Symmetric systems that are not definite on two ranks, whose own blocks need not have a factor."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def found(tmp_path_factory, outside):
    command = ["mpiexec", "-n", "2", sys.executable, str(Path(__file__).with_name("indefinite_ranks_program.py"))]
    environment = {**outside, "PYTHONPATH": str(TESTS)}
    folder = tmp_path_factory.mktemp("ranks")
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.mpi
@pytest.mark.parametrize("method", ["direct", "stale", "auto"])
def test_a_block_without_a_factor_does_no_harm(found, method):
    first, near = (found[method]["saddle"][name] for name in ("first", "near"))
    assert first["made"] and first["residual"] < 1e-8 and first["iterations"] <= 2
    # An old factor serves, but where each matrix has its own; whether a new one follows is a question of price.
    assert near["residual"] < 1e-8
    assert near["made"] and near["iterations"] <= 2 if method == "direct" else 2 <= near["iterations"] <= 8


@pytest.mark.mpi
@pytest.mark.parametrize("method", ["direct", "stale", "auto"])
def test_a_flow_with_pressure_is_that_of_its_closed_form(found, method):
    flow = found[method]["stokes"]
    assert flow["residual"] < 1e-8 and flow["iterations"] <= 2 and flow["error"] < 1e-3
