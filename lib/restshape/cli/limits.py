"""How long a frame may take and how much memory a run: options, and what ends a run at them."""

from __future__ import annotations

import argparse
import math
import sys
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from restshape.bounds import FRAME_SECONDS, FRAME_WAITS, MEMORY_SHARE, SCENE_BYTES
from restshape.errors import one_line
from restshape.outputs.kinds import CsvFile, RecordingFile, SweepFile

if TYPE_CHECKING:
    from restshape.replay.recording.recorder import Recorder

LIMIT_REACHED = 3
"""Exit code of a run that has ended at a limit."""
OTHER_RANKS = 10.0
"""Seconds that other ranks give the first one to say what has happened, and to keep the frames."""
LARGE_FILE = 4e6
"""Bytes of a drawing whose reading takes longer than a usual frame."""
KEPT = (CsvFile, RecordingFile, SweepFile)
"""Outputs that are written frame by frame, or run by run."""
UNITS = {"": 1.0, "kB": 1e3, "MB": 1e6, "GB": 1e9, "TB": 1e12}


def add_limits(parser: argparse.ArgumentParser) -> None:
    """Adds ``--frame-limit`` and ``--memory-limit``."""
    parser.add_argument(
        "--frame-limit",
        metavar="SECONDS",
        type=_seconds,
        default=FRAME_SECONDS,
        help="end where a frame computes longer, the frames before it kept (default: %(default)g; none: no limit)",
    )
    parser.add_argument(
        "--memory-limit",
        metavar="SIZE",
        type=_bytes,
        default=None,
        help="end where more memory is taken, such as 8GB (default: 90%% of the machine's; none: no limit)",
    )


def _seconds(text: str) -> float:
    """Seconds; 0 for none."""
    return 0.0 if text == "none" else _positive(text, text)


def _bytes(text: str) -> float:
    """Bytes of a size such as 500MB; 0 for none."""
    if text == "none":
        return 0.0
    unit = next((unit for unit in reversed(UNITS) if text.endswith(unit)), "")
    return _positive(text.removesuffix(unit), text) * UNITS[unit]


def _positive(number: str, text: str) -> float:
    try:
        found = float(number)
    except ValueError:
        found = math.nan
    if not 0.0 < found < 1e15:
        raise argparse.ArgumentTypeError(f"{text!r} is no limit: write a positive number, or none")
    return found


@contextmanager
def limited(args: argparse.Namespace) -> Iterator[Callable[[], None]]:
    """What says that the next frame begins; at a limit the process ends, with a message and `LIMIT_REACHED`.

    That is so while compiled code does not return, too. The time of the first frame counts from here.
    """
    from restshape import _kernels
    from restshape.cli.ranks import first_rank, ranks_here
    from restshape.memory import machine_memory

    memory = args.memory_limit
    if memory is None:
        memory = MEMORY_SHARE * machine_memory() / ranks_here()
    seconds = args.frame_limit + (0.0 if first_rank() or not args.frame_limit else OTHER_RANKS)
    sys.stderr.flush()
    kept = "; the frames before it are kept" if any(isinstance(one, KEPT) for one in vars(args).values()) else ""
    _kernels.watch(
        seconds,
        int(memory),
        LIMIT_REACHED,
        *messages(args.command, args.frame_limit, memory, kept, large_drawing(args), bool(vars(args).get("edits"))),
        FRAME_WAITS,
    )
    try:
        yield _kernels.begin_frame
    finally:
        _kernels.stop_watching()


def large_drawing(args: argparse.Namespace) -> str:
    """The drawing or the mesh of the scene of a command that is a large file, with its size; empty where none is."""
    try:
        scene = Path(args.scene)
        if not scene.is_file() or scene.stat().st_size > SCENE_BYTES:
            return ""
        raw = tomllib.loads(scene.read_text(encoding="utf-8"))
        named = scene.parent / (raw.get("shape", {}).get("file") or raw["mesh"]["file"])
        size = named.stat().st_size
    # Whatever is wrong with the scene is said where it is read.
    except (AttributeError, KeyError, TypeError, ValueError, OSError, RecursionError):
        return ""
    return f"{one_line(named.name)[:60]} has {size / 1e6:.0f} MB" if size > LARGE_FILE else ""


def messages(
    command: str, seconds: float, memory: float, kept: str, file: str = "", edits: bool = False
) -> tuple[str, str]:
    """What is said where a frame takes too long, and where memory runs out.

    Args:
        command: that runs.
        seconds, memory: its limits [s], [bytes].
        kept: what becomes of the frames before.
        file: `large_drawing`, which is the likely cause in the first frame.
        edits: whether a script is replayed, each of whose edits may have more frames.
    """
    slow = f"frame %d takes longer than {seconds:g} s (%p s of computing in %c s)%s{kept}"
    large = f"in frame %d more than {memory / 1e9:.3g} GB of memory are in use%s{kept}"
    more = "give an edit that goes far more frames, " if edits else ""
    do = f"look for a coordinate in the wrong unit, {more}take a coarser mesh, or raise"
    if file:
        do = f"{file}: read some of its layers alone (shape.layers), export less, take a coarser mesh, or raise"
    return (
        f"restshape {command}: {slow}\n  try: {do} --frame-limit\n",
        f"restshape {command}: {large}\n  try: {do.replace(more, '')} --memory-limit\n",
    )


def lift_limits() -> None:
    """From now on nothing is limited: all frames are done."""
    from restshape import _kernels

    _kernels.stop_watching()


def keep_frames(recorder: Recorder) -> None:
    """Has a recording finished before a limit ends the process."""
    from restshape import _kernels

    _kernels.watch_outlet(*recorder.outlet)
