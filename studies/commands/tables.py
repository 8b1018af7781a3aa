"""`restshape tables`: the thesis's numbers beside ours."""

import argparse
from pathlib import Path
from typing import Any

from restshape.cli.options import add_json, print_table, write_json
from restshape.cli.ranks import launched
from restshape.cli.verbosity import add_verbose
from restshape.errors import UserError, one_line
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.kinds import PageFile
from restshape.outputs.si_numbers import counted
from restshape.surroundings import start_petsc

PLACE = 6
SUMMARY = "the thesis's numbers beside ours, measured now"
HEADER = """# The thesis's numbers beside ours

Written by `restshape tables`; `restshape tables --check` says whether the counts still hold. Rows with a ratio or a
time were measured on the machine that wrote this file; triangles of table 4.3 and levels of table 4.2 depend on its
rounding. The thesis used a 2.5 GHz CPU with 2 GB of memory in chapter 4,
one of 2.66 GHz with 4 GB for table 5.1, and one of 2.8 GHz with 4 GB for table 6.1. The linear systems of our steps in
table 5.1 are solved to the relative residual that their rows name; with the thesis's numbers none is named.

Frames a second count whole frames on one core with their residual, to the scene's tolerance (1e-6), without a recorder;
rows that say so also estimate errors. Seconds of cloth count its first frame, mesh and all. What other programs take,
and where they are faster: [results](../docs/results.md#beside-other-programs).

"""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "--out", type=PageFile, default=PageFile("results/THESIS.md"), help="file to write (default: %(default)s)"
    )
    parser.add_argument("--check", action="store_true", help="compare the counts with the file and write nothing")
    add_json(parser)
    add_verbose(parser)


def run(args: argparse.Namespace) -> int:
    """Measure and write, or check; 0 when written or equal, 1 when the file no longer matches."""
    if args.check and not args.out.is_file():
        raise UserError("there is no such file", str(args.out), "restshape tables writes it")
    if launched():
        raise UserError("frames are counted on one core", "mpiexec", "start it without mpiexec")
    start_petsc(args.petsc)
    from restshape_studies.thesis import thesis_table
    from restshape_studies.verification import verifications

    from restshape.report.tables import markdown_table

    rows = [row for known in verifications().values() for row in known.thesis_rows(timed=not args.check)]
    tables = list(dict.fromkeys(row["table"] for row in rows))
    rows.sort(key=lambda row: tables.index(row["table"]))
    shown = [{key: value for key, value in row.items() if key not in ("timing", "rounding")} for row in rows]
    columns = ("table", "row", "quantity", "thesis", "ours", "unit")
    print_table("thesis and ours", columns, [[row[key] for key in columns] for row in shown])
    write_json(args, shown)
    if args.check:
        text = args.out.read_text(encoding="utf-8")
        # Where a mesh turns on the last digits, another type of CPU has other counts.
        return _check(text, [_lines(markdown_table, row) for row in rows if not row.get("rounding")], args.out)
    write_whole(args.out, HEADER + thesis_table(shown))
    print(f"wrote {one_line(args.out)}")
    return 0


def _lines(markdown_table: Any, row: dict[str, Any]) -> str:
    """The line of a row in the file."""
    return markdown_table((), [[row[key] for key in ("row", "quantity", "thesis", "ours", "unit")]]).splitlines()[-1]


def _check(text: str, lines: list[str], path: Path) -> int:
    """0 when the file holds every line; otherwise say which not, and 1."""
    missing = [line for line in lines if line not in text]
    for line in missing:
        print(f"{path}: not there: {line}")
    print(f"{path}: {len(lines) - len(missing)} of {counted(len(lines), 'count')} hold")
    return 1 if missing else 0
