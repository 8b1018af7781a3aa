"""`restshape sweep`: one scene with one value after the other, in one process."""

# More than 15 modules: the command joins reading, running, a table, a file and a picture, progress and signals.

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from math import isfinite, prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

from restshape.cli.limits import add_limits, lift_limits, limited
from restshape.cli.options import add_scene, print_table, refuse_files_of_scene, write_json
from restshape.cli.parser import add_edits
from restshape.cli.petsc_notes import note_petsc
from restshape.cli.quantity_cells import MISSING, shared_size
from restshape.cli.ranks import first_rank
from restshape.cli.signals import agreeing
from restshape.cli.verbosity import add_verbose
from restshape.errors import UserError, one_line, printable
from restshape.outputs.kinds import PictureFile, SweepFile
from restshape.outputs.si_numbers import counted, si, unit_of
from restshape.policy import GUESSES, POLICIES
from restshape.surroundings import start_petsc

if TYPE_CHECKING:
    from restshape.scene.model import Scene
    from restshape.variation.runs import Sweep
    from restshape.variation.swept_key import SweptKey
    from restshape.variation.swept_run import SweptRun

SUMMARY = "replay a scene with one value after the other: a table and a picture of its quantities"


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_scene(parser, "KEY=VALUE, KEY=FROM:TO:STEP or KEY=A,B,C", "a key and its values, e.g. E=60GPa:80GPa:5GPa")
    add_edits(parser, "edit script (.jsonl); default: the first shape only")
    parser.add_argument("--policy", choices=list(POLICIES), help="what is reused (default: the scene's)")
    parser.add_argument("--guess", choices=list(GUESSES), help="initial guess of iterative solves")
    parser.add_argument("--csv", type=SweepFile, metavar="FILE", help="a row a run")
    parser.add_argument("--out", type=PictureFile, metavar="FILE", help="picture of each quantity (.png, .svg)")
    parser.add_argument(
        "--from-rest",
        action="store_true",
        help="each run has a mesh of its own and modes numbered by rank, and nonlinear ones find their solution from "
        "rest, not from that of the run before, whose branch they follow",
    )
    add_limits(parser)
    add_verbose(parser)
    parser.add_argument("--calibration", type=Path, metavar="FILE", help="seconds a unit of work (default: nominal)")


def run(args: argparse.Namespace) -> int:
    """Run all values; 0 where one of them has a result, 2 on bad input."""
    with limited(args) as begin_frame:
        return _swept(args, begin_frame)


def _swept(args: argparse.Namespace, begin_frame: Callable[[], None]) -> int:
    """The exit code of a sweep that says when each frame begins."""
    from restshape.calibration import Calibration
    from restshape.variation.swept_key import swept_keys

    fixed, swept = swept_keys(args.set)
    start_petsc(args.petsc)
    from restshape.variation.runs import Sweep
    from restshape.variation.sweep_request import SweepRequest

    calibration = Calibration.load(args.calibration)
    chosen = (args.policy, args.guess, calibration, not args.from_rest, tuple(args.petsc))
    request = SweepRequest(args.scene, fixed, swept, args.edits, *chosen)
    sweep, runs = Sweep(request), []
    interrupted = _run_all(args, sweep, swept, runs, begin_frame)
    lift_limits()
    if first_rank():
        note_petsc(args.petsc)
        _write(args, sweep, swept, runs, interrupted)
    if interrupted:
        raise KeyboardInterrupt
    return 0


def _run_all(
    args: argparse.Namespace,
    sweep: Sweep,
    swept: list[SweptKey],
    runs: list[SweptRun],
    begin_frame: Callable[[], None],
) -> bool:
    """Put each run into the list and its row into the CSV file; whether a signal has ended the sweep."""
    from petsc4py import PETSc

    from restshape.cli.progress import progress

    first = first_rank()
    with (
        progress(not first, prod(len(one.values) for one in swept), "runs") as count,
        agreeing(PETSc.COMM_WORLD.tompi4py()) as end_if_asked,
        ExitStack() as files,
    ):

        def on_frame() -> None:
            end_if_asked()
            begin_frame()
            count(0)

        rows = CsvRows(args.csv if first else None, [one.key for one in swept], bool(args.edits), files)
        try:
            for one in sweep.runs(on_frame):
                if sweep.scene:
                    refuse_files_of_scene(args, sweep.scene)
                if first and sweep.scene and not any(before.frames for before in runs):
                    _print_notes(sweep.scene)
                runs.append(one)
                rows.add(one, sweep)
                count(1)
                begin_frame()
        except KeyboardInterrupt:
            if not runs:
                raise
            return True
    return False


def _print_notes(scene: Scene) -> None:
    """Print what makes the answers of a scene bad, and names of its keys today."""
    from restshape.application import application_of
    from restshape.scene.key_aliases import notes
    from restshape.scene.plan import plan

    for note in (*plan(scene, application_of(scene)).warnings, *notes(scene.raw)):
        print(f"note: {note}", file=sys.stderr)


class CsvRows:
    """Writes rows of runs; those before the first valid one wait for it, which knows the columns.

    Args:
        path: of the file; None writes none.
        keys: that are swept.
        several: runs have several frames.
        files: closes the file.
    """

    def __init__(self, path: Path | None, keys: list[str], several: bool, files: ExitStack) -> None:
        self.path, self.keys, self.several, self.files = path, keys, several, files
        self._waiting: list[SweptRun] = []
        self._write: Callable[..., None] | None = None

    def add(self, run: SweptRun, sweep: Sweep) -> None:
        """Write the row of a run."""
        if not self.path:
            return
        self._waiting.append(run)
        if self._write is None and sweep.columns is not None:
            from restshape.replay.recording.row_table import table_of_rows
            from restshape.variation.swept_run import column_names

            names = column_names(self.keys, sweep.columns, self.several)
            self._write = self.files.enter_context(table_of_rows(self.path, names, SweepFile))
        if self._write:
            for one in self._waiting:
                self._write(one.table_row(self.several))
            self._waiting = []


def _write(
    args: argparse.Namespace, sweep: Sweep, swept: list[SweptKey], runs: list[SweptRun], interrupted: bool
) -> None:
    """Print the table, and write the JSON file and the picture."""
    from restshape.replay.singular_notes import singular_notes
    from restshape.variation.sweep_notes import sweep_notes
    from restshape.variation.swept_run import REUSED

    data = {
        "scene": str(args.scene),
        "edits": str(args.edits) if args.edits else None,
        "keys": [one.key for one in swept],
        "interrupted": interrupted,
        "singular": sweep.singular,
        "notes": (notes := sweep_notes(runs)),
        "runs": [one.plain() for one in runs],
    }
    write_json(args, data)
    if not any(one.frames for one in runs):
        raise UserError(f"no run has a result; the first one, {_values(runs[0])}: {runs[0].why}")
    reused = sum(one.analysis == REUSED for one in runs)
    seconds = sum(one.cpu_s for one in runs)
    print(
        f"{counted(len(runs), 'run')}, {reused} of them with the analysis of the run before, "
        f"{seconds:.2f} s of processor time"
    )
    _print_runs(args, sweep, swept, runs)
    for note in (*singular_notes(sweep.singular), *notes):
        print(note)
    if failed := [one for one in runs if one.why]:
        for one in failed[:5]:
            print(printable(f"  {_values(one)}, {one.status}: {one.why}"), file=sys.stderr)
        if len(failed) > 5:
            print(f"  ... and {len(failed) - 5} more: see --csv or --json", file=sys.stderr)
    if args.out and sweep.scene:
        from restshape.outputs.picture_files import drawn_from, fingerprint
        from restshape.variation.sweep_picture import draw_sweep

        try:
            with drawn_from(fingerprint(data)):
                draw_sweep(sweep.scene, swept, runs, args.out, bool(args.edits), sweep.singular, notes)
        except OSError as error:
            raise UserError(f"cannot be written: {error.strerror}", f"--out {args.out}", "name another file") from error
        print(f"wrote {one_line(args.out)}")


def _values(run: SweptRun) -> str:
    """The values of a run."""
    return ", ".join(f"{key} = {value}".replace('"', "") for key, value in run.values.items())


def _print_runs(args: argparse.Namespace, sweep: Sweep, swept: list[SweptKey], runs: list[SweptRun]) -> None:
    """Print a row a run: its values, its status, and each quantity at the end and its extremes."""
    from restshape.replay.level_names import MOVES
    from restshape.variation.sweep_notes import meshes_moved
    from restshape.variation.swept_run import run_scales

    keys, columns = [one.key for one in swept], sweep.columns or []
    levels = ["level"] * any(meshes_moved(runs))
    parts = ("", " min", " max") if args.edits else ("",)
    heads = [*keys, "status", *levels, *(f"{name.removeprefix('q_')}{part}" for name in columns for part in parts)]
    if args.edits:
        heads[len(keys) + 1 + len(levels) : len(keys) + 1 + len(levels)] = ["frames", "refused"]
    rows, sizes = [], run_scales(sweep.scene, runs)
    table = [one.table_row(bool(args.edits)) for one in runs]
    likes = _sizes(columns, parts, sweep, table)
    for one, row in zip(runs, table):
        shown = [_cells(row, name, parts, sweep, sizes[name], likes[name]) for name in columns]
        counts = [one.frames, one.refused] if args.edits else []
        level = [f"{one.level} {MOVES[one.level]}" if one.level in MOVES else ""] * len(levels)
        values = [cell for many in shown for cell in many]
        rows.append([*(row[key] for key in keys), one.outcome, *level, *counts, *values])
    print_table("quantities", heads, rows, right=heads[len(keys) + 1 :])


def _sizes(
    columns: Sequence[str], parts: Sequence[str], sweep: Sweep, rows: Sequence[dict[str, Any]]
) -> dict[str, float]:
    """The size whose prefix all values of a quantity have: that of the largest; lengths of a table have one unit."""
    found = {}
    for name in columns:
        names = [f"{name}{part.replace(' ', '_')}" for part in parts]
        known = [abs(value) for row in rows for one in names if (value := row.get(one)) is not None]
        found[name] = max((value for value in known if isfinite(value)), default=0.0)
    lengths = [name for name in columns if _unit(sweep, name) == "m"]
    return found | {name: shared_size(found[name], [found[one] for one in lengths]) for name in lengths}


def _unit(sweep: Sweep, column: str) -> str:
    """The SI unit of a quantity; empty where it has none."""
    quantity = sweep.scene.quantities.get(column.removeprefix("q_")) if sweep.scene else None
    return unit_of(quantity.unit) if quantity else ""


def _cells(row: dict[str, Any], name: str, parts: Sequence[str], sweep: Sweep, size: float, like: float) -> list[str]:
    """The values of a quantity in the row of a run: at the end, and where there are several frames its extremes.

    Args:
        size: of the quantity in all runs; what is rounding beside it is shown as 0.
        like: the size whose prefix all runs have.
    """
    from restshape.replay.rounding import cleared

    names = [f"{name}{part.replace(' ', '_')}" for part in parts]
    known = [None if (value := row.get(one)) is None or value != value else cleared(value, size) for one in names]
    return [MISSING if value is None else si(value, _unit(sweep, name), 6, like) for value in known]
