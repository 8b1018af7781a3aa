"""`restshape buckling`: the modes in which a solid buckles."""

import argparse
from pathlib import Path

from restshape.cli.options import add_json, add_set, write_json
from restshape.errors import UserError, one_line
from restshape.outputs.kinds import PictureFile


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("scene", metavar="SCENE", type=Path, help="scene file (.toml) with [effects.buckling]")
    parser.add_argument("--out", metavar="FILE", type=PictureFile, help="the picture (.png)")
    add_set(parser)
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Draw and write what is asked for; 0, or a `UserError` where nothing buckles."""
    if not (args.out or args.json):
        raise UserError("nothing is asked for", "--out", "--out modes.png, or --json modes.json")
    from restshape_apps.solid.picture import draw

    from restshape.analysis.buckling import BucklingAnalysis
    from restshape.interface.first_frame import first_frame

    analysis = first_frame(args.scene, args.set).analysis
    if not isinstance(analysis, BucklingAnalysis):
        raise UserError("the scene does not ask for buckling", str(args.scene), "add [effects.buckling]")
    if args.out:
        draw(analysis, args.out)
        print(f"wrote {one_line(args.out)}")
    write_json(args, {"load_factors": analysis.load_factors.tolist()})
    return 0
