"""`restshape tune`: the smallest change of a bar that brings it to a tone, or where to rasp it."""

import argparse
from pathlib import Path

from restshape_apps.metallophone.rasping import command as rasping

from restshape.cli.options import add_json, add_set, read_scene
from restshape.errors import UserError


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("scene", type=Path, metavar="SCENE", help="scene file (.toml) of a metallophone")
    parser.add_argument("--to", required=True, metavar="TONE", help="wanted tone of the first mode, such as C5")
    rasping.arguments(parser)
    add_set(parser)
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Tune, or hand on to rasping; 0."""
    scene = read_scene(args)
    if scene.app != "metallophone":
        raise UserError(f"the scene is one of {scene.app!r}", str(args.scene), 'use a scene with app = "metallophone"')
    return rasping.run(scene, args)
