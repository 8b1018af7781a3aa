"""`restshape drapes`: a picture of single frames of a recording of cloth."""

import argparse
from pathlib import Path

from restshape.errors import UserError, one_line
from restshape.outputs.kinds import PictureFile


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("recording", metavar="RECORDING", type=Path, help="recording (.vtkhdf) that replay --out wrote")
    parser.add_argument("--frames", metavar="N", type=int, nargs="+", default=[0, -1], help="default: first and last")
    parser.add_argument("--out", metavar="FILE", type=PictureFile, required=True, help="the picture (.png)")


def run(args: argparse.Namespace) -> int:
    """Draw; 0."""
    from restshape_apps.couture.picture import draw

    from restshape.replay.recording import Recording

    try:
        with Recording(args.recording) as recording:
            draw(recording, args.frames, args.out)
    except OSError as error:
        raise UserError(f"cannot be written: {error.strerror}", f"--out {args.out}", "name another file") from error
    print(f"wrote {one_line(args.out)}")
    return 0
