"""The sound of a plate that is struck, as a WAV file.

python -m restshape_apps.metallophone.sound SCENE --out FILE [--edits FILE] [--at X Y]
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from restshape_apps.metallophone.stage import add_scene, analysed

from restshape.analysis.modal import ModalAnalysis
from restshape.errors import UserError
from restshape.report.sound import struck, write_wav


def struck_node(analysis: ModalAnalysis, at: Sequence[float] | None) -> int:
    """The node of the plane mesh that is struck: the nearest to a place [m], or where mode 1 moves most inside."""
    X = analysis.space.X
    if at is not None:
        return int(np.argmin(np.linalg.norm(X - np.array(at), axis=1)))
    first = next(iter(analysis.fields()[0].values()))
    size = np.linalg.norm(first, axis=1)
    size[np.unique(analysis.space.facets)] = 0.0
    return int(np.argmax(size))


def main(words: Sequence[str] | None = None) -> int:
    """Write the sound; 0 on success, 2 on bad input."""
    parser = argparse.ArgumentParser(prog="python -m restshape_apps.metallophone.sound", description=__doc__)
    add_scene(parser)
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help="the sound (.wav)")
    parser.add_argument("--at", type=float, nargs=2, metavar=("X", "Y"), help="where it is struck [m]")
    parser.add_argument("--damping", type=float, default=1e-3, help="share of critical damping (default: %(default)s)")
    parser.add_argument("--seconds", type=float, default=2.0, help="how long (default: %(default)s)")
    args = parser.parse_args(words)
    try:
        if not (args.damping >= 0.0 and args.seconds > 0.0):
            raise UserError("damping is not negative, and time is positive", "--damping, --seconds", "leave them out")
        analysis = analysed(args)
        node = struck_node(analysis, args.at)
        shapes = analysis.state.body.shapes(analysis.state.modes.vectors[analysis.state.modes.chosen])[:, node]
        write_wav(args.out, struck(analysis.frequencies, np.linalg.norm(shapes, axis=1), args.damping, args.seconds))
    except UserError as error:
        print(f"sound: {error}", file=sys.stderr)
        return 2
    x, y = analysis.space.X[node]
    print(f"wrote {args.out}: struck at ({x:.4g}, {y:.4g}) m, {', '.join(f'{f:.1f}' for f in analysis.frequencies)} Hz")
    return 0


if __name__ == "__main__":
    sys.exit(main())
