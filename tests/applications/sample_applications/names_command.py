"""A command that an application brings: the names of the edges in a scene."""

import argparse

from restshape.cli.options import add_scene, read_scene, write_json


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_scene(parser)


def run(args: argparse.Namespace) -> int:
    """Print the names; 0."""
    names = sorted(read_scene(args).shape.edges)
    print(*names)
    write_json(args, names)
    return 0
