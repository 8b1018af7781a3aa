"""The tables that `restshape report` prints of a recording."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from restshape.cli.doubtful import print_doubtful, untrusted_words
from restshape.cli.options import print_table
from restshape.cli.quantity_cells import cells
from restshape.outputs.si_numbers import counted, si, three_digits
from restshape.replay.level_names import LEVEL_NAMES

if TYPE_CHECKING:
    from restshape.application import Application
    from restshape.replay.recording.recording import Recording

ORIGIN = ("scene", "script", "overrides", "restshape", "units", "machine")
"""Keys of the header that results repeat."""
EXTRAS = {"at_least": "at least", "at_most": "at most", "error": "largest estimated error"}
"""Columns of the table of quantities that only some have."""


NOTES = {
    "refused": ("refused frames", "reason"),
    "untrusted": ("frames that are not to be trusted", "reason"),
    "note": ("notes", "note"),
}
"""Columns of texts that are listed: the title of their table, and the head of its last column."""


def print_tables(recording: Recording, application: Application | None) -> dict[str, Any]:
    """Prints the tables and gives them back for programs."""
    from restshape.report.tables import (
        convergence_counts,
        estimate_table,
        first_time,
        level_table,
        note_table,
        quantity_table,
        refused,
        rows_of,
        singular,
        status_counts,
    )

    levels, quantities, errors = level_table(recording), quantity_table(recording), estimate_table(recording)
    first = first_time(recording)
    stopped, found, statuses = int(refused(recording).sum()), convergence_counts(recording), status_counts(recording)
    print(f"{recording.path}: {recording.summary}, {stopped} refused")
    _print_old_names(recording)
    _print_convergence(found)
    _print_levels(levels, first)
    _print_errors(errors)
    if quantities:
        _print_quantities(recording, quantities)
    _print_statuses(recording, statuses)
    notes = {name: note_table(recording, name) for name in NOTES}
    _print_notes(notes)
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
        "first_ms": first,
        "levels": levels,
        "quantities": quantities,
        "singular": singular(recording),
        "constraint_status": statuses,
        "estimates": errors,
        **({"rest": found} if found else {}),
        "notes": {
            name: [dict(zip(("line", "frames", "text"), row)) for row in rows] for name, rows in notes.items() if rows
        },
        **of_application,
        "writer": recording.writer,
    }


def _print_old_names(recording: Recording) -> None:
    if recording.old_names:
        names = ", ".join(f"{old} is {new}" for new, old in recording.old_names.items())
        print(f"note: columns of an earlier version have other names now: {names}")


def _print_convergence(found: dict[str, Any]) -> None:
    if found:
        stable, doubtful = found["tangent_positive_definite"], untrusted_words(found)
        print_doubtful(
            f"converged: {counted(found['converged'], 'frame')}, {stable} of them stable{doubtful}; "
            f"not converged: {found['not_converged']}",
            bool(doubtful),
        )


def _print_levels(levels: Sequence[dict[str, Any]], first: float | None) -> None:
    if first is not None:
        print(f"first frame: {si(first / 1e3, 's', 3)}")
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
    if statuses:
        shown = ", ".join(f"{word} in {counted(count, 'frame')}" for word, count in statuses.items())
        print(f"constraint status: {shown}")


def _print_notes(notes: dict[str, list[tuple[int, str, str]]]) -> None:
    """What there is to note of frames, of each column of texts in a table of its own; doubts are orange."""
    from restshape.replay.columns import UNTRUSTED

    for column, (title, head) in NOTES.items():
        if rows := notes[column]:
            print()
            print_table(title, ("line", "frames", head), rows, right=("line",), doubtful=column == UNTRUSTED)


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
    return three_digits(value) if isinstance(value, float) else value
