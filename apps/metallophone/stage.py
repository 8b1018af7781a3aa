"""What the commands of this application share: the modes of a scene, or of a scene after its edits."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from restshape.cli.options import add_set, read_scene
from restshape.cli.parser import add_edits
from restshape.errors import UserError

if TYPE_CHECKING:
    from restshape.analysis.modal import ModalAnalysis


def add_frame(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments that name a scene and a frame of it."""
    parser.add_argument("scene", type=Path, metavar="SCENE", help="scene file (.toml) of a metallophone")
    add_edits(parser, "edit script (.jsonl); what is shown is its last frame")
    parser.add_argument("--frame", type=int, metavar="N", help="frame of the edits that is shown instead")
    add_set(parser)


def analysed(args: argparse.Namespace) -> ModalAnalysis:
    """The modes of the frame that the arguments name.

    Raises:
        UserError: the scene is not a metallophone's, or has no such frame.
    """
    scene = read_scene(args)
    if scene.app != "metallophone":
        raise UserError(f"the scene is one of {scene.app!r}", str(args.scene), 'use a scene with app = "metallophone"')
    from petsc4py import PETSc

    from restshape.application import application
    from restshape.calibration import Calibration
    from restshape.policy import policy
    from restshape.replay.loop import Replay
    from restshape.scene.edit_script import Script, load_script

    script = load_script(args.edits, scene) if args.edits else Script.empty(scene)
    chosen = policy(scene.solve.policy)
    replay = Replay(scene, script, application(scene.app), chosen, PETSc.COMM_WORLD, Calibration.load())
    last = None
    for row in replay.frames():
        last = row["index"]
        if last == args.frame:
            break
    if args.frame is not None and last != args.frame:
        raise UserError(f"the edits have {last + 1} frames", "--frame", f"use 0 to {last}")
    return replay.analysis
