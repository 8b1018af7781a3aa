"""What `restshape export` has for workshops: layers of drawings, the width of the cut, and what applications add."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, cast

from restshape.application import application_of, applications
from restshape.errors import UserError
from restshape.scene.units import UnitError, quantity

if TYPE_CHECKING:
    from pathlib import Path

    from restshape.export.cut_drawing import Engraving
    from restshape.export.edited_frame import EditedFrame
    from restshape.scene.model import Scene

NAMES, CUT = "names", "cut"
DRAWINGS = ("dxf", "svg")
UNITS = ("mm", "cm", "m", "in")
LARGEST = 0.05
"""Width of a cut [m] above which it is none."""


def own_formats() -> dict[str, list[str]]:
    """Formats that scenes of some applications alone are written as, with the names of these."""
    found: dict[str, list[str]] = {}
    for name, app in applications().items():
        for kind in app.exports.formats if app.exports else ():
            found.setdefault(kind, []).append(name)
    return found


def add_workshop(parser: argparse.ArgumentParser) -> None:
    """Adds the options of drawings for a workshop, and those of applications."""
    layers = "layers of a dxf or svg: names of edges, or CUT, HOLES and ENGRAVE (default: as the application has it)"
    parser.add_argument("--layers", choices=(NAMES, CUT), help=layers)
    parser.add_argument("--kerf", metavar="WIDTH", help="of the cut: the path lies half of it outside of the shape")
    parser.add_argument("--unit", choices=UNITS, help="of lengths in a dxf with layers for a workshop (default: mm)")
    for app in applications().values():
        if app.exports:
            app.exports.add_arguments(parser)


def check_workshop(args: argparse.Namespace) -> None:
    """Makes sure that the options fit the format, and turns the kerf into metres.

    Raises:
        UserError: they do not.
    """
    for option, given, kinds in (
        ("--layers", args.layers, DRAWINGS),
        ("--kerf", args.kerf, DRAWINGS),
        ("--unit", args.unit, DRAWINGS[:1]),
    ):
        if given and args.kind not in kinds:
            raise UserError(f"a {args.kind} file has none", option, f"leave it out, or --as {' or '.join(kinds)}")
        if given and args.layers == NAMES and option != "--layers":
            raise UserError("a drawing with layers by name is the shape itself, in mm", option, "use --layers cut")
    args.kerf = _kerf(args.kerf)
    for app in applications().values():
        if app.exports:
            app.exports.check_arguments(args)


def _kerf(text: str | None) -> float:
    """The width of the cut [m] of an option, 0 without.

    Raises:
        UserError: it is none.
    """
    try:
        found = 0.0 if text is None else quantity(text, "length")
    except UnitError as error:
        raise UserError(error.what, "--kerf", error.do) from error
    if not 0.0 <= found <= LARGEST:
        what = f"{text!r} is no width of a cut: it lies between 0 and {1e3 * LARGEST:g} mm"
        raise UserError(what, "--kerf", "--kerf 0.2mm")
    return found


def refuse_format(kind: str, scene: Scene) -> None:
    """Refuses a format that scenes of this application are not written as.

    Raises:
        UserError: it is one.
    """
    having = own_formats().get(kind)
    if having and scene.app not in having:
        what = f"a scene of {scene.app!r} is not written as {kind}"
        raise UserError(what, f"--as {kind}", f"name another format; {kind} is for scenes of {', '.join(having)}")


def for_workshop(args: argparse.Namespace, scene: Scene) -> bool:
    """Whether a drawing has the layers CUT, HOLES and ENGRAVE."""
    if args.kind not in DRAWINGS or args.layers == NAMES:
        return False
    exports = application_of(scene).exports
    return bool(args.layers or args.kerf or args.unit or (exports and exports.layers == CUT))


def shaped_by_application(args: argparse.Namespace, frame: EditedFrame) -> tuple[EditedFrame, list[str]]:
    """The frame whose shape is written, the same where its application changes nothing; what there is to note."""
    exports = application_of(frame.scene).exports
    return cast("tuple[EditedFrame, list[str]]", exports.shape(frame, args)) if exports else (frame, [])


def engraving_of(args: argparse.Namespace, frame: EditedFrame) -> Engraving:
    """What the application of a frame has engraved and drilled."""
    from restshape.export.cut_drawing import Engraving

    exports = application_of(frame.scene).exports
    return cast("Engraving", exports.engraving(frame, args)) if exports else Engraving()


def write_own(args: argparse.Namespace, frame: EditedFrame, out: Path) -> list[str]:
    """Writes a frame in a format of its application; what there is to note."""
    exports = application_of(frame.scene).exports
    assert exports is not None, "other applications are refused"
    return exports.write(args.kind, frame, args, out)
