"""What errors of quantities cost, by processor time in one process: `python -m` with a scene, a script and names."""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

import numpy as np
from restshape_studies.stability.scenery import make_run

from restshape.algebra.stages import Stages
from restshape.analysis.analysis import Context
from restshape.analysis.frame import Frame
from restshape.analysis.made_analysis import made_analysis
from restshape.analysis.static import enriched_solution, quantity_errors
from restshape.analysis.static.quantity_errors import SteadyQuantityErrors
from restshape.application import application
from restshape.replay.loop import Replay

EVERY = 10
"""Frames from one solve with nothing kept to the next."""


def cold_seconds(replay: Replay) -> float:
    """Processor time of the frame's solve with new pattern, matrix and factor, on its mesh."""
    scene, app = replay.session.scene, application(replay.session.scene.app)
    context = Context(replay.comm, replay.policy, replay.analysis.context.calibration, Stages())
    analysis = made_analysis(scene, app, context)
    begin = process_time()
    analysis.solve(Frame(replay.moving.field_mesh, np.empty(0, dtype=np.int32), None, scene, (None, (0.0, 0.0))))
    return process_time() - begin


def measured(scene: Path, edits: Path, names: Sequence[str], given: Sequence[str]) -> dict[str, float]:
    """Medians over the frames of level 1: milliseconds of a `frame`, a `cold` solve, and of each quantity's error.

    `NAME products` is how often a matrix was multiplied for its dual solution, or for that on the richer space.
    """
    run = make_run(scene, edits, overrides=given, measured="residual")
    replay = run.replay
    products = [0]
    steps = quantity_errors.conjugate_steps

    def counted(product: Callable[[np.ndarray], np.ndarray], *rest: Any) -> Any:
        def multiply(vector: np.ndarray) -> np.ndarray:
            products[0] += 1
            return product(vector)

        return steps(multiply, *rest)

    # One for each, as nothing is shared when one alone is asked for.
    estimates: dict[str, SteadyQuantityErrors] = {}
    found: dict[str, list[float]] = {"frame": [], "cold": []}
    for module in (quantity_errors, enriched_solution):
        module.conjugate_steps = counted
    try:
        frames = run.rows()
        while True:
            begin = process_time()
            row = next(frames, None)
            frame = process_time() - begin
            if row is None:
                break
            if row["level"] != 1 or row["refused"]:
                continue
            found["frame"].append(1e3 * frame)
            for name in names:
                estimate = estimates.setdefault(name, SteadyQuantityErrors(replay.analysis))
                before, begin = products[0], process_time()
                estimate([name])
                found.setdefault(name, []).append(1e3 * (process_time() - begin))
                found.setdefault(f"{name} products", []).append(products[0] - before)
            if len(found["frame"]) % EVERY == 0:
                found["cold"].append(1e3 * cold_seconds(replay))
    finally:
        for module in (quantity_errors, enriched_solution):
            module.conjugate_steps = steps
    return {key: median(values) for key, values in found.items() if values}


if __name__ == "__main__":
    of, by, asked, *settings = sys.argv[1:]
    for key, value in measured(Path(of), Path(by), asked.split(","), settings).items():
        print(f"{key}: {value:.3g}")
