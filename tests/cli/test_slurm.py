"""What Slurm sets in the environment of its tasks: ranks and memory of a machine, and tasks that are no ranks."""

import pytest

from restshape import memory
from restshape.cli.main import main
from restshape.cli.ranks import first_rank, launched, ranks_here
from restshape.errors import UserError
from restshape.surroundings import lone_task, start_petsc

OTHERS = ("OMPI_COMM_WORLD_LOCAL_SIZE", "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", "PMI_RANK", "PMIX_RANK")


@pytest.fixture
def task(monkeypatch):
    """Sets variables of a task of srun."""

    def set_variables(**values: str) -> None:
        for name in (*OTHERS, "MPI_LOCALNRANKS", "PMI_LOCAL_SIZE"):
            monkeypatch.delenv(name, raising=False)
        for name, value in values.items():
            monkeypatch.setenv(name, value)

    return set_variables


@pytest.mark.parametrize(("machines", "most"), [("4", 4), ("16(x3),8", 16), ("2,12(x2)", 12), ("", 1)])
def test_ranks_of_a_machine_share_its_memory(task, machines, most):
    task(SLURM_STEP_TASKS_PER_NODE=machines, PMIX_RANK="3")
    assert launched() and not first_rank() and ranks_here() == most


def test_a_lone_process_has_the_memory_for_itself(task):
    """As that of a job script, whose tasks are those that srun would start."""
    task(SLURM_STEP_TASKS_PER_NODE="16", SLURM_NTASKS="16", SLURM_PROCID="0")
    assert ranks_here() == 1 and not lone_task() and first_rank()
    task(OMPI_COMM_WORLD_LOCAL_SIZE="2", OMPI_COMM_WORLD_RANK="0", SLURM_STEP_TASKS_PER_NODE="16")
    assert ranks_here() == 2


def test_a_job_has_the_memory_that_it_has_asked_for(monkeypatch):
    whole = memory.machine_memory()
    for asked, found in (("1", 1 << 20), ("0", whole), ("much", whole), (str(2 * whole), whole)):
        monkeypatch.setenv("SLURM_MEM_PER_NODE", asked)
        assert memory.machine_memory() == found


def test_tasks_that_are_no_ranks_are_refused_with_one_message(task, capsys, tmp_path):
    task(SLURM_STEP_NUM_TASKS="4", SLURM_PROCID="1")
    with pytest.raises(UserError, match="srun has started 4 tasks that are no ranks of MPI"):
        start_petsc()
    assert not first_rank()
    task(SLURM_PROCID="0")
    assert main(["validate", "--case", "plane.patch"]) == 2
    assert "export SLURM_MPI_TYPE=pmix" in capsys.readouterr().err
    task(PMI_RANK="0")
    assert not lone_task()
