"""Where the time of a frame goes: named stages, each also a log stage of PETSc."""

from collections.abc import Callable

from petsc4py import PETSc

from restshape._kernels import OpenBlocks, Stage

LOGGED = ("pattern", "values", "factor", "krylov")
"""Those that are log stages of PETSc."""
NAMES = ("relocate", "map", "flip", "mesh", "pattern", "values", "factor", "krylov", "observe")


OWNER = "restshape"


def log_stage(name: str, owner: str = OWNER) -> PETSc.LogStage:
    """PETSc's log stage of a stage, of that owner."""
    return PETSc.Log.Stage(f"{owner} {name}")


class Stages:
    """Seconds spent in each stage since the last `reset`; a stage within another one is not counted in that one too.

    Args:
        owner: of PETSc's log stages, by which events are told apart from those of others.

    Attributes:
        listener: is given the name of each stage before its block; None: nobody listens.
    """

    def __init__(self, owner: str = OWNER) -> None:
        self.listener: Callable[[str], None] | None = None
        self.seconds = dict.fromkeys(NAMES, 0.0)
        logged, blocks = {name: log_stage(name, owner).id for name in LOGGED}, OpenBlocks()
        self._stages = {name: Stage(name, self.seconds, blocks, logged.get(name, -1)) for name in NAMES}

    def reset(self) -> None:
        """Set all stages to zero."""
        self.seconds.update(ZERO)

    def __call__(self, name: str) -> Stage:
        """Count the time of a `with` block as stage `name`."""
        if self.listener is not None:
            self.listener(name)
        return self._stages[name]


ZERO = dict.fromkeys(NAMES, 0.0)
