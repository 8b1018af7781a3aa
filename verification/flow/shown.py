"""Flows that are looked at: in the first frame of a scene, or through a script from an exact one on."""

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from petsc4py import PETSc
from restshape_studies.stability.scenery import make_replay, write_scene, write_script

from restshape.fem.space import Space
from restshape.replay.first_frame import first_frame
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
        made, found = make_replay(write_scene(Path(folder), text), write_script(Path(folder), events)), []
        for row in made.frames():
            analysis = made.analysis
            if row["index"] == 0:
                analysis.begin(exact(analysis.space.X, 0.0))
            found.append(measure(analysis.space, analysis.x - exact(analysis.space.X, analysis.time)))
    return found
