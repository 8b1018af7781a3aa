"""Options of `restshape export` that are of bars."""

from __future__ import annotations

import argparse

from restshape.analysis.modal.pitch import frequency_of
from restshape.errors import UserError
from restshape.scene.units import UnitError, quantity

NAMING = ("dxf", "svg", "pdf")
"""Formats that the tone is written in."""
WITHOUT_HOLES = ("vtu", "csv", "obj")
"""Formats that are the mesh alone, with its fields."""
THICKEST = 0.05
"""Diameter of holes for a cord [m] above which they are none."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    to = "of a bar: the tone that it is to have, engraved in dxf and svg and on the sheet (default: the nearest)"
    parser.add_argument("--to", metavar="TONE", help=to)
    cord = "of a bar: drill holes of this diameter for a cord at its hanging points"
    parser.add_argument("--cord", metavar="DIAMETER", help=cord)


def check(args: argparse.Namespace) -> None:
    """Make sure that they make sense, and turn the diameter into metres, 0 without.

    Raises:
        UserError: they do not.
    """
    if args.to and (args.kind not in NAMING or args.layers == "names"):
        what = "no tone is written there"
        raise UserError(what, f"--to {args.to}", "leave it out, or --as dxf, svg or pdf without --layers names")
    if args.cord and args.kind in WITHOUT_HOLES:
        what = f"a {args.kind} file has a mesh and its fields, without holes for a cord"
        raise UserError(what, "--cord", "export it as toml first, and that scene as this")
    if args.to:
        frequency_of(args.to, where="--to")
    args.cord = _diameter(args.cord)


def _diameter(text: str | None) -> float:
    try:
        found = 0.0 if text is None else quantity(text, "length")
    except UnitError as error:
        raise UserError(error.what, "--cord", error.do) from error
    if text is not None and not 0.0 < found <= THICKEST:
        what = f"{text!r} is no diameter of a hole for a cord: it lies above 0, up to {1e3 * THICKEST:g} mm"
        raise UserError(what, "--cord", "--cord 4mm")
    return found
