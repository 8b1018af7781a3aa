"""Which rank a process will be, reported before MPI starts."""

import os

RANK_NAMES = ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK")


def launched() -> bool:
    """Whether an MPI launcher started this process: it may lend its ranks a terminal that nobody sees."""
    return any(os.environ.get(key) for key in RANK_NAMES)


def first_rank() -> bool:
    """Before MPI starts: whether this process will be rank 0."""
    ranks = (os.environ.get(key) for key in RANK_NAMES)
    return next((rank for rank in ranks if rank), "0") == "0"
