"""`restshape shadow`: the outline of a recorded drape seen from above, as a drawing."""

import argparse
from pathlib import Path

from restshape.cli.options import add_json, write_json
from restshape.errors import UserError, one_line
from restshape.outputs.kinds import ExportFile
from restshape.scene.units import UnitError, quantity

EVERY = 4
"""Of the directions of a shadow, those that are written."""
LARGEST_NOISE = 0.05
"""[m]"""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("recording", metavar="RECORDING", type=Path, help="recording (.vtkhdf) that replay --out wrote")
    parser.add_argument(
        "--frame", metavar="N", type=int, default=-1, help="from 0, or from -1 backwards (default: last)"
    )
    parser.add_argument("--out", metavar="FILE", type=ExportFile, required=True, help="the drawing (.svg)")
    parser.add_argument(
        "--noise", metavar="LENGTH", help="move each point at random along x and y, by this standard deviation"
    )
    parser.add_argument("--seed", metavar="N", type=int, default=0, help="of the noise (default: 0)")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Write the drawing, and print what it shows; 0."""
    if args.out.suffix.lower() != ".svg":
        raise UserError(f"{one_line(args.out.name)} is no .svg file", "--out", "--out drape.svg")
    noise = _noise(args.noise) if args.noise else 0.0
    if args.seed < 0:
        raise UserError(f"a seed is not negative: {args.seed}", "--seed", "--seed 0")
    import numpy as np
    from restshape_apps.couture.fitting.recorded_shadow import recorded_shadow
    from restshape_apps.couture.fitting.shadow_drawing import write_shadow

    shadow = recorded_shadow(args.recording, args.frame)
    points = shadow.edge.points()[::EVERY]
    if noise:
        points = points + np.random.default_rng(args.seed).normal(0.0, noise, points.shape)
    try:
        write_shadow(points, args.out)
    except OSError as error:
        raise UserError(f"cannot be written: {error.strerror}", f"--out {args.out}", "name another file") from error
    print(f"wrote {one_line(args.out)}: frame {shadow.row} of {shadow.count}")
    print(f"area {1e4 * shadow.area:.5g} cm^2, {shadow.folds} folds, noise {1e3 * noise:g} mm")
    found = {"file": str(args.out), "frame": shadow.row, "area": shadow.area, "folds": shadow.folds, "noise": noise}
    write_json(args, found)
    return 0


def _noise(text: str) -> float:
    try:
        found = quantity(text, "length")
    except UnitError as error:
        raise UserError(error.what, "--noise", error.do) from error
    if not 0.0 <= found <= LARGEST_NOISE:
        raise UserError(f"noise of {text!r} makes no sense", "--noise", "write one such as 1mm, up to 50 mm")
    return found
