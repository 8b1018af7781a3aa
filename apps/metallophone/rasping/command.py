"""`restshape tune --rasp`: where to rasp a bar that has been measured, and how much."""

from __future__ import annotations

import argparse
from math import isfinite
from typing import TYPE_CHECKING

from restshape.analysis.modal.pitch import frequency_of
from restshape.cli.options import write_json
from restshape.errors import UserError
from restshape.outputs.kinds import PictureFile

if TYPE_CHECKING:
    from restshape.scene.model import Scene

ADDING = {"by": "--by", "bound": "--bound", "overtones": "--overtones", "modes": "--modes", "out": "--out"}
"""What tunes by freedoms, by the argument."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--measured", type=float, metavar="HZ", help="measured frequency of the first tone [Hz]")
    parser.add_argument("--rasp", action="store_true", help="print where to rasp, and how much")
    parser.add_argument(
        "--keep",
        type=int,
        action="append",
        default=[],
        metavar="MODE",
        help="with --rasp: keep the ratio of this mode to the first (may be given several times)",
    )
    parser.add_argument(
        "--most", type=float, metavar="MM", default=2.0, help="with --rasp: largest depth off the outline [mm]"
    )
    parser.add_argument(
        "--picture", type=PictureFile, metavar="FILE", help="with --rasp: draw where to rasp (.png, .svg)"
    )


def run(scene: Scene, args: argparse.Namespace) -> int:
    """Print the advice; 0.

    Raises:
        UserError: freedoms that add material, a frequency that is none or far from the model, no such mode.
    """
    given = [option for name, option in ADDING.items() if getattr(args, name, None)]
    if given:
        what = f"rasping takes material off, and {given[0]} is of a bar that is still to be cut"
        raise UserError(what, given[0], "leave it out, or leave out --rasp")
    for option, value in (("--measured", args.measured), ("--most", args.most)):
        if value is not None and not (isfinite(value) and value > 0.0):
            raise UserError(f"{value:g} is not above 0", option, "give a positive number")
    from restshape_apps.metallophone.rasping.map_picture import draw_plan
    from restshape_apps.metallophone.rasping.plan import Wish, rasping_plan
    from restshape_apps.metallophone.rasping.report import plan_as_json, print_plan

    from restshape.interface.first_frame import replayed_to
    from restshape.physics.elasticity.modal_effect import modal_keys

    target = frequency_of(args.to, modal_keys(scene).a4, "--to")
    analysis = replayed_to(scene, args.edits, args.frame).analysis
    measured = args.measured or float(analysis.frequencies[0])
    plan = rasping_plan(analysis, Wish(measured, target, tuple(args.keep), 1e-3 * args.most))
    print_plan(plan, args.to)
    if args.picture:
        draw_plan(args.picture, analysis, plan, args.to)
    write_json(args, plan_as_json(plan, args.to))
    return 0
