"""A batch of random examples: ``python -m restshape_studies.stability.fuzz_process FOLDER`` reads it from stdin.

It reports the folder's file of each example before it plays it, so that whoever watches knows which one it was
that ended or hung the process.
"""

import faulthandler
import json
import math
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

from hypothesis import HealthCheck, Phase, given, seed, settings
from restshape_studies.stability.batch import FAULT, Batch
from restshape_studies.stability.example import Example
from restshape_studies.stability.strategies import examples
from restshape_studies.stability.watched import Telling

from restshape.surroundings import start_petsc

SHRINKING = 20.0
"""Seconds after the first fault in which smaller examples of it are looked for."""


@dataclass
class Watched:
    """Reports whatever ends a replay, and keeps its files; lets what is known pass."""

    known: tuple[str, ...]
    folder: Path
    tell: Callable[[str, Any], None]
    first: float = math.inf

    def of(self, example: Example) -> Self:
        """Itself, watching over an example."""
        self.example = example
        return self

    def __enter__(self) -> None:
        """Begin to watch."""

    def __exit__(self, kind: Any, error: BaseException | None, trace: Any) -> bool:
        """Report the error, if there is one; it goes no further if it is known."""
        if error is None or isinstance(error, KeyboardInterrupt):
            return False
        from restshape_studies.stability.player import signature

        name = signature(error)
        self.tell("fault", {"signature": name, "what": f"{kind.__name__}: {error}".strip()[:600]})
        if name in self.known:
            return True
        self.first = min(self.first, time.monotonic())
        self.example.write(self.folder / FAULT)
        return False


def run(batch: Batch, folder: Path, tell: Callable[[str, Any], None]) -> None:
    """Play the batch; of a fault the smallest example that was found stays in the folder for it.

    Raises:
        BaseException: the fault, after it was reported.
    """
    # A crash reports its line of Python, which PETSc's own handler would not.
    start_petsc(["-no_signal_handler"])
    faulthandler.enable()
    from restshape_studies.stability.player import play

    (folder / FAULT).mkdir(exist_ok=True)
    phases = (Phase.generate, Phase.shrink) if batch.shrink else (Phase.generate,)
    watched = Watched(batch.known, folder, tell)

    @seed(batch.seed)
    @settings(
        max_examples=batch.count,
        database=None,
        deadline=None,
        phases=phases,
        report_multiple_bugs=False,
        suppress_health_check=list(HealthCheck),
    )
    @given(examples(batch.apps, batch.damaged))
    def play_one(example: Example) -> None:
        if time.monotonic() - watched.first > SHRINKING:
            return
        example.write(folder)
        tell("begin", {})
        start = time.perf_counter()
        with watched.of(example):
            played = play(folder, example)
            tell("end", {**asdict(played), "seconds": time.perf_counter() - start})

    play_one()


def main() -> int:
    """Play the batch on stdin."""
    table = json.loads(sys.stdin.read())
    batch = Batch(**{**table, "apps": tuple(table["apps"]), "known": tuple(table["known"])})
    folder = Path(sys.argv[1])
    run(batch, folder, Telling(folder))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
