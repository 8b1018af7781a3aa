"""By how much quantities jump where flips or new meshes change the mesh, in the replay of a script."""

from collections.abc import Sequence
from math import isfinite, nan
from pathlib import Path
from typing import Any

import numpy as np
from restshape_studies.stability.scenery import make_run

from restshape.replay.columns import jump_column
from restshape.replay.rounding import ROUNDING, largest, scales

MOST = 0.005
"""A share of the largest size of a quantity, above which a jump is large."""


def study(scene: Path, edits: Path, given: Sequence[str]) -> dict[str, Any]:
    """The largest jump of each quantity by level, and how many frames could not be compared.

    Args:
        scene, edits: files.
        given: ``key=value`` as after --set.

    Raises:
        UserError: the scene cannot be replayed, or has no jumps.
    """
    run = make_run(scene, edits, overrides=(*given, "solve.jumps=true"))
    replay = run.replay
    quantities = replay.session.scene.quantities
    jumps: dict[str, dict[str, Any]] = {name: {} for name in quantities}
    frames = {"2": 0, "3": 0, "without": 0}
    values: dict[str, list[float]] = {name: [] for name in quantities}
    for row in run.rows():
        for name, known in values.items():
            known.append(row.get(f"q_{name}", nan))
        level = str(row["level"])
        if level not in ("2", "3") or not row["index"] or row["refused"]:
            continue
        frames[level] += 1
        compared = False
        for name, known in jumps.items():
            # Frames that are not analysed have none.
            jump = abs(row.get(jump_column(name), nan))
            if not isfinite(jump):
                continue
            compared = True
            if jump > known.get(level, {}).get("jump", -1.0):
                known[level] = {"jump": jump, "frame": row["index"]}
        frames["without"] += not compared
    series = {name: np.array(known) for name, known in values.items()}
    sizes = scales(series, {name: one.unit for name, one in quantities.items()})
    for name, known in jumps.items():
        size = largest(series[name])
        for one in known.values():
            one["share"] = one["jump"] / size if size > ROUNDING * sizes[name] else 0.0
    return {"frames": frames, "jumps": jumps, "singular": sorted(replay.errors.singular.ever)}
