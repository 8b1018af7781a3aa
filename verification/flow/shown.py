"""Flows that are looked at: in the first frame of a scene, or through a script from an exact one on."""

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from petsc4py import PETSc
from restshape_studies.stability.scenery import make_run, write_scene, write_script

from restshape.analysis.analysis import Analysis
from restshape.analysis.frame import Frame
from restshape.fem.space import Space
from restshape.interface.first_frame import first_frame
from restshape.replay.loop import Replay


def shown(text: str, comm: PETSc.Comm) -> Replay:
    """The replay of a scene's first shape."""
    with TemporaryDirectory() as folder:
        return first_frame(write_scene(Path(folder), text), [], comm)


def largest(space: Space, off: np.ndarray) -> float:
    """The largest error of the velocity among nodal errors (n, 3) of all unknowns [m/s]."""
    return float(np.abs(off[:, :2]).max())


def played(
    text: str,
    events: list[dict[str, Any]],
    exact: Callable[[np.ndarray, float], np.ndarray],
    measure: Callable[[Space, np.ndarray], float] = largest,
) -> list[float]:
    """The error in each frame of a script that begins with the exact flow.

    Args:
        text: of a scene of flow in time.
        events: of the script.
        exact: places (n, 2) and a time [s] to unknowns (n, 3).
        measure: of nodal errors (n, 3) on a space.
    """
    with TemporaryDirectory() as folder:
        run, found = make_run(write_scene(Path(folder), text), write_script(Path(folder), events)), []
        for row in run.rows():
            analysis = run.replay.analysis
            if row["index"] == 0:
                analysis.begin(exact(analysis.space.X, 0.0))
            found.append(measure(analysis.space, analysis.x - exact(analysis.space.X, analysis.time)))
    return found


def swing(analysis: Analysis, steps: int, way: float) -> None:
    """Steps of a flow in the unit square, in which nodes inside go to and fro by a way [m], and end where they were."""
    space, scene = analysis.space, analysis.state.scene
    X = space.X.copy()
    bump = np.sin(np.pi * X[:, :1]) * np.sin(np.pi * X[:, 1:])
    for k in range(steps):
        if way:
            space.X[:] = X + way * np.sin(2 * np.pi * (k + 1) / steps) * bump
            space.geometry += 1
        analysis.solve(Frame(space, np.empty(0, np.int32), None, scene, (None, (0.0, 0.0))))
