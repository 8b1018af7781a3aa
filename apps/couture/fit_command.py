"""`restshape fit`: numbers of a scene, such as a stiffness, with which its drape has a measured outline."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from restshape.cli.options import add_scene, print_table, read_scene, write_json
from restshape.cli.parser import add_edits
from restshape.errors import UserError, one_line
from restshape.outputs.kinds import FittedFile, PictureFile

if TYPE_CHECKING:
    from restshape_apps.couture.fitting.report import FitReport

    from restshape.scene.model import Scene

STARTS = 21


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_scene(parser)
    add_edits(parser, "edit script (.jsonl); the drape is that of its last frame")
    parser.add_argument("--frame", type=int, metavar="N", help="frame of the edits that was measured instead")
    parser.add_argument(
        "--outline", type=Path, required=True, metavar="FILE", help="measured outline from above (.svg, .dxf, .csv)"
    )
    what = "a number of the scene that is fitted (may be given several times; default: the bending stiffness)"
    parser.add_argument("--by", action="append", default=[], metavar="KEY", help=what)
    what = f"most drapes from the flat cloth that a fit is begun from (default: {STARTS})"
    parser.add_argument("--starts", type=int, default=STARTS, metavar="N", help=what)
    parser.add_argument("--out", type=FittedFile, metavar="FILE", help="the scene with what was found (.toml)")
    parser.add_argument("--picture", type=PictureFile, metavar="FILE", help="both outlines (.png, .svg)")


def run(args: argparse.Namespace) -> int:
    """Fit, print, and write what is asked for; 0."""
    if args.starts < 1:
        raise UserError(f"{args.starts} starts find nothing", "--starts", "--starts 1, or more")
    scene = read_scene(args)
    if scene.app != "couture":
        raise UserError(f"the scene is one of {scene.app!r}", str(args.scene), 'use a scene with app = "couture"')
    if args.out and args.out.suffix.lower() != ".toml":
        raise UserError(f"{one_line(args.out.name)} is no .toml file", "--out", "--out fitted.toml")
    from restshape_apps.couture.fitting.report import fitted

    report = fitted(scene, args, _progress)
    _print(report)
    if args.out:
        write_scene(args, scene, report)
    if args.picture:
        from restshape_apps.couture.fitting.fit_picture import draw

        _written(lambda: draw(*report.drawn, args.picture), args.picture, "--picture")
    write_json(args, report.plain())
    return 0


def _progress(values: str, misfit: float) -> None:
    if sys.stderr.isatty():
        print(f"  {values}: misfit {1e3 * misfit:.3g} mm", file=sys.stderr)


def _print(report: FitReport) -> None:
    heads, rows = report.steps()
    print_table("steps", heads, rows, right=heads[1:])
    heads, rows = report.numbers()
    print_table("numbers: 95 % intervals", heads, rows, right=heads[1:])
    heads, rows = report.outlines()
    print_table("outlines", heads, rows, right=heads[1:])
    for note in report.notes():
        print(f"note: {note}")


def write_scene(args: argparse.Namespace, scene: Scene, report: FitReport) -> None:
    """Write the scene with the numbers, and with what --set gives."""
    from restshape.outputs.atomic_files import write_whole
    from restshape.outputs.kinds import FITTED_MARK
    from restshape.scene.overrides import parse_override
    from restshape.scene.rewritten import rewritten

    changes: list[tuple[tuple[str, ...], Any]] = [parse_override(word) for word in args.set]
    changes += report.drapes.changes(list(report.rounded().values()))
    text = rewritten(scene.path, changes, args.out)
    _written(lambda: write_whole(args.out, FITTED_MARK + text.removeprefix(FITTED_MARK)), args.out, "--out")


def _written(write: Any, path: Path, option: str) -> None:
    """Write a file, and say so.

    Raises:
        UserError: it cannot be written.
    """
    try:
        write()
    except OSError as error:
        raise UserError(f"cannot be written: {error.strerror}", f"{option} {path}", "name another file") from error
    print(f"wrote {one_line(path)}")
