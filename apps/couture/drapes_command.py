"""`restshape drapes`: a picture of single frames of a recording of cloth."""

import argparse
from pathlib import Path

from restshape.errors import UserError, one_line
from restshape.outputs.kinds import PictureFile

SHOWN = ("tension", "strain", "pattern")
WIDTHS = 400, 10_000
"""Least and largest width [pixels]."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("recording", metavar="RECORDING", type=Path, help="recording (.vtkhdf) that replay --out wrote")
    parser.add_argument("--frames", metavar="N", type=int, nargs="+", default=[0, -1], help="default: first and last")
    parser.add_argument(
        "--show",
        choices=SHOWN,
        default="tension",
        help="tension of all frames (default), or of the last one strain, or seams, on the pattern beside the drape",
    )
    parser.add_argument("--width", metavar="N", type=int, help="pixels of a picture beside the pattern (default 2000)")
    parser.add_argument("--out", metavar="FILE", type=PictureFile, required=True, help="the picture (.png)")


def run(args: argparse.Namespace) -> int:
    """Draw; 0."""
    if args.width is not None and (args.show == "tension" or not WIDTHS[0] <= args.width <= WIDTHS[1]):
        what = f"the width is that of --show strain or pattern, {WIDTHS[0]} to {WIDTHS[1]} pixels"
        raise UserError(what, f"--width {args.width}", "--show strain --width 2000")
    from restshape_apps.couture.picture import draw, draw_beside_pattern

    from restshape.replay.recording.recording import Recording

    try:
        with Recording(args.recording) as recording:
            if args.show == "tension":
                draw(recording, args.frames, args.out)
            else:
                draw_beside_pattern(recording, args.frames[-1], args.show, args.width, args.out)
    except OSError as error:
        raise UserError(f"cannot be written: {error.strerror}", f"--out {args.out}", "name another file") from error
    print(f"wrote {one_line(args.out)}")
    return 0
