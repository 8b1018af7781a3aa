"""Six hundred edits need no more memory than a hundred."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from drape_designs import HELD, sheet
from small_scenes import across, drag, make_replay, write_scene, write_script

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


@pytest.mark.slow
def test_predicted_frames_leave_nothing(tmp_path):
    """Vectors that Python has let go of are freed in them, too: kept, they were 18 kB a frame of this cloth."""
    text = sheet("hinge", HELD, size=0.04)
    there = across((0.2, 0.1), (0.203, 0.1), 100)
    script = write_script(tmp_path, drag("right", (0.2, 0.1), [*there, *there[::-1]]))
    made = make_replay(write_scene(tmp_path, text), script, predict="linear")
    used = [resident() for row in made.frames() if row["predicted"]]
    assert len(used) > 150 and used[-1] - used[50] < 1 << 20


def resident():
    """Memory [bytes] of this process."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
