"""`restshape compare`: two results beside each other."""

from __future__ import annotations

import argparse
import math
from collections.abc import Container, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

from restshape.cli.options import add_json, print_table, write_json
from restshape.errors import UserError, one_line, printable
from restshape.outputs.kinds import PictureFile
from restshape.outputs.si_numbers import counted, si

if TYPE_CHECKING:
    from restshape.comparison.result import Result
    from restshape.comparison.result_comparison import Compared
    from restshape.comparison.series_difference import SeriesDifference

SUMMARY = "two results beside each other: how they were made, quantities, times, fields"
SHOWN = 12
"""Frames, columns or keys that are listed."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what this command takes."""
    what = "recording (.vtkhdf), or a file that replay --json wrote"
    parser.add_argument("first", metavar="A", type=Path, help=what)
    parser.add_argument("second", metavar="B", type=Path, help="the other one, likewise")
    parser.add_argument(
        "--tolerance",
        metavar="T",
        type=float,
        default=0.0,
        help="largest difference of quantities and fields, over the largest value of each (default: the same bits)",
    )
    parser.add_argument("--out", metavar="FILE", type=PictureFile, help="picture of both (.png, .svg)")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Compare; 0 where they are the same, or within the tolerance, 1 where they differ."""
    if not 0.0 <= args.tolerance < math.inf:
        raise UserError("a tolerance is 0 or greater", f"--tolerance {args.tolerance:g}", "--tolerance 1e-6")
    from restshape.comparison.result import read_result
    from restshape.comparison.result_comparison import compared

    with closing(read_result(args.first)) as first, closing(read_result(args.second)) as second:
        for one in (first, second):
            _refuse_damage(one)
        found = compared(first, second, args.tolerance)
        write_json(args, found.plain())
        _print(args, found, first, second)
        if args.out:
            _draw(args.out, first, second, found)
    return 0 if found.same else 1


def _refuse_damage(result: Result) -> None:
    """Makes sure that all frames of a recording match their checksums, and that there are some.

    Raises:
        UserError: some do not; says which.
    """
    from restshape.cli.report import refuse_damage

    if not result.n:
        raise UserError("the result holds no frames", str(result.path), "run the replay again")
    if result.recording:
        refuse_damage(result.recording)


def _print(args: argparse.Namespace, found: Compared, first: Result, second: Result) -> None:
    """Print what differs, what is nearest to how it was made first."""
    from restshape.comparison.header_differences import shortened
    from restshape.replay.singular_notes import singular_notes

    if found.header:
        rows = [(one.key, shortened(one.first), shortened(one.second)) for one in found.header]
        print_table("how they were made", ("key", "A", "B"), rows)
    if found.frames[0] != found.frames[1]:
        print(f"frames: {found.frames[0]} and {found.frames[1]}; the first {min(found.frames)} are compared")
    if found.apart:
        print(_moments(found.apart))
    _print_list("frames refused in one of them only", found.refused)
    _print_list("frames with another constraint status", found.status)
    _print_alone("quantities", found.alone, [one.quantities for one in (first, second)])
    if found.quantities:
        _print_differences("quantities", "quantity", found.quantities, first.units | second.units)
        for note in singular_notes(first.singular | second.singular):
            print(note)
    if found.fields:
        ways = ", ".join(f"{way} in {counted(count, 'frame')}" for way, count in found.fields.ways.items() if count)
        print(f"meshes: {ways}")
        _print_differences("fields", "field", [found.fields.points, *found.fields.fields], _field_units(first, second))
        _print_alone("fields", found.fields.alone, [one.recording.fields for one in (first, second) if one.recording])
    if found.times:
        heads = ("time a frame", "A [ms]", "B [ms]", "B / A")
        rows = [(k, f"{a:.3f}", f"{b:.3f}", f"{b / a:.2f}" if a else "-") for k, (a, b) in found.times.items()]
        print_table("times", heads, rows, right=heads[1:])
    _print_list("columns and fields with other bits", found.columns or [])
    print(_sentence(args, found))
    if unknown := [one_line(one.path) for one in (first, second) if one.recording is None]:
        those = "neither file has" if len(unknown) == 2 else f"{unknown[0]} does not have"
        print(f"note: quantities alone are compared: {those} fields, which recordings (.vtkhdf) hold")


def _moments(apart: SeriesDifference) -> str:
    """Says that frames of one number are at other simulated times."""
    if not math.isfinite(apart.largest):
        return "note: frames are paired by their number, and none has a simulated time in both"
    far = f"at other simulated times, by up to {si(apart.largest, 's')} (frame {apart.frame})"
    return f"note: frames are paired by their number and are {far}: their differences are those of other moments, too"


def _print_differences(title: str, what: str, differences: list[SeriesDifference], units: Mapping[str, str]) -> None:
    """Print differences, those of values with their units and SI prefixes."""
    heads = (what, "largest", "relative", "rms", "frame", "only in one")
    rows = []
    for one in differences:
        largest, rms = (_number(value, units.get(one.name, "")) for value in (one.largest, one.rms))
        numbers = largest, _number(one.relative if one.compared else math.nan), rms
        rows.append((one.name, *numbers, one.frame if one.frame >= 0 else "-", one.alone or "-"))
    print_table(title, heads, rows, right=heads[1:])


def _field_units(*results: Result) -> dict[str, str]:
    """Units of fields, as far as the physics of the applications that made them know; of points and displacements."""
    from restshape.report.field import physics_of

    recordings = [one.recording for one in results if one.recording]
    looks = {name: look for each in recordings for one in physics_of(each) for name, look in one.pictured.items()}
    return {"points": "m", "displacement": "m"} | {name: look.unit for name, look in looks.items()}


def _number(value: float, unit: str = "") -> str:
    return "-" if not math.isfinite(value) else si(value, unit) if unit else f"{value:.3g}"


def _print_list(title: str, values: list[int] | list[str]) -> None:
    if values:
        more = f" ... and {len(values) - SHOWN} more" if len(values) > SHOWN else ""
        print(printable(f"{title}: {', '.join(map(str, values[:SHOWN]))}{more}"))


def _print_alone(what: str, names: list[str], both: Sequence[Container[str]]) -> None:
    """Print which quantities or fields one of the results does not have, and which of them."""
    for which, own, other in (("A", *both), ("B", *reversed(both))):
        _print_list(f"{what} of {which} only", [name for name in names if name in own and name not in other])
    _print_list(f"{what} with values of another kind", [name for name in names if all(name in one for one in both)])


def _sentence(args: argparse.Namespace, found: Compared) -> str:
    """What the comparison comes to."""
    from restshape.comparison.result_comparison import SAME_BITS, SAME_VALUES, WITHIN

    what = "quantities and fields" if found.fields else "quantities"
    return {
        SAME_BITS: "the same bits, times left out" + (f": {found.hashes[0]}" if found.hashes else ""),
        SAME_VALUES: "the same values of all quantities in all frames",
        WITHIN: f"{what} differ by at most {args.tolerance:g} of their largest values",
    }.get(found.outcome, "they differ" + (f" by more than {args.tolerance:g}" if args.tolerance else ""))


def _draw(path: PictureFile, first: Result, second: Result, found: Compared) -> None:
    """Draw the picture.

    Raises:
        UserError: it cannot be written.
    """
    from restshape.comparison.comparison_picture import draw_comparison
    from restshape.outputs.picture_files import drawn_from, fingerprint

    try:
        with drawn_from(fingerprint(found.plain())):
            drawn = draw_comparison(first, second, found, path)
    except OSError as error:
        raise UserError(f"cannot be written: {error.strerror}", f"--out {path}", "name another file") from error
    print(f"wrote {one_line(path)}" if drawn else "note: there is nothing to draw")
