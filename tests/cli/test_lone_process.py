"""What a process with one command to run leaves out: collections while modules load, and the end of PETSc."""

import gc
import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from restshape.cli import lone_process

BRACKET = Path(__file__).resolve().parents[2] / "docs" / "examples" / "bracket.toml"
RANK = "PMI_RANK"
PLUGINS = "PYDANTIC_DISABLE_PLUGINS"


@pytest.fixture
def ended(monkeypatch):
    """Exit codes that the process has been ended with, as one that is nobody else's."""
    for name in (RANK, "OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PETSC_OPTIONS"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setitem(lone_process._state, "lone", True)
    monkeypatch.setattr(lone_process.atexit, "_run_exitfuncs", lambda: None)
    monkeypatch.setattr(sys, "gettrace", lambda: None)
    monkeypatch.delitem(sys.modules, "gmsh", raising=False)
    monkeypatch.setattr(threading, "active_count", lambda: 1)
    codes = []
    monkeypatch.setattr(os, "_exit", codes.append)
    return codes


def test_a_lone_process_looks_for_no_plugins_of_pydantic_by_itself(ended, monkeypatch):
    monkeypatch.setattr(gc, "disable", lambda: None)
    for given, found in ((None, "__all__"), ("none", "none")):
        monkeypatch.delenv(PLUGINS, raising=False)
        if given:
            monkeypatch.setenv(PLUGINS, given)
        lone_process.begin()
        assert os.environ[PLUGINS] == found
    monkeypatch.delenv(PLUGINS)


def test_a_lone_process_ends_at_once(ended):
    lone_process.end(3, ["replay", "a.toml"])
    assert ended == [3]


@pytest.mark.parametrize("name", [RANK, "PETSC_OPTIONS"])
def test_ranks_and_what_petsc_is_asked_for_end_in_full(ended, monkeypatch, name):
    monkeypatch.setenv(name, "-log_view")
    lone_process.end(0, ["replay", "a.toml"])
    assert not ended


def test_words_for_petsc_threads_and_libraries_that_clean_up_end_in_full(ended, monkeypatch):
    lone_process.end(0, ["replay", "a.toml", "--", "-log_view"])
    monkeypatch.setitem(sys.modules, "gmsh", lone_process)
    lone_process.end(0, [])
    monkeypatch.delitem(sys.modules, "gmsh")
    monkeypatch.setattr(threading, "active_count", lambda: 2)
    lone_process.end(0, [])
    assert not ended


def test_who_shares_the_process_keeps_it_and_its_collections(ended, monkeypatch):
    monkeypatch.setitem(lone_process._state, "lone", False)
    lone_process.end(0, [])
    frozen = gc.get_freeze_count()
    lone_process.set_up()
    assert not ended and gc.isenabled() and gc.get_freeze_count() == frozen


def test_a_replay_collects_from_its_first_frame_on_and_ends_with_its_code(tmp_path, outside):
    program = (
        "import atexit, gc, sys\n"
        "from restshape.interface.run import Run\n"
        "from restshape.cli.main import main\n"
        "before = Run.to_end\n"
        "def noted(*words, **named):\n"
        "    print('collects', gc.isenabled())\n"
        "    found = before(*words, **named)\n"
        "    print('collects', gc.isenabled(), gc.get_freeze_count() > 10000)\n"
        "    return found\n"
        "Run.to_end = noted\n"
        "atexit.register(lambda: print('said goodbye'))\n"
        f"sys.argv = ['restshape', 'replay', {str(BRACKET)!r}]\n"
        "main()\n"
        "print('still there')\n"
    )
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, env=outside, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert [line for line in lines if line.startswith("collects")] == ["collects False", "collects True True"]
    assert lines[-1] == "said goodbye"
