"""A picture of the modes in which a solid buckles, each with its load factor.

python -m restshape_apps.solid.picture SCENE [--set key=value] --out FILE
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from restshape.analysis.buckling import BucklingAnalysis
from restshape.cli.options import refuse_overwriting
from restshape.errors import UserError
from restshape.outputs.kinds import PictureFile
from restshape.replay.first_frame import first_frame
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


def main(words: Sequence[str] | None = None) -> int:
    """Draw; 0 on success, 2 on bad input."""
    parser = argparse.ArgumentParser(prog="python -m restshape_apps.solid.picture", description=__doc__)
    parser.add_argument("scene", metavar="SCENE", type=Path, help="scene file (.toml) with [effects.buckling]")
    parser.add_argument("--set", metavar="KEY=VALUE", action="append", default=[], help="changes a value of the scene")
    parser.add_argument("--out", metavar="FILE", type=PictureFile, required=True, help="the picture (.png)")
    args = parser.parse_args(words)
    try:
        refuse_overwriting(args)
        analysis = first_frame(args.scene, args.set).analysis
        if not isinstance(analysis, BucklingAnalysis):
            raise UserError("the scene does not ask for buckling", str(args.scene), "add [effects.buckling]")
        draw(analysis, args.out)
    except UserError as error:
        print(f"picture: {error}", file=sys.stderr)
        return 2
    print(f"wrote {args.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
