"""The end of all ranks where one of them fails alone: the others would wait for it for ever."""

import sys
import time
import traceback

from restshape.cli import lone_process
from restshape.cli.limits import LIMIT_REACHED
from restshape.cli.ranks import first_rank, rank_number
from restshape.cli.signals import exit_code
from restshape.errors import UserError, printable

REFUSED = 2
"""Exit code of what is refused."""
LAST_WORD = 2.0
"""Seconds that the first rank has for its message."""


def several_ranks() -> bool:
    """Whether MPI has started and this is one of several ranks."""
    if "petsc4py.PETSc" not in sys.modules:
        return False
    from petsc4py import PETSc

    return int(PETSc.COMM_WORLD.size) > 1


def end_all_ranks(error: BaseException, command: str) -> None:
    """Say what has happened to this rank and end all, with the exit code of that; returns where there is no other.

    Args:
        error: that only this rank knows of.
        command: that runs.
    """
    if not several_ranks():
        return
    from petsc4py import PETSc

    if isinstance(error, UserError):
        print(printable(f"restshape {command}: {error}"), file=sys.stderr, flush=True)
    elif isinstance(error, KeyboardInterrupt):
        print(f"restshape {command}: interrupted", file=sys.stderr, flush=True)
    else:
        traceback.print_exception(error)
        print(f"restshape {command}: rank {PETSc.COMM_WORLD.rank} has failed", file=sys.stderr, flush=True)
    codes = {UserError: REFUSED, KeyboardInterrupt: exit_code(), MemoryError: LIMIT_REACHED}
    # NumPy's error of too little memory is a kind of its own.
    PETSc.COMM_WORLD.tompi4py().Abort(next((code for kind, code in codes.items() if isinstance(error, kind)), 1))


def refused(message: str) -> None:
    """Say once what all ranks have refused, or one of them, and end all of this command's; returns on a single one.

    Where all refuse the same, the first rank has said so, and ended all, before another one speaks.

    Args:
        message: what is refused, with what to do.
    """
    if first_rank():
        print(printable(message), file=sys.stderr, flush=True)
    elif lone_process.alone():
        time.sleep(LAST_WORD)
        print(printable(f"on rank {rank_number()}: {message}"), file=sys.stderr, flush=True)
    if lone_process.alone() and several_ranks():
        from petsc4py import PETSc

        sys.stdout.flush()
        # At the end of a process MPI would wait for the others, of which one may wait for this one.
        PETSc.COMM_WORLD.tompi4py().Abort(REFUSED)
