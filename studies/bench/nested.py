"""Frames of a drag of cloth on nested meshes: how many a second from the coarse one, and from the fine one alone."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from math import isnan
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any, cast

from restshape.interface.run import Run
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

if TYPE_CHECKING:
    from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis

BARE, ALL = ("solve.estimate=none",), ("solve.estimate=every",)
ALONE = ("predict.frame_time=0",)
WAYS = {
    "coarse, shown on the fine": (),
    "the same, nothing estimated": BARE,
    "coarse, without steps": ALONE,
    "the same without steps, nothing estimated": (*ALONE, *BARE),
    "the same without steps, each frame estimated": (*ALONE, *ALL),
    "the fine alone": ("predict.levels=1",),
}
"""What a drag is predicted on, with solver steps in the time of a frame and without.

With the estimates that there are by default, without, and with all, residuals and strains included.
"""


def nested_drags(
    scene: Path, bending: str, size: float, frames: int, folder: Path, announce: Callable[[str], None], levels: int = 2
) -> dict[str, Any]:
    """Seconds of the processor of the frames of one drag, by the mesh that is predicted.

    Args:
        scene: of cloth with an edge named `right`, of 0.5 m.
        bending: of `effects.cloth.bending`.
        size: of the fine mesh [m].
        frames: of the drag, which goes by a tenth of the pattern.
        folder: for the script.
        announce: called with what comes next.
        levels: of nested meshes; each has four times the triangles of the one before.
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
        f"mesh.levels={levels}",
        f"effects.drape.levels={levels}",
        f"predict.levels={levels}",
        "effects.contact.self=false",
    )
    for way, own in WAYS.items():
        announce(f"{bending}, {way}")
        found[way] = _played(scene, script, (*words, *own))
    return found


def _played(path: Path, edits: Path, words: tuple[str, ...]) -> dict[str, Any]:
    """Times of the predicted frames of a drag, estimates included, idle work not; positions are read in each."""
    scene = load_scene(path, words)
    script = load_script(edits, scene)
    request = Request.of(scene, script, "auto", predict="gmls", overrides=words)
    run = Run(request, summed=False)
    analysis = cast("RelaxationAnalysis", run.replay.analysis)
    rows, times, idle, begun = [], [], [], time.process_time()
    for row in run.rows():
        _ = analysis.x
        now = time.process_time()
        rows.append(row)
        idle.append(run.replay.solver.idle_seconds)
        times.append(now - begun - idle[-1])
        begun = time.process_time()
    shown = [k for k, row in enumerate(rows) if row["event"] == "drag" and row["predicted"]]
    press = next(k for k, row in enumerate(rows) if row["event"] == "press")
    return {
        "nodes": len(analysis.problem.mesh.X),
        "coarse": len(analysis.problem.mesh.hierarchy.meshes[0].X),
        "elements": int(rows[0]["elements"]),
        "unknowns": int(rows[0]["unknowns"]),
        "first": times[0],
        "press": times[press],
        "frames": len(shown),
        "median": median(times[k] for k in shown) if shown else None,
        "mean": sum(times[k] for k in shown) / len(shown) if shown else None,
        "idle": max(idle),
        "worst": max((times[k] for k in shown), default=None),
        "steps": median(int(rows[k]["solver_steps"]) for k in shown) if shown else None,
        "estimate": max((one for k in shown if not isnan(one := float(rows[k]["estimate"]))), default=None),
    }
