"""A picture of the modes in which a solid buckles, each with its load factor."""

from pathlib import Path

import numpy as np

from restshape.analysis.buckling.buckling import BucklingAnalysis
from restshape.errors import UserError
from restshape.report.modes import draw_modes

SHOWN = 0.15
"""The largest displacement, as a part of the body's size."""


def draw(analysis: BucklingAnalysis, path: Path) -> None:
    """Draw the modes that the scene asks for on the body bent by them.

    Raises:
        UserError: there are none.
    """
    count = len(analysis.load_factors)
    if not count:
        raise UserError(
            "nothing buckles: there is no mode to draw", str(analysis.state.prebuckling.scene.path), "change the load"
        )
    mesh = analysis.space
    shapes = np.zeros((count, len(mesh.X), 3))
    shapes[:, :, :2] = analysis.state.modes.vectors.reshape(count, -1, 2)
    shapes /= np.linalg.norm(shapes, axis=2).max(axis=1)[:, None, None]
    names = [f"load factor {factor:.4g}" for factor in analysis.load_factors]
    size = SHOWN * float(np.ptp(mesh.X, axis=0).max())
    draw_modes(path, mesh.X, mesh.cells, shapes, names, analysis.state.prebuckling.scene.title, size)
