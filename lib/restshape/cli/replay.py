"""`restshape replay`: replays an edit script against a scene."""

# More than 15 modules: the command joins reading, replaying, recording, progress, signals and output.

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from math import log2
from pathlib import Path
from typing import TYPE_CHECKING, Any

from restshape.application import Application
from restshape.cli.doubtful import print_doubtful, untrusted_words
from restshape.cli.early_libraries import loading_libraries
from restshape.cli.limits import add_limits, keep_frames, lift_limits, limited
from restshape.cli.lone_process import set_up
from restshape.cli.options import add_scene, print_table, read_scene, write_json
from restshape.cli.parity_line import parity_lines
from restshape.cli.parser import add_edits
from restshape.cli.petsc_notes import note_petsc
from restshape.cli.quantity_tables import percent, print_quantities
from restshape.cli.ranks import first_rank
from restshape.cli.ranks_ending import end_all_ranks
from restshape.cli.signals import agreeing
from restshape.cli.verbosity import add_verbose
from restshape.errors import UserError, printable
from restshape.outputs.kinds import CsvFile, RecordingFile
from restshape.outputs.si_numbers import counted, si, unit_of
from restshape.policy import GUESSES, POLICIES
from restshape.replay.level_names import LEVEL_NAMES
from restshape.scene.key_aliases import notes
from restshape.surroundings import start_petsc

if TYPE_CHECKING:
    from restshape.replay.recording.recorder import Recorder
    from restshape.replay.recording.recorder_start import Begun
    from restshape.replay.request import Request
    from restshape.replay.tally import Reason
    from restshape.scene.edit_script import Script
    from restshape.scene.model import Scene

KINDS = ("none", "linear", "gmls")
LEVELS = ("1", "2", "3", "still")
NOT_IN_JSON = ("rows", "reasons", "largest_residual", "scales", "units", "ends", "beside")
SUMMARY = "replay an edit script against a scene: result, cost and error of every frame"


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_scene(parser)
    add_edits(parser, "edit script (.jsonl); default: the first shape only")
    parser.add_argument("--policy", choices=list(POLICIES), help="what is reused (default: the scene's)")
    parser.add_argument(
        "--guess", choices=list(GUESSES), help="initial guess of iterative solves (default: the policy's best)"
    )
    parser.add_argument(
        "--predict",
        choices=KINDS,
        default=KINDS[0],
        help="show the frames of a drag by the design derivative at the press (linear), or at several places (gmls),"
        " and solve on release (default: %(default)s)",
    )
    parser.add_argument(
        "--estimate",
        metavar="WHEN",
        help="frames whose errors are estimated: auto, every, a number N (every N-th), idle or none (solve.estimate)",
    )
    parser.add_argument("--out", type=RecordingFile, metavar="FILE", help="recording (.vtkhdf)")
    parser.add_argument(
        "--fields",
        metavar="NAMES",
        help="what the recording holds besides, with commas between: stress, principal, strain (recording.fields)",
    )
    parser.add_argument("--csv", type=CsvFile, metavar="FILE", help="a row of numbers a frame")
    parser.add_argument("--parity", action="store_true", help="compare each frame with a cold solve on the same mesh")
    parser.add_argument(
        "--regret",
        action="store_true",
        help="count the work of linear solves under every policy, and of the best schedule of refreshes in hindsight",
    )
    parser.add_argument("--strict", action="store_true", help="end with 1 where a frame was refused")
    add_limits(parser)
    add_verbose(parser)
    parser.add_argument("--calibration", type=Path, metavar="FILE", help="seconds a unit of work (default: nominal)")


def run(args: argparse.Namespace) -> int:
    """Replay; 0 when all frames were replayed, 1 when parity fails or --strict finds a refused one, 2 on bad input."""
    _check_regret(args)
    process = _begin_recorder() if args.out and first_rank() else None
    _import_early()
    with limited(args) as begin_frame:
        try:
            request = _request(args)
        except BaseException:
            if process:
                process.abandon()
            raise
        return _regret(args, request, begin_frame) if args.regret else _replayed(args, request, begin_frame, process)


def _begin_recorder() -> Begun:
    """The recorder process, begun before MPI and before all that it does not need."""
    import numpy  # noqa: F401 (it needs that)

    from restshape.replay.recording.recorder_start import begun

    return begun()


def _import_early() -> None:
    """What every request needs: compiled modules, then those of Python beside the kernels' libraries."""
    import numpy  # noqa: F401
    import pydantic_core  # noqa: F401

    with loading_libraries():
        import restshape.replay.request
        import restshape.scene.load  # noqa: F401


def _request(args: argparse.Namespace) -> Request:
    """What is asked for, its scene and script read.

    Raises:
        UserError: it cannot be replayed, or not be recorded there.
    """
    from restshape.calibration import Calibration
    from restshape.replay.recording.request_recorder import refuse_other_names
    from restshape.replay.request import Request
    from restshape.scene.edit_script import load_script

    if args.fields is not None:
        names = [name.strip() for name in args.fields.split(",") if name.strip()]
        args.set = [*args.set, f"recording.fields={json.dumps(names)}"]
    if args.estimate is not None:
        given = args.estimate if args.estimate.isdecimal() else json.dumps(args.estimate)
        args.set = [*args.set, f"solve.estimate={given}"]
    scene = read_scene(args)
    if args.out:
        refuse_other_names(args.out, "--out ")
    script = load_script(args.edits, scene, keep_good=True) if args.edits else None
    known = Calibration.load(args.calibration)
    if args.out and first_rank():
        from restshape.replay.recording.recorder import refuse_other_files

        refuse_other_files(args.out)
    return Request.of(scene, script, args.policy, args.guess, known, args.petsc, args.predict, args.set)


def _replayed(
    args: argparse.Namespace, request: Request, begin_frame: Callable[[], None], process: Begun | None
) -> int:
    """The exit code of a replay that says when each frame begins, with the process that will record it."""
    from restshape.replay.recording.request_recorder import recorder_of

    first = first_rank()
    recorder = recorder_of(request, args.out, process) if process else None
    try:
        if recorder:
            keep_frames(recorder)
        if first:
            _note_start(args, request.scene, request.script)
        summary = _run(args, request, recorder, begin_frame)
        lift_limits()
    except BaseException as error:
        lift_limits()
        if recorder:
            recorder.close("interrupted")
        # A file that cannot be written is known to the first rank only.
        if not isinstance(error, UserError) or error.where in (str(args.out), str(args.csv)):
            end_all_ranks(error, "replay")
        raise
    if recorder:
        summary["recording"] = recorder.close("interrupted" if summary["interrupted"] else "done")
    if first:
        note_petsc(args.petsc)
    code = _print_and_write(args, request, summary) if first else 0
    if summary["interrupted"]:
        raise KeyboardInterrupt
    return code


def _note_start(args: argparse.Namespace, scene: Scene, script: Script) -> None:
    """Print what is to be known before the first frame."""
    from restshape.cli.shipped import scripts_of
    from restshape.cli.start_notes import start_notes

    for note in start_notes(scene, script):
        print(f"note: {note}", file=sys.stderr)
    if args.predict == "gmls" and len({event.t for event in script.events}) == 1 < len(script.events):
        note = "all events have one edit time: no time is left to take samples in, but at the press"
        print(f"note: {note}", file=sys.stderr)
    if args.fields is not None and not args.out:
        print("note: --fields is of a recording: without --out FILE.vtkhdf it does nothing", file=sys.stderr)
    if not args.edits and (known := scripts_of(args.scene)):
        print(f"note: the first shape only; its edits: {', '.join(map(str, known))}", file=sys.stderr)


BESIDE_REGRET = ("out", "fields", "csv", "parity", "policy", "guess", "predict", "estimate", "strict")
"""Options of one replay, which --regret refuses."""


def _check_regret(args: argparse.Namespace) -> None:
    """Refuse options of one replay beside --regret."""
    given = [name for name in BESIDE_REGRET if getattr(args, name) not in (None, False, "none")]
    if args.regret and given:
        what = "replays of all policies are counted, without estimates and predictions, and none of them is kept"
        raise UserError(what, f"--regret --{given[0]}", f"leave --{given[0]} out")


def _regret(args: argparse.Namespace, request: Request, begin_frame: Callable[[], None]) -> int:
    """Print the counted work of a replay beside the best that could have been done; 0."""
    start_petsc(args.petsc)
    from restshape.cli.regret_tables import print_regret
    from restshape.variation.regret import measure

    found = measure(request, begin_frame)
    if first_rank():
        print_regret(found)
        write_json(args, {"origin": request.origin(), "regret": found})
    return 0


def _run(
    args: argparse.Namespace, request: Request, recorder: Recorder | None, begin_frame: Callable[[], None]
) -> dict[str, Any]:
    """Start PETSc, run all frames, and sum up."""
    start_petsc(args.petsc)
    from petsc4py import PETSc

    from restshape.cli.progress import progress
    from restshape.interface.run import Run

    frames = request.script.frame_count
    with progress(not first_rank(), frames) as count, agreeing(PETSc.COMM_WORLD.tompi4py()) as end_if_asked:

        def on_frame() -> None:
            set_up()
            end_if_asked()
            begin_frame()
            count(1)

        return Run(request, recorder, parity=args.parity, csv=args.csv, say=count.say).to_end(on_frame)


def _print_and_write(args: argparse.Namespace, request: Request, summary: dict[str, Any]) -> int:
    """Print the tables, write the JSON file, and give the exit code."""
    summary["units"] = {name: unit_of(one.unit) for name, one in request.scene.quantities.items()}
    ends, values = summary["ends"], summary["quantities"]
    summary["beside"] = {
        name: [one.kinds[one.kind].said(values[name][k], ends[k]) for k in (0, -1)]
        for name, one in request.scene.quantities.items()
        if name in values
    }
    # What is printed may find nobody who reads it.
    found = {key: value for key, value in summary.items() if key not in NOT_IN_JSON}
    if args.json:
        # Where it comes from takes longer to find out than a dozen frames.
        write_json(args, {"origin": request.origin(), **found})
    for note in notes(request.scene.raw):
        print(f"note: {note}")
    print_summary(summary, request.application)
    if request.script.error:
        kept = "replayed and recorded" if args.out else "replayed"
        frames = summary["frames"]
        before = "the frame before it was" if frames == 1 else f"the {frames} frames before it were"
        raise UserError(f"{request.script.error}\n  {before} {kept}")
    return int((args.parity and not summary["parity"]["holds"]) or (args.strict and summary["refused"] > 0))


def print_summary(summary: dict[str, Any], application: Application) -> None:
    """Print the tables of a summary of a replay of an application."""
    print(
        f"{counted(summary['frames'], 'frame')}, {summary['refused']} refused, "
        f"{counted(summary['unknowns'], 'unknown')}, {counted(summary['elements'], 'element')}, "
        f"policy {summary['policy']}, initial guess {summary['guess']}, {counted(summary['ranks'], 'rank')}"
    )
    for column, reasons in summary["reasons"].items():
        _print_reasons(column, reasons)
    heads = ("level", "frames", "p50 [ms]", "p95 [ms]", "p99 [ms]", "iterations", "factorisations")
    counts, times = summary["levels"] | {"still": summary["still"]}, summary["ms"]
    work = summary["iterations_by_level"], summary["refreshes_by_level"]
    rows = [
        (
            LEVEL_NAMES[k],
            counts[k],
            *(f"{v:.3f}" if counts[k] else "-" for v in times[k].values()),
            *(f"{done[k]:,}" for done in work),
        )
        for k in LEVELS
        if counts[k] or k != "still"
    ]
    print_table("time a frame", heads, rows, right=heads[1:])
    parts = summary["python_ms"]["1"], summary["beside_ms"]["1"]
    python = "Python in a level-1 frame: {:.3f} ms, residual, errors and recording {:.3f} ms (p50)\n".format(*parts)
    python = python if counts["1"] else ""
    python = first_frame(summary["first_ms"]) + python
    print(
        f"{python}{counted(summary['iterations'], 'iteration')}, {counted(summary['refreshes'], 'factorisation')}, "
        f"largest true residual {summary['largest_residual']:.1e}"
    )
    if summary["predicted"]:
        ms = summary["predicted_ms"]["p50"]
        print(
            f"{counted(summary['predicted'], 'frame')} predicted, {ms:.3f} ms each (p50), "
            f"{1e3 / ms:,.0f} frames a second"
        )
    if found := summary.get("rest"):
        print_doubtful(convergence_line(found), bool(found["untrusted"]))
    for line in estimates(summary):
        print(line)
    print_quantities(summary)
    if status := summary["constraint_status"]:
        violated = status["violated_constraints"]
        last = f"{status['last']} at the end{violated and ' for ' + violated}"
        doubtful = f", uncertain in {status['uncertain']}" if status["uncertain"] else ""
        print(
            f"constraint status: {last}; holds in {counted(status['holds'], 'frame')}, "
            f"fails in {status['fails']}{doubtful}"
        )
    if application.report:
        application.report.print_tables(summary["rows"])
    if "parity" in summary:
        for line in parity_lines(summary["parity"]):
            print(line)


def first_frame(ms: float | None) -> str:
    """A line on the time of the first frame, which is made from nothing and in no other row; empty where none is."""
    return "" if ms is None else f"first frame: {si(ms / 1e3, 's', 3)}\n"


def convergence_line(found: dict[str, Any]) -> str:
    """What a summary reports of convergence, in one line."""
    frames = found["converged"] + found["not_converged"]
    residual = "-" if found["residual"] is None else f"{found['residual']:.1e}"
    return (
        f"converged: {found['converged']} of {counted(frames, 'frame')}, "
        f"{found['tangent_positive_definite']} of them stable{untrusted_words(found)}; "
        f"largest residual {residual} of the weight (of the supports' forces without weight)"
    )


def estimates(summary: dict[str, Any]) -> list[str]:
    """What a summary reports of errors, a line each: of mesh, time steps and predictions."""
    mesh, step = summary["estimate"], summary["estimate_time"]
    ahead, jump = summary["predicted_estimate"], summary["prediction_error"]
    lines = []
    if mesh["p50"] is not None:
        lines.append(f"estimated error ({mesh['of']}): {_distribution(mesh)}")
    if step["p50"] is not None:
        lines.append(
            f"estimated error of single time steps (over the largest value of a frame so far): {_distribution(step)}"
        )
    if ahead["p50"] is not None:
        lines.append(f"predicted frames, estimated distance from the solution: {_distribution(ahead)}")
    if jump["p50"] is not None:
        most = jump["max"]
        cents = f" ({1200 * log2(1 + most):.3g} cents)" if mesh["of"] == "frequencies" else ""
        lines.append(f"predicted against solved, where a solve followed: at most {percent(most)}{cents}")
    return lines


def _distribution(found: dict[str, float]) -> str:
    return f"median {percent(found['p50'])}, largest {percent(found['max'])}"


def _print_reasons(column: str, reasons: dict[str, Reason], most: int = 5) -> None:
    """Print why frames were refused, or what there is to note, with the frames that say so but for numbers."""
    from restshape.replay.columns import UNTRUSTED

    for one in list(reasons.values())[:most]:
        worst = f", worst in {one.worst}" if one.worst != one.frame else ""
        more = f" ({counted(one.count, 'frame')} up to {one.last}{worst})" if one.count > 1 else ""
        line = printable(f"  {column}, line {one.line}, frame {one.frame}{more}: {one.text}")
        print_doubtful(line, column == UNTRUSTED)
    if len(reasons) > most:
        print(f"  ... and {counted(len(reasons) - most, 'more reason')}: see the recording or --csv")
