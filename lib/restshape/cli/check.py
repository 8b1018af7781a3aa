"""`restshape check`: reads a scene and an edit script, and says what they hold."""

import argparse

from restshape.cli.limits import add_limits, limited
from restshape.cli.options import add_scene
from restshape.cli.parser import add_edits
from restshape.outputs.kinds import PictureFile

SUMMARY = "check a scene and an edit script without solving anything"


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what this command takes."""
    add_scene(parser)
    add_limits(parser)
    add_edits(parser, "edit script (.jsonl)")
    parser.add_argument(
        "--picture", metavar="FILE", type=PictureFile, help="draw the scene with its names (.png or .svg)"
    )


def run(args: argparse.Namespace) -> int:
    """Prints what the scene holds and which edits would be refused; 1 if any would be."""
    from restshape.cli.check_scene import check

    with limited(args) as begin_frame:
        return check(args, begin_frame)
