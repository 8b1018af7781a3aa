"""The way to a drape: whether the same edits in half as many frames end in the same one.

Where the energy has one minimum near, they do. Where friction remembers the way, or cloth folds to either side, there
are two rests, which are reported with their energies.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from restshape_studies.stability.scenery import make_replay, rows_of, write_script

from restshape.cli.options import add_scene, read_scene, write_json
from restshape.cli.parser import add_edits
from restshape.errors import UserError
from restshape.outputs.si_numbers import si

SAME = 1e-3
"""Distance over the size of the cloth up to which two drapes are the same: ten times the tolerance of forces."""


@dataclass(frozen=True)
class Ends:
    """The ends of two ways.

    Args:
        frames: of both.
        energies: [J] there.
        distance: largest one of a node [m]; nothing where the meshes are not the same.
        size: of the cloth [m].
        converged: whether all frames have, of both.
    """

    frames: tuple[int, int]
    energies: tuple[float, float]
    distance: float | None
    size: float
    converged: tuple[bool, bool]

    @property
    def same(self) -> bool:
        """Whether both are the same drape."""
        return self.distance is not None and self.distance <= SAME * self.size

    def report(self) -> str:
        """What there is to say, in one line."""
        apart = "on different meshes" if self.distance is None else f"{si(self.distance, 'm', 3)} apart"
        first, second = (si(energy, "J", 6) for energy in self.energies)
        ways = f"in {self.frames[0]} and in {self.frames[1]} frames"
        if self.same:
            return f"the same drape {ways}: {apart}, energies {first} and {second}"
        return f"two rests {ways}: {apart}, energies {first} and {second}"


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
    """The ends of the ways by some events, a tenth of a second apart, and by them in half as many frames."""
    found = []
    with tempfile.TemporaryDirectory(prefix="restshape-paths-") as folder:
        for k, one in enumerate((events, halved(events))):
            script = write_script(Path(folder), [dict(event) for event in one], f"{k}.jsonl")
            made = make_replay(scene, script, policy, overrides)
            rows = rows_of(made)
            analysis = made.analysis
            x = analysis.problem.corners(analysis.x)
            converged = all(row["converged"] and not row["refused"] for row in rows)
            found.append((len(rows), analysis.problem.energy(analysis.x), x, analysis.problem.size, converged))
    frames, energies, places, sizes, converged = zip(*found)
    known = places[0].shape == places[1].shape
    distance = float(np.abs(places[0] - places[1]).max()) if known else None
    return Ends(frames, energies, distance, sizes[0], converged)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_scene(parser)
    add_edits(parser, "edit script (.jsonl)")


def run(args: argparse.Namespace) -> int:
    """Replay the script as it is and in half as many frames, and say how both end; 0."""
    from restshape.scene.edit_script import load_script

    scene = read_scene(args)
    if args.edits is None:
        raise UserError("a way needs edits", "--edits", "name a script: --edits FILE.jsonl")
    load_script(args.edits, scene)
    lines = [json.loads(line) for line in args.edits.read_text(encoding="utf-8").splitlines() if line.strip()]
    events = [{key: value for key, value in line.items() if key != "t"} for line in lines[1:]]
    found = compared(args.scene, events, overrides=args.set)
    print(found.report())
    write_json(args, asdict(found) | {"same": found.same})
    return 0
