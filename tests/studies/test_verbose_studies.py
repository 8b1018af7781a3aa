"""Commands of studies take -v, and the processes that they start log as they do."""

from pathlib import Path

import pytest
from restshape_studies.bench.job import Job, run

from restshape.cli.verbosity import INHERITED

PLATE = Path(__file__).parents[1] / "data/plate.toml"


@pytest.mark.parametrize("name", ["explain", "accuracy", "bench reuse", "stability", "validate", "tables"])
def test_every_command_that_solves_takes_verbose(command, name):
    done = command(*name.split(), "--help")
    assert done.returncode == 0 and "--verbose" in done.stdout


@pytest.mark.slow
def test_processes_of_a_study_log_as_their_command_does(monkeypatch, capfd):
    monkeypatch.setenv(INHERITED, "1")
    run(Job(str(PLATE), "", "auto", frames=1))
    assert "Frame start: mesh level 3" in capfd.readouterr().err
