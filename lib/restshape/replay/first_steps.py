"""What the first frame of a fine scene does, said while it takes long: meshing, assembling, factoring, iterating."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic

from restshape.mesh.sizing import expected_triangles
from restshape.replay.loop import Replay

FINE = 10_000
"""Triangles from which on a first frame is expected to take so long that people wonder."""
LONG = 2.0
"""Seconds after which it takes long with fewer triangles, too."""
WORDS = {"pattern": "nonzero pattern", "values": "assembling", "factor": "factoring", "krylov": "iterating"}
"""What is said of each stage, once."""


class FirstSteps:
    """Says what a replay is at in its first frame, where that takes long.

    Args:
        replay: before its first frame.
        say: takes each line.
        clock: seconds.
    """

    def __init__(self, replay: Replay, say: Callable[[str], None], clock: Callable[[], float] = monotonic) -> None:
        self._replay, self._say, self._clock = replay, say, clock
        self._start = clock()
        self._left = dict(WORDS)
        if (count := self._expected()) >= FINE:
            say(f"first frame: meshing, about {float(f'{count:.2g}'):,.0f} triangles")
        replay.stages.listener = self._entered

    def end(self) -> None:
        """The first frame is done: nothing is said any more."""
        self._replay.stages.listener = None

    def _expected(self) -> float:
        """About how many triangles are made first; 0 where none are, or so few that nobody has asked for a size."""
        outline, mesh = self._replay.session.outline, self._replay.session.scene.mesh
        if outline is None or mesh.file or not mesh.size:
            return 0.0
        return expected_triangles(outline, mesh.size, mesh.near)[0]

    def _entered(self, stage: str) -> None:
        if stage not in self._left:
            return
        count = len(self._replay.moving.mesh.cells)
        if count >= FINE or self._clock() - self._start >= LONG:
            self._say(f"first frame: {self._left.pop(stage)}, {count:,} triangles")
