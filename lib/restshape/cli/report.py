"""`restshape report`: tables and pictures of a recording."""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from restshape.application import Application, applications
from restshape.cli.options import add_json, print_table, write_json
from restshape.cli.quantity_cells import cells
from restshape.cli.report_looks import add_looks, read_looks
from restshape.cli.report_pictures import draw_report
from restshape.errors import UserError, one_line
from restshape.outputs.claims import refuse_foreign
from restshape.outputs.kinds import AnimationFile, PictureFile
from restshape.outputs.si_numbers import counted, si
from restshape.replay.level_names import LEVEL_NAMES

if TYPE_CHECKING:
    from restshape.replay.recording import Recording

SUMMARY = "tables and pictures of a recording"
_FORMATS = ("gif", "mp4", "none")
ORIGIN = ("scene", "script", "overrides", "restshape", "units", "machine")
"""Keys of the header that results repeat."""
EXTRAS = {"at_least": "at least", "at_most": "at most", "error": "largest estimated error"}
"""Columns of the table of quantities that only some have."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what this command takes."""
    parser.add_argument("recording", metavar="RECORDING", type=Path, help="recording (.vtkhdf) that replay --out wrote")
    parser.add_argument("--out", metavar="DIR", type=Path, help="folder for pictures (default: beside the recording)")
    parser.add_argument("--frames", metavar="N", type=int, default=6, help="frames on the contact sheet (default 6)")
    parser.add_argument("--at", metavar="I,J", help="frames on the contact sheet, by their numbers")
    parser.add_argument("--animation", choices=_FORMATS, default="gif", help="kind of animation (default gif)")
    parser.add_argument("--scale", metavar="S", type=float, help="exaggeration (default: 8 %% of the size)")
    add_looks(parser)
    for app in applications().values():
        if app.report:
            app.report.add_arguments(parser)
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Prints the tables and draws the pictures."""
    args.at = _numbers(args.at)
    if args.frames < 1:
        raise UserError("at least one frame must be shown", "--frames", "--frames 6")
    for app in applications().values():
        if app.report:
            app.report.check_arguments(args)
    if args.scale is not None and not 0.0 < args.scale < float("inf"):
        raise UserError("the exaggeration must be greater than 0", "--scale", "--scale 1 draws true displacements")
    if args.recording.is_dir():
        raise UserError("this is a folder", str(args.recording), "name a recording (.vtkhdf) in it")
    from restshape.replay.recording import Recording

    if args.animation == "mp4" and shutil.which("ffmpeg") is None:
        print("note: MP4 needs ffmpeg, which is not installed: the animation is a GIF", file=sys.stderr)
        args.animation = "gif"
    looks = read_looks(args)
    with Recording(args.recording) as recording:
        if not recording.n:
            raise UserError("the recording holds no frames", str(args.recording), "run the replay again")
        folder = args.out or args.recording.with_name(f"{args.recording.stem}-report")
        if folder.exists() and not folder.is_dir():
            raise UserError("this is a file, and pictures need a folder", str(folder), "choose another --out")
        if args.at and args.at[-1] >= recording.n:
            what = f"there is no frame {args.at[-1]}: the recording holds {counted(recording.n, 'frame')}"
            raise UserError(what, "--at", f"the last one is {recording.n - 1}")
        refuse_damage(recording)
        refuse_pictures(folder, looks.suffix)
        # A recording opens also where its application is not installed.
        application = applications().get(recording.header.get("app", ""))
        data = _tables(recording, application)
        pictures = draw_report(recording, folder, args, looks, application)
    print()
    for picture in pictures:
        print(f"wrote {one_line(picture)}")
    write_json(args, {**data, "pictures": [str(picture) for picture in pictures]})
    return 0


def _numbers(text: str | None) -> tuple[int, ...]:
    """The numbers of frames that an option names, rising; none where it is not given.

    Raises:
        UserError: it names none.
    """
    try:
        found = tuple(sorted({int(word) for word in (text or "").split(",") if word.strip()}))
    except ValueError:
        found = ()
    if text is not None and (not found or found[0] < 0):
        raise UserError("numbers of frames are 0, 1, ..., with commas", f"--at {text}", "--at 0,20,40")
    return found


def refuse_damage(recording: Recording) -> None:
    """Makes sure that all frames match their checksums.

    Raises:
        UserError: some do not; says which do.
    """
    from restshape.replay.recording import ranges

    if damaged := recording.verify():
        good = sorted(set(range(recording.n)) - set(damaged))
        are = "is" if len(damaged) == 1 else "are"
        what = f"{len(damaged)} of {counted(recording.n, 'frame')} {are} damaged: {ranges(damaged)}"
        what += f"; good: {ranges(good) or 'none'}"
        do = f"restshape salvage {recording.path} --out FILE.vtkhdf writes the good ones"
        raise UserError(what, str(recording.path), do if good else "record it again")


def refuse_pictures(folder: Path, suffix: str = ".png") -> None:
    """Makes sure that what a report draws into a folder replaces nothing but its own pictures.

    Raises:
        UserError: naming the first other file.
    """
    named = [
        PictureFile(folder / f"{name}{suffix}") for name in ("frames", "levels", "quantities", "timeline", "history")
    ]
    for path in (*named, *(AnimationFile(folder / f"animation.{kind}") for kind in _FORMATS[:2])):
        refuse_foreign(path, str(path))


def _tables(recording: Recording, application: Application | None) -> dict[str, Any]:
    """Prints the tables and gives them back for programs."""
    from restshape.report.tables import (
        convergence_counts,
        estimate_table,
        level_table,
        quantity_table,
        refused,
        rows_of,
        singular,
        status_counts,
    )

    levels, quantities, errors = level_table(recording), quantity_table(recording), estimate_table(recording)
    stopped, found, statuses = int(refused(recording).sum()), convergence_counts(recording), status_counts(recording)
    print(f"{recording.path}: {recording.summary}, {stopped} refused")
    _print_old_names(recording)
    _print_convergence(found)
    _print_levels(levels)
    _print_errors(errors)
    if quantities:
        _print_quantities(recording, quantities)
    _print_statuses(recording, statuses)
    of_application = {}
    if application and application.report:
        rows = rows_of(recording)
        print()
        application.report.print_tables(rows)
        of_application = application.report.summarised(rows)
    return {
        "origin": {key: recording.header[key] for key in ORIGIN if key in recording.header},
        "frames": recording.n,
        "refused": stopped,
        "status": recording.status,
        "levels": levels,
        "quantities": quantities,
        "singular": singular(recording),
        "constraint_status": statuses,
        "estimates": errors,
        **({"rest": found} if found else {}),
        **of_application,
        "writer": recording.writer,
    }


def _print_old_names(recording: Recording) -> None:
    if recording.old_names:
        names = ", ".join(f"{old} is {new}" for new, old in recording.old_names.items())
        print(f"note: columns of an earlier version have other names now: {names}")


def _print_convergence(found: dict[str, Any]) -> None:
    if found:
        stable = found["tangent_positive_definite"]
        print(
            f"converged: {counted(found['converged'], 'frame')}, {stable} of them stable; "
            f"not converged: {found['not_converged']}"
        )


def _print_levels(levels: Sequence[dict[str, Any]]) -> None:
    print()
    heads = ("level", "frames", "p50 [ms]", "p95 [ms]", "p99 [ms]", "iterations")
    keys = ("frames", "p50", "p95", "p99", "iterations")
    shown = [row for row in levels if row["frames"] or row["level"] in "123"]
    rows = [[LEVEL_NAMES[row["level"]], *(_short(row[key]) for key in keys)] for row in shown]
    print_table("time a level (without the first frame)", heads, rows, right=heads[1:])


def _print_errors(errors: Sequence[dict[str, Any]]) -> None:
    if errors:
        print()
        heads = ("relative error", "frames", "median", "largest")
        cells = [[row["error"], row["frames"], f"{row['p50']:.2g}", f"{row['max']:.2g}"] for row in errors]
        print_table("error beside the answers", heads, cells, right=heads[1:])


def _print_quantities(recording: Recording, quantities: Sequence[dict[str, Any]]) -> None:
    from restshape.replay.singular_notes import ESTIMATES_NOTE, singular_notes
    from restshape.report.tables import singular

    print()
    extras = [key for key in EXTRAS if any(key in row for row in quantities)]
    heads = ("quantity", "first", "last", "min", "max", *(EXTRAS[key] for key in extras))
    beside = _beside(recording, quantities)
    heads += ("first note", "last note") if beside else ()
    rows = [[*_quantity(row, extras), *beside.get(row["quantity"], ())] for row in quantities]
    print_table("quantities", heads, rows, right=heads[1:])
    if any(isinstance(row.get("error"), float) for row in quantities):
        print(ESTIMATES_NOTE)
    for note in singular_notes(singular(recording)):
        print(note)


def _print_statuses(recording: Recording, statuses: dict[str, int]) -> None:
    from restshape.report.tables import note_table

    if statuses:
        shown = ", ".join(f"{word} in {counted(count, 'frame')}" for word, count in statuses.items())
        print(f"constraint status: {shown}")
    if notes := note_table(recording):
        print()
        print_table("notes", ("line", "frames", "note"), notes, right=("line",))


def _quantity(row: dict[str, Any], extras: Sequence[str]) -> list[str]:
    """The cells of a quantity, all in one unit; extras: which of `EXTRAS` have a column."""
    from restshape.scene.quantity import limit_digits

    shown = cells([row[key] for key in ("first", "last", "min", "max")], row["unit"])
    more = [row.get(key, "") for key in extras]
    texts = [si(one, row["unit"], limit_digits(one)) if isinstance(one, float) else one for one in more]
    if isinstance(row.get("error"), float):
        at = extras.index("error")
        texts[at] = f"about {si(row['error'], row['unit'], 2)}" if row["error"] else "0"
    return [row["quantity"], *shown, *texts]


def _beside(recording: Recording, rows: list[dict[str, Any]]) -> dict[str, list[str]]:
    """What is said of the first and the last value of quantities, by name; empty where nothing is."""
    from restshape.report.recorded_quantities import recorded_kinds

    kinds = recorded_kinds(recording.header)
    ends = [{name: values[k] for name, values in recording.table.items()} for k in (0, -1)]
    found = {
        row["quantity"]: [kind.said(row[key], end) for key, end in zip(("first", "last"), ends)]
        for row in rows
        if (kind := kinds.get(row["quantity"]))
    }
    return found if any(map(any, found.values())) else {}


def _short(value: object) -> object:
    return f"{value:.3g}" if isinstance(value, float) else value
