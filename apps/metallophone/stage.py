"""What the commands of this application share: the modes of a scene, or of a scene after its edits."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from restshape.cli.options import add_set, read_scene
from restshape.cli.parser import add_edits
from restshape.cli.ranks import launched
from restshape.errors import UserError

if TYPE_CHECKING:
    from restshape.analysis.modal.modal import ModalAnalysis
    from restshape.scene.model import Scene


def add_frame(parser: argparse.ArgumentParser, done: str = "shown") -> None:
    """Declare the arguments that name a scene and a frame of it, and say what is done with that frame."""
    parser.add_argument("scene", type=Path, metavar="SCENE", help="scene file (.toml) of a metallophone")
    add_edits(parser, f"edit script (.jsonl); what is {done} is its last frame")
    parser.add_argument("--frame", type=int, metavar="N", help=f"frame of the edits that is {done} instead")
    add_set(parser)


def analysed(args: argparse.Namespace) -> ModalAnalysis:
    """The modes of the frame that the arguments name.

    Raises:
        UserError: the scene is not a metallophone's, or has no such frame.
    """
    scene = metallophone(args)
    from restshape.interface.first_frame import replayed_to

    return replayed_to(scene, args.edits, args.frame).analysis


def metallophone(args: argparse.Namespace) -> Scene:
    """The scene that the arguments name.

    Raises:
        UserError: it is not a metallophone's.
    """
    refuse_ranks()
    scene = read_scene(args)
    if scene.app != "metallophone":
        raise UserError(f"the scene is one of {scene.app!r}", str(args.scene), 'use a scene with app = "metallophone"')
    return scene


def refuse_ranks() -> None:
    """Refuse to run on several ranks, of which each would print and write the same.

    Raises:
        UserError: an MPI launcher started this process.
    """
    if launched():
        raise UserError("modes of one shape are computed on one rank", "mpiexec", "start the command without it")
