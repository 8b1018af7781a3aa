"""Where the time of a frame goes: named stages, each also a log stage of PETSc."""

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter

from petsc4py import PETSc

NAMES = ("relocate", "map", "flip", "mesh", "pattern", "values", "factor", "krylov", "observe", "record")


class Stages:
    """Seconds spent in each stage since the last `reset`; a stage within another one is not counted in that one too."""

    def __init__(self) -> None:
        self.seconds = dict.fromkeys(NAMES, 0.0)
        self._within: list[float] = []
        self._log = {name: PETSc.Log.Stage(f"restshape {name}") for name in ("pattern", "values", "factor", "krylov")}

    def reset(self) -> None:
        """Set all stages to zero."""
        for name in NAMES:
            self.seconds[name] = 0.0

    @contextmanager
    def __call__(self, name: str) -> Iterator[None]:
        """Count the time of a `with` block as stage `name`."""
        log = self._log.get(name)
        if log:
            log.push()
        start = perf_counter()
        self._within.append(0.0)
        try:
            yield
        finally:
            taken = perf_counter() - start
            self.seconds[name] += taken - self._within.pop()
            if self._within:
                self._within[-1] += taken
            if log:
                log.pop()
