"""`restshape sound`: the sound of a plate that is struck."""

import argparse

from restshape_apps.metallophone.stage import add_frame, analysed

from restshape.cli.options import add_json, write_json
from restshape.errors import UserError, one_line
from restshape.outputs.kinds import SoundFile


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_frame(parser)
    parser.add_argument("--out", type=SoundFile, required=True, metavar="FILE", help="the sound (.wav)")
    parser.add_argument("--at", type=float, nargs=2, metavar=("X", "Y"), help="where it is struck [m]")
    parser.add_argument("--damping", type=float, default=1e-3, help="share of critical damping (default: %(default)s)")
    parser.add_argument("--seconds", type=float, default=2.0, help="how long (default: %(default)s)")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Write the sound; 0."""
    if not (args.damping >= 0.0 and args.seconds > 0.0):
        raise UserError("damping is not negative, and time is positive", "--damping, --seconds", "leave them out")
    analysis = analysed(args)
    import numpy as np
    from restshape_apps.metallophone.sound import struck, struck_node, write_wav

    node = struck_node(analysis, args.at)
    shapes = analysis.state.body.shapes(analysis.state.modes.vectors[analysis.state.modes.chosen])[:, node]
    write_wav(args.out, struck(analysis.frequencies, np.linalg.norm(shapes, axis=1), args.damping, args.seconds))
    x, y = analysis.space.X[node]
    tones = ", ".join(f"{f:.1f}" for f in analysis.frequencies)
    sizes = np.linalg.norm(shapes, axis=1).tolist()
    write_json(args, {"at": [float(x), float(y)], "frequencies": analysis.frequencies.tolist(), "deflections": sizes})
    print(f"wrote {one_line(args.out)}: struck at ({x:.4g}, {y:.4g}) m, {tones} Hz")
    return 0
