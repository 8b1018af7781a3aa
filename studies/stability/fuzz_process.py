"""A batch of random examples: ``python -m restshape_studies.stability.fuzz_process FOLDER`` reads it from stdin.

It reports the folder's file of each example before it plays it, so that whoever watches knows which one it was
that ended or hung the process.
"""

import faulthandler
import json
import math
import shutil
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

from hypothesis import HealthCheck, Phase, given, seed, settings
from restshape_studies.stability import player
from restshape_studies.stability.batch import DRAWN, FAULT, RECORDINGS, Batch
from restshape_studies.stability.example import DESCRIBED, RECORDED, Example
from restshape_studies.stability.player import Played
from restshape_studies.stability.strategies import examples
from restshape_studies.stability.watched import READY, REPORTS, Telling

from restshape import _kernels
from restshape.surroundings import start_petsc

MEMORY = 6 << 30
"""Bytes that an example may take."""
CRASH = 70
"""Exit code where it takes more."""
OWN = ("stderr", REPORTS)
"""Files of the process itself."""
SHRINKING = 20.0
"""Seconds after the first fault in which smaller examples of it are looked for."""


@dataclass
class Watched:
    """Reports whatever ends a replay, and keeps its files; lets what is known pass."""

    known: tuple[str, ...]
    folder: Path
    report: Callable[[str, Any], None]
    first: float = math.inf

    def of(self, keep: Callable[[Path], None]) -> Self:
        """Itself, watching over an example whose files `keep` writes into a folder."""
        self.keep = keep
        return self

    def __enter__(self) -> None:
        """Begin to watch."""

    def __exit__(self, kind: Any, error: BaseException | None, trace: Any) -> bool:
        """Report the error, if there is one; it goes no further if it is known."""
        if error is None or isinstance(error, KeyboardInterrupt):
            return False
        from restshape_studies.stability.player import signature

        name = signature(error)
        self.report("fault", {"signature": name, "what": f"{kind.__name__}: {error}".strip()[:600]})
        if name in self.known:
            return True
        self.first = min(self.first, time.monotonic())
        self.keep(self.folder / FAULT)
        return False


def run(batch: Batch, folder: Path, report: Callable[[str, Any], None]) -> None:
    """Play the batch; of a fault the smallest example that was found stays in the folder for it.

    Raises:
        BaseException: the fault, after it was reported.
    """
    # A crash reports its line of Python, which PETSc's own handler would not.
    start_petsc(["-no_signal_handler"])
    faulthandler.enable()
    (folder / FAULT).mkdir(exist_ok=True)
    watched = Watched(batch.known, folder, report)
    (_run_recordings if batch.kind == RECORDINGS else _run_examples)(batch, folder, watched, report)


def _run_recordings(batch: Batch, folder: Path, watched: Watched, report: Callable[[str, Any], None]) -> None:
    """Report and salvage damaged recordings."""
    from restshape_studies.stability.hostile_recordings import again, damages, outcome

    found = again(folder) if batch.alone else damages(batch, folder, lambda: report(READY, None))
    for name, path in found:
        report("begin", {"mutator": name})
        limit_memory()
        with watched.of(lambda kept, path=path: shutil.copy(path, kept / RECORDED)):
            report("end", {"mutator": name, "outcome": outcome(folder, path), **asdict(Played())})


def _run_examples(batch: Batch, folder: Path, watched: Watched, report: Callable[[str, Any], None]) -> None:
    """Replay random examples."""

    def play(example: Example) -> None:
        clear(folder)
        example.write(folder)
        name = example.damaged or DRAWN
        report("begin", {"mutator": name})
        limit_memory()
        with watched.of(example.write):
            played = player.play(folder, example)
            report("end", {"mutator": name, "outcome": played.outcome, **asdict(played)})

    if batch.alone:
        play(Example(**json.loads((folder / DESCRIBED).read_text())))
        return
    phases = (Phase.generate, Phase.shrink) if batch.shrink else (Phase.generate,)

    @seed(batch.seed)
    @settings(
        max_examples=batch.count,
        database=None,
        deadline=None,
        phases=phases,
        report_multiple_bugs=False,
        suppress_health_check=list(HealthCheck),
    )
    @given(examples(batch.apps, batch.kind))
    def play_one(example: Example) -> None:
        if time.monotonic() - watched.first > SHRINKING:
            return
        play(example)

    play_one()


def clear(folder: Path) -> None:
    """Remove the files of the example before; the process's own stay."""
    for path in folder.iterdir():
        if path.is_file() and path.name not in OWN:
            path.unlink()


def limit_memory() -> None:
    """End the process where an example takes more memory than it may."""
    large = f"an example took more than {MEMORY >> 30} GB\n"
    _kernels.watch(0.0, MEMORY, CRASH, large, large)


def main() -> int:
    """Play the batch on stdin."""
    table = json.loads(sys.stdin.read())
    batch = Batch(**{**table, "apps": tuple(table["apps"]), "known": tuple(table["known"])})
    folder = Path(sys.argv[1])
    run(batch, folder, Telling(folder))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
