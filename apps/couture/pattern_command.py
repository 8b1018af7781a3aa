"""`restshape pattern`: a sewing pattern in another format, and as a scene of cloth."""

# More than 15 modules: each format has modules of its own, which are imported where it is read or written.

import argparse
from pathlib import Path

import numpy as np

from restshape.cli.options import add_json, write_json
from restshape.errors import UserError, one_line
from restshape.export.paper_tiles import PAPERS
from restshape.outputs.claims import refuse_outputs
from restshape.outputs.kinds import PatternFile
from restshape.outputs.si_numbers import counted
from restshape.scene.units import UnitError, quantity
from restshape.shape.patterns.pattern import Pattern

READ = (".json", ".dxf", ".svg", ".toml")
"""GarmentCode, AAMA or ASTM, drawings, and scenes."""
TILED = ".pdf"
"""Sheets of paper, which are written alone."""
SMALL, LARGE = 0.05, 10.0
"""Sizes [m] that the largest piece of a pattern most often lies between."""
CUT = (".dxf", ".svg", TILED)
"""Formats that have cut lines."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what this command takes."""
    what = "pattern: .json of GarmentCode, .dxf with the layers of AAMA and ASTM, .svg, or a scene of cloth (.toml)"
    parser.add_argument("source", metavar="PATTERN|SCENE", type=Path, help=what)
    parser.add_argument(
        "--out",
        metavar="FILE",
        type=PatternFile,
        required=True,
        help="file to write, by its ending: one of the same, or .pdf: sheets of paper in true size",
    )
    parser.add_argument("--tiles", choices=PAPERS, help="paper of a .pdf (default: a4)")
    parser.add_argument("--allowance", metavar="LENGTH", help="of seams, around which a .pdf, .dxf or .svg is cut")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Reads the pattern, writes it, and says what it holds and what was left; the exit code."""
    kind, allowance = args.out.suffix.lower(), _allowance(args.allowance)
    if kind not in (*READ, TILED):
        known = ", ".join((*READ, TILED))
        raise UserError(f"no pattern is written as {args.out.suffix or 'that'}", "--out", f"use {known}")
    if args.tiles and kind != TILED:
        raise UserError("sheets of paper are a PDF", f"--tiles {args.tiles}", f"--out {args.out.with_suffix(TILED)}")
    if allowance and kind not in CUT:
        what = f"a {kind} file has lines of seams alone, and no cut lines"
        raise UserError(what, "--allowance", f"leave it out, or write {', '.join(CUT)}")
    refuse_outputs({"--out": args.out}, {f"pattern {args.source}": args.source})
    pattern = _read(args.source)
    areas = {piece.name: piece.outline().area() for piece in pattern.pieces}
    try:
        left = _write(pattern, args.out, args.source.stem, allowance, args.tiles or "a4")
    except OSError as error:
        what = f"{args.out} cannot be written: {(error.strerror or str(error)).lower()}"
        raise UserError(what, "--out", "name another file") from error
    notes = [*filter(None, [pattern.doubt, _doubtful_size(pattern)]), *pattern.notes, *left]
    seams = len(pattern.stitches)
    sewn = f", {counted(seams, 'seam')}" if seams else ""
    print(f"wrote {one_line(args.out)}: {counted(len(areas), 'piece')} of {sum(areas.values()):.6g} m^2{sewn}")
    for note in notes:
        print(f"note: {note}")
    write_json(args, {"file": str(args.out), "areas": areas, "seams": seams, "notes": notes})
    return 0


def _read(path: Path) -> Pattern:
    """The pattern of a file.

    Raises:
        UserError: there is none, or it cannot be read.
    """
    kind = path.suffix.lower()
    if kind not in READ:
        raise UserError(f"no pattern can be read from {path.name}", "PATTERN", f"use one of {', '.join(READ)}")
    if not path.is_file():
        raise UserError(f"there is no file {one_line(path)}", "PATTERN", "name one that is there")
    if kind == ".toml":
        from restshape.export.pattern_scene import pattern_of_scene
        from restshape.scene.load import load_scene

        return pattern_of_scene(load_scene(path))
    if kind == ".json":
        from restshape.shape.patterns.garmentcode import read_garmentcode

        return read_garmentcode(path)
    from restshape.shape.patterns.pattern_drawing import read_pattern_dxf
    from restshape.shape.patterns.pattern_svg import read_pattern_svg

    return read_pattern_dxf(path) if kind == ".dxf" else read_pattern_svg(path)


def _doubtful_size(pattern: Pattern) -> str:
    """A note of pieces that are larger or smaller than garments are, as if they had another unit; "" without."""
    sizes = {piece.name: float(np.ptp(piece.outline().bounds(), axis=0).max()) for piece in pattern.pieces}
    largest = max(sizes, key=lambda name: sizes[name])
    if SMALL <= sizes[largest] <= LARGE:
        return ""
    return f"the largest piece, {largest}, is {sizes[largest]:.3g} m long: check the unit of the file"


def _allowance(text: str | None) -> float:
    """The allowance [m] of an option, 0 without.

    Raises:
        UserError: it is no length.
    """
    if text is None:
        return 0.0
    try:
        found = quantity(text, "length")
    except UnitError as error:
        raise UserError(error.what, "--allowance", error.do) from error
    if not 0.0 <= found < np.inf:
        raise UserError(f"{text!r} is no allowance of a seam", "--allowance", "--allowance 10mm")
    return found


def _write(pattern: Pattern, path: Path, title: str, allowance: float, paper: str) -> list[str]:
    """Writes a pattern; what is left out, and how many sheets there are."""
    kind = path.suffix.lower()
    if kind == TILED:
        from restshape.export.pattern_tiles import write_tiles
        from restshape.export.seam_allowance import holes_noted

        sheets = write_tiles(pattern, path, paper, allowance, title)
        holes = holes_noted(pattern, allowance) if allowance else []
        return [f"{counted(sheets, 'sheet')} of {paper}, after a page with their places and a square of 100 mm", *holes]
    if kind == ".toml":
        from restshape.export.pattern_scene import write_pattern_scene

        return write_pattern_scene(pattern, path, title)
    if kind == ".json":
        from restshape.export.garmentcode_file import write_garmentcode

        return write_garmentcode(pattern, path)
    from restshape.export.pattern_drawings import write_pattern_dxf
    from restshape.export.pattern_svg_file import write_pattern_svg

    write = write_pattern_dxf if kind == ".dxf" else write_pattern_svg
    return write(pattern, path, allowance)
