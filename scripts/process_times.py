"""How long `restshape replay` takes from the start of the process to its end: the least of ten runs, in seconds.

python scripts/process_times.py [SCENE SCRIPT]

Without words the plate of 189 frames is replayed. Processor time is that of the replay and of the process that records;
on one quiet core the elapsed time is about their sum.
"""

import os
import resource
import sys
import time
from pathlib import Path
from subprocess import DEVNULL, run
from tempfile import TemporaryDirectory

PLATE = ("apps/solid/scenes/plate.toml", "apps/solid/edits/plate.jsonl")
RUNS = 10


def once(words: list[str]) -> tuple[float, float]:
    """Elapsed and processor seconds of one run."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    run(words, stdout=DEVNULL, stderr=DEVNULL, check=True)
    elapsed, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return elapsed, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main(files: list[str]) -> None:
    """Print a line without a recording, and one with it."""
    with TemporaryDirectory() as folder:
        program = [str(Path(sys.executable).parent / "restshape"), "replay", *files]
        for name, more in (("replay", []), ("replay --out", ["--out", os.path.join(folder, "a.vtkhdf")])):
            elapsed, used = (min(column) for column in zip(*(once([*program, *more]) for _ in range(RUNS))))
            print(f"{name:14}{elapsed:6.2f} s elapsed, {used:.2f} s of processor time")


if __name__ == "__main__":
    main(sys.argv[1:] or list(PLATE))
