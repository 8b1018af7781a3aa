"""`restshape modes`: pictures of the modes of a plate, and of where rasping its edge moves a tone."""

import argparse

from restshape_apps.metallophone.stage import add_frame, analysed

from restshape.errors import UserError, one_line
from restshape.outputs.kinds import PictureFile


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_frame(parser)
    parser.add_argument("--out", type=PictureFile, metavar="FILE", help="modes and nodal lines (.png)")
    parser.add_argument(
        "--rasp", type=PictureFile, metavar="FILE", help="what rasping the outline does to the first tone (.png)"
    )


def run(args: argparse.Namespace) -> int:
    """Draw what is asked for; 0."""
    if not (args.out or args.rasp):
        raise UserError("no picture is asked for", "--out", "--out modes.png, or --rasp rasp.png")
    analysis = analysed(args)
    from restshape_apps.metallophone.picture import draw, draw_rasp

    for path, drawn in ((args.out, draw), (args.rasp, draw_rasp)):
        if path:
            drawn(analysis, path)
            print(f"wrote {one_line(path)}")
    return 0
