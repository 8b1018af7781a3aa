"""The operator on two ranks equals the operator on one."""

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
