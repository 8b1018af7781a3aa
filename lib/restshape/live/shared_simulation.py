"""A live simulation on several ranks: the first one has the link, the others do the same, call by call."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from petsc4py import PETSc

from restshape.errors import UserError
from restshape.live.live_simulation import USUAL, Event, LiveSimulation, Progress, SolvedBy, quiet

if TYPE_CHECKING:
    from restshape.interface.simulation import Predict
    from restshape.scene.model import Scene

TAG = 9
PAUSE = 5e-4
"""Seconds between two looks of a rank for the next call: one that waits in MPI would keep its core busy."""
END = "close"


class SharedSimulation(LiveSimulation):
    """The simulation on the first rank, whose calls the other ranks follow; arguments as of `LiveSimulation`."""

    shared = True

    def __init__(self, scene: Scene, manner: SolvedBy = USUAL, predict: Predict = "none") -> None:
        self._ranks = PETSc.COMM_WORLD.tompi4py()
        self._within = False
        super().__init__(scene, manner, predict)

    def _shared(self, name: str, own: Callable[[], Any], *arguments: object) -> Any:
        """Does what a method does on all ranks; calls within a call are the other ranks' own."""
        if self._within:
            return own()
        for rank in range(1, self._ranks.size):
            self._ranks.send((name, arguments), dest=rank, tag=TAG)
        self._within = True
        try:
            return own()
        finally:
            self._within = False

    def begin(self, event: Event) -> None:
        """As of `LiveSimulation`."""
        self._shared("begin", lambda: super(SharedSimulation, self).begin(event), dict(event))

    def begin_of_script(self, event: Event, room: float) -> None:
        """As of `LiveSimulation`."""
        own = super().begin_of_script
        self._shared("begin_of_script", lambda: own(event, room), dict(event), room)

    def go_on(self) -> bool:
        """As of `LiveSimulation`."""
        return bool(self._shared("go_on", super().go_on))

    def stop(self) -> bool:
        """As of `LiveSimulation`."""
        return bool(self._shared("stop", super().stop))

    def reopen(self, lines: Sequence[str], predict: Predict, progress: Progress = quiet) -> None:
        """As of `LiveSimulation`."""
        own = super().reopen
        self._shared("reopen", lambda: own(lines, predict, progress), list(lines), predict)

    def rates(self, of: str) -> dict[str, list[float]]:
        """As of `LiveSimulation`."""
        own = super().rates
        found: dict[str, list[float]] = self._shared("rates", lambda: own(of), of)
        return found

    def close(self) -> None:
        """As of `LiveSimulation`."""
        self._shared(END, super().close)


def follow_first_rank(live: LiveSimulation) -> None:
    """Does on another rank what the first one does, until it ends."""
    ranks = PETSc.COMM_WORLD.tompi4py()
    name = ""
    while name != END:
        while not ranks.iprobe(source=0, tag=TAG):
            time.sleep(PAUSE)
        name, arguments = ranks.recv(source=0, tag=TAG)
        try:
            getattr(live, name)(*arguments)
        except UserError:
            # The first rank has raised it, too, and answers.
            continue


def simulation(scene: Scene, manner: SolvedBy = USUAL, predict: Predict = "none") -> LiveSimulation:
    """The simulation of this rank; arguments and errors as of `LiveSimulation`."""
    comm = PETSc.COMM_WORLD
    kind = SharedSimulation if comm.size > 1 and comm.rank == 0 else LiveSimulation
    return kind(scene, manner, predict)
