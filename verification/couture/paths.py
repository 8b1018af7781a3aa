"""The way to a drape: whether the same edits in half as many frames end in the same one.

Where the energy has one minimum near, they do. Where friction remembers the way, or cloth folds to either side, there
are two rests, which are reported with their energies.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from restshape_studies.stability.scenery import make_run, write_script

from restshape.cli.options import add_scene, read_scene, write_json
from restshape.cli.parser import add_edits
from restshape.cli.progress import progress
from restshape.errors import UserError
from restshape.interface.run import Run
from restshape.outputs.si_numbers import si

SAME = 1e-3
"""Distance over the size of the cloth up to which two drapes are the same: ten times the tolerance of forces."""


RESTING = frozenset({"press", "pull", "release", "idle", "undo", "redo"})
"""Events that are no edits to compare after: what is undone is brought back, whatever the way."""


@dataclass(frozen=True)
class Drape:
    """A drape at the end of an edit: frames until then, energy [J], places (n, 3) and size [m], and whether all frames
    until then have converged."""

    frames: int
    energy: float
    places: np.ndarray
    size: float
    converged: bool


@dataclass(frozen=True)
class Ends:
    """The ends of two ways.

    Args:
        frames: of both.
        energies: [J] there.
        distance: largest one of a node [m]; nothing where the meshes are not the same.
        size: of the cloth [m].
        converged: whether all frames have, of both.
        line: of the script, of the edit at whose end this is.
    """

    frames: tuple[int, int]
    energies: tuple[float, float]
    distance: float | None
    size: float
    converged: tuple[bool, bool]
    line: int = 0

    @property
    def same(self) -> bool:
        """Whether both are the same drape."""
        return self.distance is not None and self.distance <= SAME * self.size

    def report(self) -> str:
        """What there is to say, in one line."""
        apart = "on different meshes" if self.distance is None else f"{si(self.distance, 'm', 3)} apart"
        first, second = (si(energy, "J", 6) for energy in self.energies)
        ways = f"in {self.frames[0]} and in {self.frames[1]} frames"
        drapes = "the same drape" if self.same else "two rests"
        doubt = "" if all(self.converged) else "; frames until then were refused, or have not converged"
        return f"{drapes} {ways}: {apart}, energies {first} and {second}{doubt}"


def halved(events: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The same edits in half as many frames."""
    found = []
    for event in events:
        changed = dict(event)
        if "frames" in event and event["do"] != "idle":
            changed["frames"] = max(1, event["frames"] // 2)
        elif len(path := event.get("path", ())) > 1:
            changed["path"] = [*path[1:-1:2], path[-1]]
        found.append(changed)
    return found


def compared(
    scene: Path, events: Sequence[Mapping[str, Any]], policy: str = "auto", overrides: Sequence[str] = ()
) -> Ends:
    """The ends of the ways by some events, a tenth of a second apart, in metres, and by them in half as many frames."""
    with tempfile.TemporaryDirectory(prefix="restshape-paths-") as folder:
        ways = [
            write_script(Path(folder), map(dict, one), f"{k}.jsonl") for k, one in enumerate((events, halved(events)))
        ]
        made = [make_run(scene, script, policy, overrides) for script in ways]
        return list(ends_of_edits(made, dict(enumerate(events, 2))))[-1]


def ends_of_edits(
    runs: Sequence[Run],
    events: Mapping[int, Mapping[str, Any]],
    count: Callable[[int], None] = lambda frames: None,
) -> Iterator[Ends]:
    """The ends of both ways after each edit of a script, as soon as they are known; without any, at its end.

    Args:
        runs: of both ways.
        events: of the script, by line.
        count: called with 1 after each frame.
    """
    edits = [line for line, event in events.items() if event["do"] not in RESTING] or [max(events, default=0)]
    first, second = (drapes(one, edits, count) for one in runs)
    # All of the first way, whose drapes are kept, so that each end of the second one is compared at once.
    for one, (line, other) in zip(list(first), second):
        yield between(one[1], other, line)


def drapes(run: Run, edits: Sequence[int], count: Callable[[int], None]) -> Iterator[tuple[int, Drape]]:
    """The drapes of a run at the ends of edits, which are lines of its script, with these."""
    last, frames, converged = None, 0, True
    for row in run.rows():
        count(1)
        if last is not None and row["line"] != last[0]:
            yield last
            last = None
        frames, converged = frames + 1, converged and bool(row["converged"]) and not row["refused"]
        if row["line"] in edits:
            analysis = run.replay.analysis
            x, problem = analysis.x.copy(), analysis.problem
            last = row["line"], Drape(frames, problem.energy(x), problem.corners(x), problem.size, converged)
    if last is not None:
        yield last


def between(first: Drape, second: Drape, line: int) -> Ends:
    """What two drapes are to each other."""
    known = first.places.shape == second.places.shape
    distance = float(np.abs(first.places - second.places).max()) if known else None
    frames, energies = (first.frames, second.frames), (first.energy, second.energy)
    return Ends(frames, energies, distance, first.size, (first.converged, second.converged), line)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_scene(parser)
    add_edits(parser, "edit script (.jsonl)")


def run(args: argparse.Namespace) -> int:
    """Replay the script as it is and in half as many frames, and say how each edit ends in both; 0."""
    from restshape.scene.edit_script import load_script

    scene = read_scene(args)
    if args.edits is None:
        raise UserError("a way needs edits", "--edits", "name a script: --edits FILE.jsonl")
    scripts = [load_script(args.edits, scene)]
    lines = args.edits.read_text(encoding="utf-8").splitlines()
    _, *numbers = [k for k, line in enumerate(lines) if line.strip()]
    events = {k + 1: json.loads(lines[k]) for k in numbers}
    # Lines stay where they are.
    for k, event in zip(numbers, halved(list(events.values()))):
        lines[k] = json.dumps(event)
    with tempfile.TemporaryDirectory(prefix="restshape-paths-") as folder:
        path = Path(folder) / "halved.jsonl"
        path.write_text("\n".join(lines), encoding="utf-8")
        scripts.append(load_script(path, scene))
        runs = [make_run(args.scene, script.path, overrides=args.set) for script in scripts]
        with progress(False, sum(script.frame_count for script in scripts)) as count:
            found = []
            for ends in ends_of_edits(runs, events, count):
                print(f"line {ends.line}: {ends.report()}", flush=True)
                found.append(ends)
    if len(found) > 1:
        print(f"{sum(one.same for one in found)} of {len(found)} edits end in the same drape")
    write_json(
        args, asdict(found[-1]) | {"same": found[-1].same, "edits": [asdict(one) | {"same": one.same} for one in found]}
    )
    return 0
