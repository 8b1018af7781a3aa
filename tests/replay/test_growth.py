"""Six hundred edits need no more memory than a hundred."""

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).with_name("edit_many_times.py")
LIMIT = 7 << 17
"""Bytes that the last five hundred of six hundred edits may add; rows of 2.5 kB that were kept would be more."""


def growth(folder, outside, policy):
    """How many bytes the edits after the first hundred have cost."""
    words = [sys.executable, str(SCRIPT), str(folder), policy]
    done = subprocess.run(words, capture_output=True, text=True, env=outside, timeout=120)
    assert done.returncode == 0, done.stderr
    used = [tuple(map(int, line.split())) for line in done.stdout.splitlines()]
    assert used[1][0] == 100 and used[-1][0] == 600
    return used[-1][1] - used[1][1]


@pytest.mark.slow
@pytest.mark.parametrize("policy", ["auto", pytest.param("thesis", marks=pytest.mark.weekly)])
def test_memory_stays(tmp_path, outside, policy):
    assert growth(tmp_path, outside, policy) < LIMIT
