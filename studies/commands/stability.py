"""`restshape stability`: hard cases, and random scenes and edits, that must not break."""

import argparse
import json
import math
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from restshape_studies.stability.batch import KINDS

from restshape.cli.options import add_json, print_table, write_json
from restshape.cli.ranks import first_rank, launched
from restshape.cli.verbosity import add_verbose
from restshape.errors import UserError
from restshape.outputs.si_numbers import counted
from restshape.policy import POLICIES
from restshape.surroundings import start_petsc

PLACE = 3
SUMMARY = "hard cases that state what must hold; with --fuzz, random scenes and edits that must not break"
SILENCE = 1800.0
"""Seconds that one case may take."""
EACH = 60.0
"""Seconds of the processor's time that one random example may take."""
SHOWN_MESSAGES = 8
"""Refusals that a fuzz prints, the most frequent ones first."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--case", action="append", default=[], metavar="NAME", help="only this case (several times)")
    parser.add_argument("--list", action="store_true", help="name the cases and stop")
    parser.add_argument(
        "--policy",
        action="append",
        default=[],
        choices=[*POLICIES, "all"],
        help="under this policy (several times; default: those that each case names)",
    )
    parser.add_argument("--share", type=_share, default=1.0, help="of the frames and seeds of long cases (default: 1)")
    parser.add_argument("--fuzz", type=_count, metavar="N", help="play N random scenes and edits instead of the cases")
    parser.add_argument(
        "--kind",
        action="append",
        default=[],
        choices=KINDS,
        help="of the fuzz: examples of this kind alone (several times; default: all)",
    )
    parser.add_argument("--seed", type=int, default=0, help="of the fuzz: the same one gives the same examples")
    parser.add_argument(
        "--resume",
        action="store_true",
        help="of the fuzz: go on with the counts that --json FILE holds, up to N examples in all",
    )
    parser.add_argument("--keep", type=Path, metavar="DIR", help="keep the files of what breaks in the fuzz there")
    parser.add_argument("--seconds", type=float, default=math.inf, metavar="LIMIT", help="begin nothing after so long")
    add_json(parser)
    add_verbose(parser)


def _share(text: str) -> float:
    value = float(text)
    if not 0 < value <= 1:
        raise argparse.ArgumentTypeError("a share is above 0 and at most 1")
    return value


def _count(text: str) -> int:
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError("at least one example is wanted")
    return value


def run(args: argparse.Namespace) -> int:
    """Run the cases or the fuzz; 0 when all holds, 1 when something does not."""
    if args.resume and not args.fuzz:
        raise UserError("cases do not go on", "--resume", "add --fuzz N, or leave it out")
    if args.kind and not args.fuzz:
        raise UserError("cases have no kind", "--kind", "add --fuzz N, or leave it out")
    return _fuzz(args) if args.fuzz else _cases(args)


def _cases(args: argparse.Namespace) -> int:
    if launched():
        # Before anything imports PETSc.
        start_petsc(args.petsc)
    from restshape_studies.stability.suite import cases, jobs, run_apart

    known = cases()
    if args.list:
        if first_rank():
            print("\n".join(f"{name}: {case.summary}" for name, case in known.items()))
        return 0
    wanted = jobs(known, args.case, args.policy)
    if launched():
        rows = _run_here(args, known, wanted)
    else:
        rows = run_apart(wanted, SILENCE, args.share, args.seconds, args.petsc, _print)
    if first_rank():
        failed = [row for row in rows if row["holds"] is False]
        left = sum(row["holds"] is None for row in rows)
        print(f"{len(rows) - left - len(failed)} hold, {len(failed)} fail, {left} left out")
        write_json(args, [{**row, "seconds": _number(row["seconds"])} for row in rows])
    return 0 if all(row["holds"] is not False for row in rows) else 1


def _run_here(args: argparse.Namespace, known: dict[str, Any], wanted: list[tuple[str, str]]) -> list[dict[str, Any]]:
    """The rows of cases that run on all ranks, in this process."""
    from petsc4py import PETSc
    from restshape_studies.stability.case import Trial
    from restshape_studies.stability.suite import not_begun, run_case

    rows: list[dict[str, Any]] = []
    ranks, start = PETSc.COMM_WORLD.tompi4py(), time.monotonic()
    for name, policy in wanted:
        # One clock for all: ranks that disagree would wait for each other for ever.
        if ranks.bcast(time.monotonic() - start >= args.seconds):
            rows.append(not_begun(name, policy, args.seconds))
            _print(rows[-1])
            continue
        with tempfile.TemporaryDirectory(prefix="restshape-stability-") as own:
            rows.append(run_case(name, known[name], Trial(Path(own), policy, args.share)))
            PETSc.COMM_WORLD.barrier()
        _print(rows[-1])
    return rows


def _print(row: dict[str, Any]) -> None:
    """Print the line of a case, on the first rank."""
    if first_rank():
        print(_line(row), flush=True)


def _line(row: dict[str, Any]) -> str:
    """The line of a case."""
    status = {True: "holds", False: "FAILS", None: "left out"}[row["holds"]]
    if row["left_out"]:
        return f"{status:8}  {row['case']}  {row['policy']}  {row['left_out']}"
    value = row["value"] if isinstance(row["value"], str) else f"{row['value']:.3g}"
    more = f" (and {len(row['statements']) - 1} more)" if len(row["statements"]) > 1 else ""
    return f"{status:8}  {row['case']}  {row['policy']}  {row['must']}: {value}{more}  {row['seconds']:.1f} s"


def _outcomes(mutated: dict[str, dict[str, int]]) -> list[tuple[str, int, str]]:
    """A row for each way in which examples were made or damaged: runs, and how many ended with which code."""
    rows = []
    for name, ends in mutated.items():
        rows.append((name, sum(ends.values()), "; ".join(f"{end}: {times}" for end, times in ends.items())))
    return rows


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _fuzz(args: argparse.Namespace) -> int:
    if launched():
        raise UserError("random examples are played on one rank", "--fuzz", "start it without mpiexec")
    for option, given in (("--case", args.case), ("--policy", args.policy), ("--list", args.list)):
        if given:
            raise UserError("the fuzz draws its own scenes and policies", option, "leave out one of the two")
    if args.keep:
        try:
            args.keep.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise UserError(f"{error.strerror}", f"--keep {args.keep}", "name another folder") from error
    from restshape_studies.stability.fuzz import fuzz
    from restshape_studies.verification import verifications

    apps = tuple(app for app, known in verifications().items() if known.random_scenes)
    campaign = {"seed": args.seed, "kinds": args.kind or [*KINDS], "apps": [*apps]}

    def report(tried: Any) -> None:
        print(
            f"{counted(tried.examples, 'example')}, {counted(len(tried.found), 'fault')}, {tried.seconds:.0f} s",
            flush=True,
        )
        write_json(args, {**campaign, **tried.as_dict()})

    before = _before(args, campaign)
    tried = fuzz(
        args.fuzz, args.seed, apps, args.keep, EACH, args.seconds, kinds=args.kind, report=report, before=before
    )
    _print_tried(args.seed, tried.as_dict(), tried.found.values())
    write_json(args, {**campaign, **tried.as_dict()})
    return 1 if tried.found else 0


def _before(args: argparse.Namespace, campaign: dict[str, Any]) -> Any:
    """What the run found that this one goes on with; nothing where it starts again.

    Raises:
        UserError: `--resume` without a file, or with one that no run of the same campaign wrote.
    """
    if not args.resume:
        return None
    if args.json is None:
        raise UserError("there is no file to go on with", "--resume", "name it by --json FILE")
    from restshape_studies.stability.tried import Tried

    if not args.json.exists():
        return None
    try:
        table = json.loads(args.json.read_text(encoding="utf-8"))
        other = [key for key, value in campaign.items() if table[key] != value]
        before = Tried.of(table)
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise UserError("this is no table of a fuzz", f"--json {args.json}", "name another file") from error
    if other:
        raise UserError(f"the file is of another {' and '.join(other)}", f"--json {args.json}", "name another file")
    return before


def _print_tried(seed: int, numbers: dict[str, Any], faults: Iterable[Any]) -> None:
    """Print the tables of a fuzz, and its faults."""
    shown = ("examples", "valid", "refused", "too_large", "broken", "damaged", "written", "repeated")
    shown += ("frames", "refused_frames", "largest")
    times = f"{numbers['seconds']:.0f} s, {numbers['processor_seconds']:.0f} s of the processor"
    print_table(f"fuzz of seed {seed}, {times}", shown, [[numbers[key] for key in shown]], shown)
    print_table("by what was done", ("done", "runs", "ended with"), _outcomes(numbers["mutated"]), ("runs",))
    messages = list(numbers["messages"].items())[:SHOWN_MESSAGES]
    print_table("most frequent refusals", ("times", "message"), [(n, text) for text, n in messages], ("times",))
    for what, times in numbers["warned"].items():
        print(f"warned {times} times: {what}")
    for found in faults:
        print(f"BROKEN  seed {found.seed}, {found.seen} times: {found.what}")
        print(f"  {found.folder or 'not kept (see --keep)'}: {found.command}")
