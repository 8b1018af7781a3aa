"""`restshape furniture-pictures`: the pictures of the page of furniture."""

import argparse
from pathlib import Path

from restshape.errors import UserError, one_line


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--out", type=Path, metavar="STEM", required=True, help="files are STEM-NAME.png")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="of pictures (default: all)")
    parser.add_argument("--piece", metavar="PIECE", help="of pieces, suggestions and forces")
    parser.add_argument("--joints", nargs=2, type=int, metavar="N", help="of forces; default: the weakest two")


def run(args: argparse.Namespace) -> int:
    """Draw; 0, or a `UserError` of a name that is not there and of a file that cannot be written."""
    from restshape_apps.furniture.pictures import PICTURES, draw_named
    from restshape_apps.furniture.pieces import PIECES

    for option, names, known in (
        ("--only", args.only or (), PICTURES),
        ("--piece", filter(None, [args.piece]), PIECES),
    ):
        for name in names:
            if name not in known:
                raise UserError(
                    f"there is none of the name {name!r}", option, f"use one of: {', '.join(sorted(known))}"
                )
    try:
        args.out.parent.mkdir(parents=True, exist_ok=True)
        for name in args.only or PICTURES:
            path = args.out.with_name(f"{args.out.name}-{name}.png")
            draw_named(name, path, args.piece, tuple(args.joints) if args.joints else None)
            print(f"wrote {one_line(path)}")
    except OSError as error:
        raise UserError(f"cannot be written: {error.strerror}", f"--out {args.out}", "name another stem") from error
    return 0
