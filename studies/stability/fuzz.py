"""Random scenes and edits, in batches in processes of their own, for a crash or a hang ends the process."""

import itertools
import json
import re
import resource
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from restshape_studies.stability.batch import DAMAGED, DRAWN, FAULT, FILES, RECORDINGS, Batch
from restshape_studies.stability.example import DESCRIBED, MOST_ELEMENTS, RECORDED, Example
from restshape_studies.stability.tried import Found, Tried
from restshape_studies.stability.watched import REPORTS, End, watch

from restshape import __version__
from restshape.errors import UserError

PROCESS = "restshape_studies.stability.fuzz_process"
BATCH = {DRAWN: 100, DAMAGED: 100, FILES: 100, RECORDINGS: 25}
"""Examples a process, by kind: starting one takes as long as some ten examples; recordings are damages of one."""
PAIR = (DRAWN, DAMAGED)
CYCLE = (*PAIR, RECORDINGS, *PAIR, FILES, *PAIR, RECORDINGS, *PAIR, FILES)
CYCLE = (*CYCLE, *PAIR, RECORDINGS, *PAIR, FILES, *PAIR, RECORDINGS, *PAIR)
"""Kinds of the batches, in turn: of 10,000 examples 4,000 are drawn, 4,000 damaged, 1,500 name files, 500 record."""
PLACE = re.compile(r'File "(.*?)", line (\d+) in ')
"""Where Python was when it crashed, the innermost place first."""

OWN = ("stderr", REPORTS)
"""Files of the process that plays, which nobody needs."""
MADE_FOLDER = re.compile(r"\S*restshape-fuzz-\w+/")


def fuzz(
    count: int,
    seed: int,
    apps: Sequence[str],
    keep: Path | None = None,
    each: float = 120.0,
    seconds: float = float("inf"),
    shrink: bool = True,
    kinds: Sequence[str] = (),
    report: Callable[[Tried], None] = lambda tried: None,
    before: Tried | None = None,
) -> Tried:
    """What came of at least `count` random examples.

    Args:
        count: number of examples that are asked for, with those of `before`.
        seed: of the first batch; the next batch has the next one.
        apps: applications that the scenes are of.
        keep: folder for the files of faults, one folder each.
        each: seconds after which an example counts as hung.
        seconds: no batch begins after so long.
        shrink: look for smaller examples of faults.
        kinds: of the batches, which come in turn; none: all, in the shares of `CYCLE`.
        report: called after each batch.
        before: a run of the same seed, applications and kinds, with which this one goes on.

    Raises:
        UserError: hypothesis, which draws the examples, is not installed; no example could be played.
    """
    if find_spec("hypothesis") is None:
        raise UserError("hypothesis, which draws random scenes, is not installed", "--fuzz", "install restshape[test]")
    tried, start = before or Tried(), time.monotonic()
    tried.begin_part(checked_out())
    cycle = tuple(dict.fromkeys(kinds)) or CYCLE
    while tried.examples < count and time.monotonic() - start < seconds:
        kind = cycle[tried.batches % len(cycle)]
        wanted = min(BATCH[kind], count - tried.examples)
        batch = Batch(seed + tried.batches, wanted, tuple(apps), kind, tuple(tried.found), shrink)
        played = _timed(batch, tried, keep, each)
        report(tried)
        if not played:
            raise UserError("no example could be played", "--fuzz", "; ".join(f.what for f in tried.found.values()))
    return tried


def _timed(batch: Batch, tried: Tried, keep: Path | None, each: float) -> int:
    """Play a batch, and add its times; returns how many examples it played."""
    before, start, used = tried.examples, time.monotonic(), _processor_time()
    _play(batch, tried, keep, each)
    took, played = time.monotonic() - start, tried.examples - before
    tried.batches += 1
    tried.seconds += took
    tried.processor_seconds += _processor_time() - used
    tried.parts[-1].examples += played
    tried.parts[-1].seconds += took
    return played


def _processor_time() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def checked_out() -> str:
    """The commit that the sources lie in, with "+" where some were changed since; the version without a checkout."""
    words = ("git", "-C", str(Path(__file__).parents[2]))
    try:
        head, changed = (
            subprocess.run([*words, *more], capture_output=True, text=True, check=True).stdout.strip()
            for more in (("rev-parse", "--short=12", "HEAD"), ("status", "--porcelain", "-uno", "--", "*.py", "*pp"))
        )
    except (OSError, subprocess.CalledProcessError):
        return __version__
    return head + "+" * bool(changed)


def _play(batch: Batch, tried: Tried, keep: Path | None, each: float) -> None:
    """Play a batch in a process, and count what it reports."""
    with tempfile.TemporaryDirectory(prefix="restshape-fuzz-") as name:
        folder, lines = Path(name), []
        end = watch(PROCESS, folder, asdict(batch), each, lambda *line: lines.append(line))
        if end.hung and lines and lines[-1][0] == "begin":
            # Other work may have held it up: it has hung if it does so again.
            tried.repeated += 1
            lines.pop()
            end = watch(PROCESS, folder, asdict(replace(batch, alone=True)), each, lambda *line: lines.append(line))
        _count(batch, tried, lines, folder, end, keep)


def _count(batch: Batch, tried: Tried, lines: list[tuple[str, Any]], folder: Path, end: End, keep: Path | None) -> None:
    """Count what a process reported, and note faults."""
    new: dict[str, Found] = {}
    mutator = ""
    for what, content in lines:
        # After the first fault that nobody knows come smaller examples of it.
        if what == "begin":
            tried.examples += not new
            tried.damaged += batch.kind != DRAWN and not new
            tried.shrinking += bool(new)
            mutator = content["mutator"]
        elif what == "end" and not new:
            _add(tried, content)
        elif what == "fault":
            tried.broken += not new
            tried.ended(mutator, "traceback" if not new else "")
            name = content["signature"]
            if name in tried.found:
                tried.found[name].seen += not new
            else:
                new[name] = Found(batch.seed, "fault", name, content["what"])
    if end.hung or (end.problem and not new):
        tried.broken += 1
        kind = "hang" if end.hung else "crash"
        tried.ended(mutator, kind)
        place = PLACE.search((folder / "stderr").read_text(errors="replace"))
        name = f"{kind} at {Path(place[1]).name}:{place[2]}" if place else f"{kind} of seed {batch.seed}"
        if name in tried.found:
            tried.found[name].seen += 1
        else:
            new[name] = Found(batch.seed, kind, name, f"{name} | {end.problem} | {end.last_words}"[:1500])
    for name, found in new.items():
        tried.found[name] = found
        _keep(found, folder / FAULT if found.kind == "fault" else folder, keep, len(tried.found))


def _add(tried: Tried, end: dict[str, Any]) -> None:
    """Add an example that ended as it should."""
    tried.ended(end["mutator"], end["outcome"])
    if end["elements"] > MOST_ELEMENTS:
        tried.too_large += 1
    else:
        tried.largest = max(tried.largest, end["elements"])
        tried.valid += not end["message"]
        tried.refused += bool(end["message"])
    tried.written += end["written"]
    tried.frames += end["frames"]
    tried.refused_frames += end["refused"]
    tried.warned.update(end["warned"])
    tried.messages.update([MADE_FOLDER.sub("", end["message"].splitlines()[0])] if end["message"] else [])


def _keep(found: Found, folder: Path, keep: Path | None, number: int) -> None:
    """Keep the files of a fault for people."""
    described = folder / DESCRIBED
    if described.is_file():
        found.command = Example(**json.loads(described.read_text())).command
    elif (folder / RECORDED).is_file():
        found.command = f"restshape report {RECORDED}"
    else:
        return
    if keep is None:
        return
    kept = _new_folder(keep, f"{number:02d}-seed-{found.seed}")
    for path in sorted(folder.iterdir()):
        if path.is_file() and path.name not in OWN:
            shutil.copy(path, kept / path.name)
    (kept / "fault.txt").write_text(f"{found.signature}\n{found.what}\n{found.command}\n")
    found.folder = str(kept)


def _new_folder(keep: Path, name: str) -> Path:
    """A new folder of this name, or with a number behind it where there is one already."""
    for number in itertools.count(1):
        folder = keep / (name if number == 1 else f"{name}-{number}")
        try:
            folder.mkdir(parents=True)
        except FileExistsError:
            continue
        return folder
    raise AssertionError("counting ends never")
