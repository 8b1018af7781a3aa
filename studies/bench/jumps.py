"""By how much quantities jump where flips or new meshes change the mesh, in the replay of a script."""

from collections.abc import Sequence
from math import inf, isfinite, nan
from pathlib import Path
from typing import Any

import numpy as np
from restshape_studies.stability.scenery import make_replay

from restshape.replay.columns import jump_column, jump_scale

MOST = 0.005
"""A share of a value, or in time of its largest size so far, above which a jump is large."""


def study(scene: Path, edits: Path, given: Sequence[str]) -> dict[str, Any]:
    """The largest jump of each quantity by level, and how many frames could not be compared.

    Args:
        scene, edits: files.
        given: ``key=value`` as after --set.

    Raises:
        UserError: the scene cannot be replayed, or has no jumps.
    """
    replay = make_replay(scene, edits, overrides=(*given, "solve.jumps=true"))
    quantities = replay.session.scene.quantities
    largest: dict[str, dict[str, Any]] = {name: {} for name in quantities}
    frames = {"2": 0, "3": 0, "without": 0}
    values: dict[str, list[float]] = {name: [] for name in quantities}
    for row in replay.frames():
        for name, known in values.items():
            known.append(row.get(f"q_{name}", nan))
        level = str(row["level"])
        if level not in ("2", "3") or not row["index"] or row["refused"]:
            continue
        frames[level] += 1
        compared = False
        for name, known in largest.items():
            # Frames that are not analysed have none.
            jump = abs(row.get(jump_column(name), nan))
            value = float(jump_scale(np.array(values[name]), "time" in row)[-1])
            if not isfinite(jump):
                continue
            compared = True
            share = jump / value if value > 0.0 else inf if jump > 0.0 else 0.0
            if share > known.get(level, {}).get("share", -1.0):
                known[level] = {"share": share, "jump": jump, "frame": row["index"]}
        frames["without"] += not compared
    return {"frames": frames, "jumps": largest, "singular": sorted(replay.singular)}
