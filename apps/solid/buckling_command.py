"""`restshape buckling`: the modes in which a solid buckles."""

import argparse
from pathlib import Path

from restshape.cli.options import add_json, add_set, print_table, write_json
from restshape.errors import UserError, one_line
from restshape.outputs.kinds import PictureFile


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("scene", metavar="SCENE", type=Path, help="scene file (.toml) with [effects.buckling]")
    parser.add_argument("--out", metavar="FILE", type=PictureFile, help="the picture (.png)")
    add_set(parser)
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Print the load factors, draw and write what is asked for; 0, also where nothing buckles, unless it is drawn."""
    from restshape.analysis.buckling.buckling import BucklingAnalysis
    from restshape.interface.first_frame import first_frame

    analysis = first_frame(args.scene, args.set).analysis
    if not isinstance(analysis, BucklingAnalysis):
        raise UserError("the scene does not ask for buckling", str(args.scene), "add [effects.buckling]")
    if args.out:
        from restshape_apps.solid.picture import draw

        draw(analysis, args.out)
        print(f"wrote {one_line(args.out)}")
    checked = bool(analysis.state.report.inertia_checked)
    rows = [(number, f"{factor:.6g}") for number, factor in enumerate(analysis.load_factors, 1)]
    print_table("", ("mode", "load factor"), rows, right=("mode", "load factor"))
    if not rows:
        print("nothing buckles under this load")
    elif not checked:
        print("no inertia count has checked that none is missed")
    write_json(args, {"load_factors": analysis.load_factors.tolist(), "inertia_checked": checked})
    return 0
