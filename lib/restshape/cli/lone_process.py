"""A process that has one command to run: what it may leave out at its start and at its end."""

import atexit
import gc
import os
import sys
import threading

from restshape.surroundings import RANKED

_state = {"lone": False}


def begin() -> None:
    """From now on nobody else has anything in this process: memory is not searched for cycles while modules load.

    Nor are packages searched for what watches pydantic's models.
    """
    _state["lone"] = True
    gc.disable()
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")


def alone() -> bool:
    """Whether this process has one command to run."""
    return _state["lone"]


def set_up() -> None:
    """All that stays is there: cycles are looked for again, among what comes."""
    if _state["lone"] and not gc.isenabled():
        gc.freeze()
        gc.enable()


def end(code: int, words: list[str]) -> None:
    """End at once where nothing is left to do: PETSc and MPI would take 0.1 s to give back what the system takes back.

    Args:
        code: exit code.
        words: of the command line; those for PETSc may ask it for what it prints at its end.
    """
    asked = "--" in words or "PETSC_OPTIONS" in os.environ or not RANKED.isdisjoint(os.environ)
    busy = threading.active_count() > 1 or "gmsh" in sys.modules or sys.gettrace() is not None
    if not _state["lone"] or asked or busy:
        return
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
