"""The operator on several ranks equals the operator on one."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.slow
@pytest.mark.mpi
def test_two_ranks_give_the_rows_of_one():
    command = ["mpiexec", "-n", "2", "--oversubscribe", "--allow-run-as-root", sys.executable, "ranks_program.py"]
    done = subprocess.run(
        command,
        cwd=Path(__file__).parent,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    gaps = [float(g) for g in re.findall(r"rank \d of 2 gap (\d\.\d+e[+-]\d+)", done.stdout)]
    assert len(gaps) == 2 and max(gaps) < 1e-14


@pytest.mark.mpi
@pytest.mark.parametrize("drags", [8, pytest.param(250, marks=pytest.mark.weekly)])
def test_patches_across_the_ranks_give_what_a_new_pattern_and_one_rank_give(drags):
    """Two bodies in `drags` drags each, three awkward ones in a few; to the last bit, but for sums over columns."""
    program = ["mpiexec", "-n", "3", "--oversubscribe", "--allow-run-as-root", sys.executable]
    done = subprocess.run(
        [*program, "flips_on_ranks_program.py", str(drags)],
        cwd=Path(__file__).parent,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert len(found) == 5
    for name, gaps in found.items():
        assert gaps["cold"] == gaps["alone"] == gaps["right"] == 0.0, name
        assert gaps["product"] < 1e-15 and gaps["grown"] > 0, name
    assert found["square"]["ghosts"] > 0
