"""Which rank a process will be, reported before MPI starts."""

import os
import re

from restshape.surroundings import lone_task

RANKS_HERE = ("OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS", "PMI_LOCAL_SIZE")
TASKS_PER_MACHINE = "SLURM_STEP_TASKS_PER_NODE"
RANK_NAMES = ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK")


def launched() -> bool:
    """Whether an MPI launcher started this process: it may lend its ranks a terminal that nobody sees."""
    return any(os.environ.get(key) for key in RANK_NAMES)


def first_rank() -> bool:
    """Before MPI starts: whether this process will be rank 0; of tasks that are no ranks, whether it is the first."""
    return rank_number() == "0"


def rank_number() -> str:
    """Before MPI starts: the number that this process will have."""
    ranks = (os.environ.get(key) for key in (*RANK_NAMES, *(["SLURM_PROCID"] if lone_task() else ())))
    return next((rank for rank in ranks if rank), "0")


def ranks_here() -> int:
    """Before MPI starts: how many ranks share this machine; 1 where the launcher does not say."""
    found = next((os.environ[name] for name in RANKS_HERE if os.environ.get(name, "").isdigit()), "")
    if found:
        return max(1, int(found))
    # Such as 16(x3),8: three machines with 16 and one with 8.
    tasks = re.findall(r"(\d+)(?:\(x\d+\))?", os.environ.get(TASKS_PER_MACHINE, "")) if launched() else []
    return max(map(int, tasks), default=1)
