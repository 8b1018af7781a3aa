"""Flows on two ranks: every candidate finds what one rank does, and factors that overlap take fewer iterations."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from restshape_studies.stability.scenery import make_replay, write_scene
from restshape_verification.flow.scenes import STEADY, channel, disc

from restshape.algebra.reuse.candidates import STEADY_FLOW

BODY = channel(3, 1, "rho = 1.5\nmu = 0.1\n", holes=disc("body", (1, 0.5), 0.15))
TEXT = BODY + STEADY + '[mesh]\nsize = 0.12\n[quantities]\ndrag = { drag = true, at = "body" }\n'


@pytest.fixture(scope="module")
def found(tmp_path_factory, outside):
    folder = tmp_path_factory.mktemp("ranks")
    program = str(Path(__file__).with_name("unsymmetric_ranks_program.py"))
    command = ["mpiexec", "-n", "2", sys.executable, program, str(write_scene(folder, TEXT))]
    done = subprocess.run(command, cwd=folder, env=outside, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.mpi
def test_every_candidate_agrees_with_one_rank(found, tmp_path):
    drag = next(iter(make_replay(write_scene(tmp_path, TEXT)).frames()))["q_drag"]
    assert len(found) == 6
    for name, row in found.items():
        assert row["name"] == name[:-2] and row["drag"] == pytest.approx(drag, rel=1e-5)


def alone(folder: Path, name: str) -> int:
    """Iterations of the first frame with one candidate on one rank."""
    made = make_replay(write_scene(folder, TEXT))
    for other in STEADY_FLOW:
        if other.name != name:
            made.analysis.solver.kept.choice.exclude(other)
    return int(next(iter(made.frames()))["iterations"])


@pytest.mark.mpi
@pytest.mark.parametrize("name", ["lu", "ilu(1)"])
def test_factors_that_overlap_save_of_what_parting_costs(found, tmp_path, name):
    """A quarter at least of the iterations that two ranks take more than one; incomplete factors have most on one."""
    apart, overlapping = (found[f"{name} {layers}"]["iterations"] for layers in "01")
    assert apart - overlapping > 0.25 * (apart - alone(tmp_path, name)) > 0
