"""Where the time of a frame goes: named stages, each also a log stage of PETSc."""

from collections.abc import Callable
from time import perf_counter
from types import TracebackType

from petsc4py import PETSc

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
        self._within: list[float] = []
        logged = {name: log_stage(name, owner) for name in LOGGED}
        self._stages = {name: Stage(name, self.seconds, self._within, logged.get(name)) for name in NAMES}

    def reset(self) -> None:
        """Set all stages to zero."""
        self.seconds.update(ZERO)

    def __call__(self, name: str) -> "Stage":
        """Count the time of a `with` block as stage `name`."""
        if self.listener is not None:
            self.listener(name)
        return self._stages[name]


ZERO = dict.fromkeys(NAMES, 0.0)


class Stage:
    """Counts the time of `with` blocks, also of such a block within another one.

    Args:
        name: of the stage.
        seconds: of all stages, which it adds to.
        within: seconds of the stages inside each open block of any stage.
        log: PETSc's log stage, if it has one.
    """

    __slots__ = ("_log", "_name", "_seconds", "_starts", "_within")

    def __init__(
        self, name: str, seconds: dict[str, float], within: list[float], log: PETSc.LogStage | None = None
    ) -> None:
        self._name, self._seconds, self._within, self._log = name, seconds, within, log
        self._starts: list[float] = []

    def __enter__(self) -> None:
        if self._log is not None:
            self._log.push()
        self._within.append(0.0)
        self._starts.append(perf_counter())

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        taken = perf_counter() - self._starts.pop()
        self._seconds[self._name] += taken - self._within.pop()
        if self._within:
            self._within[-1] += taken
        if self._log is not None:
            self._log.pop()
