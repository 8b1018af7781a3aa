"""Columns that lie along x, solved, for tests of buckling."""

from functools import partial
from pathlib import Path

import numpy as np
from restshape_studies.stability import columns
from small_scenes import make_replay, write_scene

from restshape.analysis.buckling.buckling import BucklingAnalysis
from restshape.analysis.frame import Frame

FOOT, HINGES, PUSHED = columns.FOOT, columns.HINGES, columns.PUSHED
TWINS = columns.twins("plane")
column, euler = partial(columns.column, "plane"), columns.euler


def solved(folder: Path, text: str, *overrides: str, policy: str = "auto") -> BucklingAnalysis:
    """The first frame of a scene."""
    replay = make_replay(write_scene(folder, text), name=policy, overrides=overrides)
    next(replay.frames())
    return replay.analysis


class Column:
    """A scene solved as its nodes lie; `move` lays them somewhere else."""

    def __init__(self, folder: Path, text: str) -> None:
        self.replay = make_replay(write_scene(folder, text))
        next(self.replay.frames())
        self.analysis = self.replay.analysis
        self.X, self.load_factors = self.analysis.space.X.copy(), self.analysis.load_factors.copy()

    def move(self, dX: np.ndarray) -> np.ndarray:
        """The load factors of the design whose nodes are dX (n, 2) [m] from where they were."""
        mesh = self.analysis.space
        mesh.X[...] = self.X + dX
        self.replay.moving.mesh.geometry += 1
        none = np.empty(0, dtype=np.int32)
        self.analysis.solve(Frame(mesh, none, None, self.replay.session.scene, (None, (0.0, 0.0))))
        return self.analysis.load_factors.copy()
