"""A case through restshape and its peers: times of frames, memory, and how far answers are apart."""

from __future__ import annotations

import json
import os
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from restshape_studies.peers.cases import PeerCase
from restshape_studies.peers.installed import HERE, NO_PROGRAM, PROGRAMS, WAYS, Ended, python_of, run

from restshape.errors import UserError
from restshape.surroundings import cpu_model

MOST_SECONDS = 240.0
"""After which a process is ended."""
FIRST = 2
"""Number of the first frame that counts: of the two before it one makes everything, and one takes hold."""


def compare(case: PeerCase, peers: Sequence[str], folder: Path, frames: int, announce: Callable[[str], None]) -> dict:
    """What a case takes restshape, and each peer in both ways, of frames after the first two.

    Args:
        case: to play; peers: their names, all installed in `folder`; frames: that are timed; announce: of what is next.

    Returns:
        ``restshape`` and ``peers``, by peer and way: medians of frames [ms], of the clock and of the processor, the
        first frame, peak memory [MB], distance from restshape's answers; or why there is none.

    Raises:
        UserError: restshape's own replay does not come to its end.
    """
    with tempfile.TemporaryDirectory(prefix="restshape-peers-") as name:
        place = Path(name)
        announce(f"{case.name}: restshape")
        own = _played_here(case, frames, place)
        found: dict[str, Any] = {"title": case.title, "note": case.note, "load": os.getloadavg()[0]}
        found |= {"machine": cpu_model(), "restshape": own, "peers": {}}
        for peer in of_case(case, peers):
            found["peers"][peer] = {}
            for way in WAYS:
                announce(f"{case.name}: {peer}, {way}")
                found["peers"][peer][way] = _beside(case, own, _played_there(peer, way, folder, place), place)
    return found


def of_case(case: PeerCase, peers: Sequence[str]) -> list[str]:
    """Those of the peers that have a case's kind of physics."""
    return [peer for peer in peers if peer in case.peers]


def _played_here(case: PeerCase, frames: int, place: Path) -> dict[str, Any]:
    """Restshape's times, in a process as those of peers are."""
    command = [sys.executable, "-P", "-m", "restshape_studies.peers.played", case.name, str(frames), str(place)]
    ended = run(command, MOST_SECONDS)
    if ended.code:
        raise UserError(f"the replay ended with code {ended.code}: {ended.said}", case.name, "see restshape replay -vv")
    times = json.loads((place / "times.json").read_text())
    return _times(times, ended) | {key: times[key] for key in ("version", "elements", "unknowns", "levels")}


def play_command(peer: str, way: str, folder: Path, case: Path, answers: Path) -> list[str]:
    """The command that plays a case with a peer's program."""
    programs = HERE / PROGRAMS[peer]
    return [str(python_of(peer, folder)), *map(str, (HERE / "exchange" / "play.py", programs, way, case, answers))]


def _played_there(peer: str, way: str, folder: Path, place: Path) -> dict[str, Any]:
    """A peer's times; or why there are none."""
    for name in ("answers.npz", "times.json"):
        (place / name).unlink(missing_ok=True)
    ended = run(play_command(peer, way, folder, place, place), MOST_SECONDS)
    if ended.code == NO_PROGRAM:
        return {"cannot": ended.said}
    if ended.code:
        return {"failed": ended.said}
    times = json.loads((place / "times.json").read_text())
    return _times(times, ended) | {"version": times["version"], "short": times["short"]}


def _times(times: dict[str, Any], ended: Ended) -> dict[str, Any]:
    """Medians [ms] of the frames that count, the first frame and the peak of memory [MB]."""
    clock, used = times["seconds"], times["processor"]
    counted = slice(min(FIRST, len(used) - 1), None)
    found = {"processor_ms": 1e3 * median(used[counted]), "first_ms": 1e3 * used[0], "peak_mb": ended.peak_mb}
    return found | {"ms": 1e3 * median(clock[counted]) if clock else None, "frames": len(used[counted])}


def _beside(case: PeerCase, own: dict[str, Any], other: dict[str, Any], place: Path) -> dict[str, Any]:
    """A peer's times with the distance of its answers, and its time over restshape's.

    No time counts where answers differ, or are not as accurate as is asked for.
    """
    if "processor_ms" not in other:
        return other
    apart = distance(place / "restshape.npz", place / "answers.npz", case.parameters.get("initial", 0.0))
    if other["short"]:
        return {"failed": f"{other['short']}; its answers differ by {apart:.1e}", "version": other["version"]}
    if not apart <= case.tolerance:
        return {"failed": f"its answers differ by {apart:.1e}, which is more than {case.tolerance:g}"}
    return other | {"distance": apart, "ratio": other["processor_ms"] / own["processor_ms"]}


def distance(ours: Path, theirs: Path, origin: float) -> float:
    """The largest distance of the answers of a frame, relative to restshape's less their origin."""
    apart = [0.0]
    with np.load(ours) as one, np.load(theirs) as other:
        for key in one.files:
            size = float(np.linalg.norm(one[key] - origin))
            if size:
                apart.append(float(np.linalg.norm(other[key] - one[key])) / size)
    return float("nan") if np.isnan(apart).any() else max(apart)


def start_times(case: PeerCase, peers: Sequence[str], folder: Path, repeat: int, announce: Callable) -> dict[str, Any]:
    """From the start of a process to the first answer, [s] of the clock and of the processor, and its memory [MB].

    Peers begin with the mesh as arrays, and restshape with the scene, of which it makes the mesh. Peers that compile
    their forms are started once more, with nothing compiled before.
    """
    with tempfile.TemporaryDirectory(prefix="restshape-peers-") as name:
        place = Path(name)
        _played_here(case, 0, place)
        command = [sys.executable, "-P", "-m", "restshape_studies.peers.played", case.name, "0", str(place)]
        announce(f"start: restshape, {repeat} times")
        found: dict[str, Any] = {"restshape": _started([run(command, MOST_SECONDS) for _ in range(repeat)])}
        for peer in of_case(case, peers):
            announce(f"start: {peer}, {repeat} times")
            command = play_command(peer, WAYS[0], folder, place, place)
            run(command, MOST_SECONDS)
            found[peer] = _started([run(command, MOST_SECONDS) for _ in range(repeat)])
            if peer == "dolfinx":
                empty = str(place / "cache")
                found[f"{peer}, nothing compiled"] = _started([run(command, MOST_SECONDS, RESTSHAPE_PEER_CACHE=empty)])
    return found


def _started(runs: Sequence[Ended]) -> dict[str, Any]:
    bad = next((one for one in runs if one.code), None)
    if bad:
        return {"failed": bad.said}
    return {key: median(getattr(one, key) for one in runs) for key in ("seconds", "processor", "peak_mb")}
