"""How much memory there is, how much a process takes, and pieces of work that may take no more than so much."""

from __future__ import annotations

import os
import resource
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

JOB_MEMORY = "SLURM_MEM_PER_NODE"
"""MB that a job of Slurm has on a machine."""
GIVEN_BACK = 200_000
"""Nodes and cells of a mesh from which on memory is given back: 60 MB a new mesh of 400,000 nodes, 180 MB a rank that
has made multigrid, 230 to 460 MB a map of a drag."""
CONTROL_GROUP = Path("/sys/fs/cgroup/memory.max")


def machine_memory() -> int:
    """Memory of the machine, or of the container or Slurm's job that this process runs in [bytes]."""
    found = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    with suppress(OSError, ValueError):
        found = min(found, int(CONTROL_GROUP.read_text()))
    with suppress(KeyError, ValueError):
        # 0 is all that there is.
        found = min(found, int(os.environ[JOB_MEMORY]) << 20 or found)
    return found


@contextmanager
def bounded_memory(most: int) -> Iterator[None]:
    """Has what is done within fail by a MemoryError before it takes more than so much memory besides [bytes].

    Where the system does not report how much a process has, nothing is bounded.
    """
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[0])
    except (OSError, ValueError):
        yield
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    wanted = pages * os.sysconf("SC_PAGE_SIZE") + most
    resource.setrlimit(resource.RLIMIT_AS, (wanted if soft == resource.RLIM_INFINITY else min(soft, wanted), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def give_back(size: int) -> None:
    """Give what was freed back to the system, where work on a mesh of so many nodes and cells has left much of it.

    PETSc's libraries have the system's library keep it, in pieces that what comes next may not fit into.
    """
    if size >= GIVEN_BACK:
        from restshape import _kernels

        _kernels.give_back_memory()
