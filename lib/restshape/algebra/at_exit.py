"""The end of solvers that call Python: PETSc ends after Python has, and must not find one of them alive."""

import atexit
from weakref import ref

from petsc4py import PETSc

_alive: dict[int, ref[PETSc.Object]] = {}


def destroyed_at_exit(solver: PETSc.Object) -> PETSc.Object:
    """The solver, one with a Python context, which the program destroys at its end if it is alive then."""
    key = id(solver)
    _alive[key] = ref(solver, lambda _: _alive.pop(key, None))
    return solver


@atexit.register
def _destroy() -> None:
    for reference in list(_alive.values()):
        if (solver := reference()) is not None:
            solver.destroy()
    # What Python has let go of waits for a collective call; a rank that ends alone must not wait for others.
    PETSc.garbage_cleanup(PETSc.COMM_SELF)
    if PETSc.COMM_WORLD.size == 1:
        PETSc.garbage_cleanup(PETSc.COMM_WORLD)
