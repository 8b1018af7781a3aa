"""Libraries use one thread a rank, unless the environment says otherwise."""

import subprocess
import sys

import pytest

ASKED = "import os, restshape; print(os.environ['OMP_NUM_THREADS'])"


@pytest.mark.cli
@pytest.mark.parametrize(("asked", "threads"), [({}, "1"), ({"OMP_NUM_THREADS": "2"}, "2")])
def test_one_thread_a_rank_unless_asked(asked, threads, outside):
    environment = {name: value for name, value in outside.items() if not name.endswith("NUM_THREADS")} | asked
    done = subprocess.run([sys.executable, "-c", ASKED], capture_output=True, text=True, env=environment)
    assert done.stdout.strip() == threads, done.stderr
