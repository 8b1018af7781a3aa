"""Frames of drags of cloth: seconds of the processor, steps and factors, with contact with itself and without."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from restshape.interface.run import Run
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

WAYS = {"on": "true", "off": "false"}
"""Contact of cloth with itself."""


def drag_times(
    name: str, text: str, edits: Sequence[Mapping[str, Any]], folder: Path, announce: Callable[[str], None]
) -> dict[str, Any]:
    """The record of a scene, with contact of the cloth with itself and without.

    Args:
        name: of the scene; text: of its file.
        edits: of a script, without times.
        folder: where both are written.
        announce: called with what comes next.
    """
    scene, script = folder / "scene.toml", folder / "edits.jsonl"
    scene.write_text(text)
    head = {"format": "restshape-edits", "version": 1, "scene": scene.name, "units": "m"}
    timed = [{"t": 0.1 * (k + 1), **edit} for k, edit in enumerate(edits)]
    script.write_text("\n".join(json.dumps(line) for line in (head, *timed)))
    found = {}
    for way, value in WAYS.items():
        announce(f"{name}, contact with itself {way}")
        found[way] = _played(scene, script, f"effects.contact.self={value}")
    return found


def _played(path: Path, edits: Path, override: str) -> dict[str, Any]:
    """Times and work of the frames of a script, the first one apart; those that solve nothing are left out."""
    scene = load_scene(path, (override,))
    script = load_script(edits, scene)
    request = Request.of(scene, script, "auto")
    rows, times, begun = [], [], time.process_time()
    for row in Run(request, summed=False).rows():
        now = time.process_time()
        rows.append(row)
        times.append(now - begun)
        begun = time.process_time()
    solved = [k for k, row in enumerate(rows) if k and not row["refused"] and row["ms_values"]]
    seconds = [times[k] for k in solved]
    return {
        "elements": int(rows[0]["elements"]),
        "unknowns": int(rows[0]["unknowns"]),
        "first": times[0],
        "frames": len(solved),
        "median": median(seconds) if seconds else None,
        "worst": max(seconds, default=None),
        "steps": median(int(rows[k]["relaxation_steps"]) for k in solved) if solved else None,
        "factors": median(int(rows[k]["factorisations"]) for k in solved) if solved else None,
        "newton": sum(rows[k]["relaxation_steps"] == rows[k]["newton"] for k in solved),
        "jumps": sum("jumped" in rows[k]["note"] for k in solved),
        "at_rest": sum(rows[k]["converged"] and rows[k]["tangent_positive_definite"] == 1 for k in solved),
    }
