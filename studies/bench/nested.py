"""Frames of a drag of cloth on nested meshes: how many a second from the coarse one, and from the fine one alone."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

from petsc4py import PETSc

from restshape.application import application_of
from restshape.calibration import Calibration
from restshape.policy import policy
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

WAYS = {
    "coarse, shown on the fine": ("predict.levels=2",),
    "coarse, without steps": ("predict.levels=2", "predict.frame_time=0"),
    "the fine alone": ("predict.levels=1",),
}
"""What a drag is predicted on, with solver steps in the time of a frame and without."""


def nested_drags(
    scene: Path, bending: str, size: float, frames: int, folder: Path, announce: Callable[[str], None]
) -> dict[str, Any]:
    """Seconds of the processor of the frames of one drag, by the mesh that is predicted.

    Args:
        scene: of cloth with an edge named `right`, of 0.5 m.
        bending: of `effects.cloth.bending`.
        size: of the fine mesh [m].
        frames: of the drag, which goes by a tenth of the pattern.
        folder: for the script.
        announce: called with what comes next.
    """
    script, found = folder / "edits.jsonl", {}
    lines = [
        {"format": "restshape-edits", "version": 1, "units": "m"},
        {"t": 0.1, "do": "press", "on": "right", "at": [0.5, 0.1]},
        {"t": 0.2, "do": "drag", "to": [0.55, 0.1], "frames": frames},
    ]
    script.write_text("\n".join(map(json.dumps, lines)))
    words = (
        f"effects.cloth.bending={bending}",
        f"mesh.size={size}",
        "mesh.levels=2",
        "effects.drape.levels=2",
        "effects.contact.self=false",
    )
    for way, own in WAYS.items():
        announce(f"{bending}, {way}")
        found[way] = _played(scene, script, (*words, *own))
    return found


def _played(path: Path, edits: Path, words: tuple[str, ...]) -> dict[str, Any]:
    """Times of the predicted frames of a drag, estimates and residuals included."""
    scene = load_scene(path, words)
    script = load_script(edits, scene)
    request = Request(
        scene, script, application_of(scene), policy("auto"), Calibration.load(), predict="gmls", overrides=words
    )
    replay = Replay(request, PETSc.COMM_SELF)
    rows, times, begun = [], [], time.process_time()
    for row in replay.frames():
        now = time.process_time()
        rows.append(row)
        times.append(now - begun)
        begun = time.process_time()
    shown = [k for k, row in enumerate(rows) if row["event"] == "drag" and row["predicted"]]
    press = next(k for k, row in enumerate(rows) if row["event"] == "press")
    return {
        "elements": int(rows[0]["elements"]),
        "unknowns": int(rows[0]["unknowns"]),
        "first": times[0],
        "press": times[press],
        "frames": len(shown),
        "median": median(times[k] for k in shown) if shown else None,
        "steps": median(int(rows[k]["solver_steps"]) for k in shown) if shown else None,
        "estimate": max((float(rows[k]["estimate"]) for k in shown), default=None),
    }
