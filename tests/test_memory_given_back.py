"""Memory that large meshes have freed is given back, though PETSc's libraries have it kept."""

import os
from pathlib import Path

import numpy as np
import pytest
from small_scenes import across, drag, plate, write_scene, write_script

from restshape import _kernels, memory
from restshape.memory import GIVEN_BACK, give_back

SIZE = 64 << 20
"""Bytes of an array."""


def resident() -> int:
    """Memory [bytes] of this process."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.fixture
def calls(monkeypatch):
    """How often memory was given back."""
    found = []
    monkeypatch.setattr(_kernels, "give_back_memory", lambda: found.append(True))
    return found


def test_what_was_freed_is_given_back():
    if not _kernels.give_back_memory():
        pytest.skip("the system's library does not give memory back on demand")
    before = resident()
    numbers = np.ones(SIZE // 8)
    # Behind it in memory, so that it is not the end of what the process has.
    behind = [np.ones(2000) for _ in range(100)]
    assert resident() - before > SIZE // 2
    del numbers
    give_back(GIVEN_BACK)
    assert resident() - before < SIZE // 8 and len(behind) == 100


def test_small_meshes_keep_it_for_their_next_frame(calls):
    give_back(GIVEN_BACK - 1)
    assert not calls
    give_back(GIVEN_BACK)
    assert len(calls) == 1


def test_new_meshes_and_maps_of_drags_give_it_back(tmp_path, command, monkeypatch, calls):
    """The first frame and the press; frames that relocate take what they have freed again."""
    monkeypatch.setattr(memory, "GIVEN_BACK", 1)
    scene = write_scene(tmp_path, plate())
    script = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.52, 0.5), 4)))
    done = command("replay", scene, "--edits", script)
    assert done.returncode == 0, done.stderr
    assert len(calls) == 2
