"""Commands of studies take -v, and the processes that they start log as they do."""

import subprocess
import sys
from pathlib import Path

import pytest
from restshape_studies.bench.job import Job, run

from restshape.cli.verbosity import INHERITED

PLATE = Path(__file__).parents[1] / "data/plate.toml"


@pytest.mark.cli
@pytest.mark.parametrize("command", ["explain", "accuracy", "bench reuse", "stability", "validate", "tables"])
def test_every_command_that_solves_takes_verbose(command):
    words = [sys.executable, "-m", "restshape.cli.main", *command.split(), "--help"]
    assert "--verbose" in subprocess.run(words, capture_output=True, text=True, check=True).stdout


@pytest.mark.slow
def test_processes_of_a_study_log_as_their_command_does(monkeypatch, capfd):
    monkeypatch.setenv(INHERITED, "1")
    run(Job(str(PLATE), "", "auto", frames=1))
    assert "Frame start: mesh level 3" in capfd.readouterr().err
