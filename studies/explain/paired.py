"""Replays of one script side by side: each frame with all effects of the scene, then with some of them left out.

What a slow spell of the machine does to a frame, it does to all of its kind; and times are those of the processor, for
what other programs take of it means nothing. So their differences mean something.
"""

import gc
import math
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from time import monotonic, process_time

from restshape_studies.explain.calls import Row, moved
from restshape_studies.explain.filled import Watch, stored, watched_operators
from restshape_studies.explain.without import without

from restshape.algebra import stages
from restshape.analysis.row_values import whole
from restshape.errors import UserError
from restshape.interface.run import Run
from restshape.mesh import moving
from restshape.replay import loop
from restshape.replay.request import Request

KEPT = (
    "index",
    "event",
    "level",
    "unknowns",
    "elements",
    "iterations",
    "newton",
    "pc_rebuilt",
    "preconditioner",
    "refused",
)
TIMES = ("ms", "ms_edit", "ms_relocate", "ms_map", "ms_flip", "ms_mesh", "ms_observe", "ms_estimate", "ms_record")


class ProcessorStage(stages.Stage):
    """Counts the processor's time of blocks of a stage."""

    # Of all stages, the innermost one last: when it began, and the time of those within it.
    blocks: list[list[float]] = []

    def __init__(self, name: str, seconds: dict[str, float], *rest: object) -> None:
        super().__init__(name, seconds, *rest)
        self._seconds = seconds

    def __enter__(self) -> None:
        super().__enter__()
        self.blocks.append([process_time(), 0.0])

    def __exit__(self, *raised: object) -> None:
        start, within = self.blocks.pop()
        taken, before = process_time() - start, self._seconds[self.name]
        super().__exit__(*raised)
        self._seconds[self.name] = before + taken - within
        if self.blocks:
            self.blocks[-1][1] += taken


@contextmanager
def processor_time() -> Iterator[None]:
    """Let replays take their times from the processor's clock, not from the one on the wall."""
    timed, stage = (loop, moving), stages.Stage
    clocks = [module.perf_counter for module in timed]
    for module in timed:
        module.perf_counter = process_time
    stages.Stage = ProcessorStage
    try:
        yield
    finally:
        stages.Stage = stage
        for module, clock in zip(timed, clocks):
            module.perf_counter = clock


def measure(
    asked: Request, left_out: Sequence[Sequence[str]], frames: int | None, seconds: float = math.inf
) -> list[Row]:
    """A row for each frame of each replay, with the number of its set of effects as `variant`.

    A variant other than the first one that has no solution gives its `problem` instead, and takes part no more.

    Args:
        asked: the replay.
        left_out: effects that the replays leave out, one set each.
        frames: after so many in which something was solved for, beside the first one, it ends; None for all.
        seconds: likewise after so long, once there is such a frame.

    Raises:
        UserError: the first of the replays cannot be.
    """
    with processor_time(), watched_operators() as watch:
        return _play(asked, left_out, frames, watch, monotonic() + seconds)


def _play(asked: Request, left_out: Sequence[Sequence[str]], frames: int | None, watch: Watch, end: float) -> list[Row]:
    """The rows of all replays, whose operators are watched, until a moment; other arguments as in `measure`."""
    running: dict[int, Iterator[Row]] = {}
    rows: list[Row] = []
    matrices, filled = [0 for _ in left_out], [Counter() for _ in left_out]
    step, left, solved = 0, frames, 0
    while step == 0 or (running and left != 0 and not (solved and monotonic() > end)):
        # Whoever comes first finds the caches cold: they take turns.
        turns = range(len(left_out)) if step == 0 else sorted(running, key=lambda k: (k + step) % len(left_out))
        for k in turns:
            if step == 0:
                gc.collect()
            count, entries = stored()[0], watch.entries()
            try:
                if step == 0:
                    running[k] = _frames(asked, left_out[k])
                row = next(running[k], None)
            except UserError as error:
                if k == 0:
                    raise
                running.pop(k, None)
                rows.append({"variant": k, "problem": error.what})
                continue
            if row is None:
                del running[k]
                continue
            if step == 0 or whole(row, "level") > 2:
                # What a replay lets go of is to be missed in its own turn, not in that of another one.
                gc.collect()
            matrices[k] += stored()[0] - count
            filled[k].update(watch.entries())
            filled[k].subtract(entries)
            mine = {names: counts for names, counts in filled[k].items() if counts}
            kept = {key: row[key] for key in (*KEPT, *TIMES, "calls", "calls_beside")} | {"tried": row.get("tried", 0)}
            if k == 0 and step and moved(row):
                solved, left = solved + 1, None if left is None else left - 1
            counts = {"matrices": matrices[k], "entries": sum(mine.values()), "filled": mine}
            rows.append({"variant": k, **counts, **kept})
        step += 1
    return rows


def _frames(asked: Request, names: Sequence[str]) -> Iterator[Row]:
    """The rows of a replay of the scene without these effects, with the calls of kernels of each frame."""
    scene = without(asked.scene, asked.application, names)
    for frame in Run(replace(asked, scene=scene), summed=False, counted=True):
        assert frame.counts is not None, "the run counts"
        yield {**frame.row, "calls": frame.counts.calls, "calls_beside": frame.counts.calls_beside}
