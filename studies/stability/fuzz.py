"""Random scenes and edits, in batches in processes of their own, for a crash or a hang ends the process."""

import itertools
import json
import re
import shutil
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from restshape_studies.stability.batch import DAMAGED, DRAWN, FAULT, FILES, RECORDINGS, Batch
from restshape_studies.stability.example import MOST_ELEMENTS, RECORDED, Example
from restshape_studies.stability.watched import REPORTS, End, watch

from restshape.errors import UserError

PROCESS = "restshape_studies.stability.fuzz_process"
BATCH = 25
"""Examples a process: starting one takes a second."""
CYCLE = (*(DRAWN, DAMAGED, DRAWN, DAMAGED, FILES) * 3, *(DRAWN, DAMAGED, DRAWN, DAMAGED, RECORDINGS))
"""Kinds of the batches, in turn: of 10,000 examples 4,000 are drawn, 4,000 damaged, 1,500 name files, 500 record."""
PLACE = re.compile(r'File "(.*?)", line (\d+) in ')
"""Where Python was when it crashed, the innermost place first."""

OWN = ("stderr", REPORTS)
"""Files of the process that plays, which nobody needs."""
MADE_FOLDER = re.compile(r"\S*restshape-fuzz-\w+/")


@dataclass
class Found:
    """A fault, with the files that show it.

    Args:
        seed: of the batch.
        kind: "crash", "hang", or "fault": a traceback, or a number that is none.
        signature: what distinguishes it from others.
        what: its message.
        folder: scene, edits and `example.json`; empty where nobody asked to keep them.
        command: which replays them in that folder.
        seen: how often.
    """

    seed: int
    kind: str
    signature: str
    what: str
    folder: str = ""
    command: str = ""
    seen: int = 1


# More than 15 attributes: each is a count of the table that a campaign gives.
@dataclass
class Tried:
    """What was tried, and what came of it.

    Args:
        examples: played in all; shrinking: more that were played to make those at fault smaller.
        valid: that gave frames to the end; refused: with a message, as a whole; too_large: with a first mesh of more
            elements than wanted, which ended there; broken: at fault.
        damaged: of all, those with damage to valid files; written: those that `restshape replay` replayed too.
        mutated: by what was done to examples, how many ended how.
        frames, refused_frames: over all examples.
        seconds: wall-clock.
        largest: elements of a first mesh.
        warned: warnings that numpy gave, with how often; messages: first lines of the refusals, likewise.
        found: faults.
    """

    examples: int = 0
    shrinking: int = 0
    valid: int = 0
    refused: int = 0
    too_large: int = 0
    broken: int = 0
    damaged: int = 0
    written: int = 0
    frames: int = 0
    refused_frames: int = 0
    seconds: float = 0.0
    largest: int = 0
    warned: Counter = field(default_factory=Counter)
    messages: Counter = field(default_factory=Counter)
    mutated: dict[str, Counter] = field(default_factory=dict)
    found: dict[str, Found] = field(default_factory=dict)

    def ended(self, mutator: str, outcome: str) -> None:
        """Count an example that ended so; one without an outcome is a smaller one of a fault."""
        if outcome:
            self.mutated.setdefault(mutator, Counter())[outcome] += 1

    def as_dict(self) -> dict[str, Any]:
        """The numbers for `--json`."""
        table = {
            key: value for key, value in vars(self).items() if key not in ("found", "warned", "messages", "mutated")
        }
        report = {"warned": dict(self.warned), "messages": dict(self.messages.most_common())}
        mutated = {name: dict(sorted(ends.items())) for name, ends in sorted(self.mutated.items())}
        return {**table, "mutated": mutated, **report, "faults": [asdict(found) for found in self.found.values()]}


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
) -> Tried:
    """What came of at least `count` random examples.

    Args:
        count: number of examples that are asked for.
        seed: of the first batch; the next batch has the next one.
        apps: applications that the scenes are of.
        keep: folder for the files of faults, one folder each.
        each: seconds after which an example counts as hung.
        seconds: no batch begins after so long.
        shrink: look for smaller examples of faults.
        kinds: of the batches, which come in turn; none: all, in the shares of `CYCLE`.
        report: called after each batch.

    Raises:
        UserError: hypothesis, which draws the examples, is not installed; no example could be played.
    """
    if find_spec("hypothesis") is None:
        raise UserError("hypothesis, which draws random scenes, is not installed", "--fuzz", "install restshape[test]")
    tried, start, number = Tried(), time.monotonic(), 0
    cycle = tuple(dict.fromkeys(kinds)) or CYCLE
    while tried.examples < count and time.monotonic() - start < seconds:
        before = tried.examples
        wanted = min(BATCH, count - tried.examples)
        kind = cycle[number % len(cycle)]
        batch = Batch(seed + number, wanted, tuple(apps), kind, tuple(tried.found), shrink)
        _play(batch, tried, keep, each)
        number += 1
        tried.seconds = time.monotonic() - start
        report(tried)
        if tried.examples == before:
            raise UserError("no example could be played", "--fuzz", "; ".join(f.what for f in tried.found.values()))
    return tried


def _play(batch: Batch, tried: Tried, keep: Path | None, each: float) -> None:
    """Play a batch in a process, and count what it reports."""
    with tempfile.TemporaryDirectory(prefix="restshape-fuzz-") as name:
        folder, lines = Path(name), []
        end = watch(PROCESS, folder, asdict(batch), each, lambda *line: lines.append(line))
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
    described = folder / "example.json"
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
