"""The study `restshape bench live`: how soon and how often a hand in the browser sees its answers."""

import argparse
import json
import os
import tempfile
from pathlib import Path
from typing import Any

from restshape_studies.bench.job import Job, run
from restshape_studies.bench.live_drag import browser
from restshape_studies.bench.live_sessions import PLATE, SESSIONS
from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_drape import chosen
from restshape_studies.commands.bench_kind import Kind

from restshape.cli.options import print_table
from restshape.errors import UserError

BESIDE = "beside"
ALL = (*SESSIONS, BESIDE)
QUIET = 0.1
"""Cores that other programs may use before times are doubtful."""
PLACES = 300
OWN = ("simulating process", "server", "renderer", "GPU process", "browser")


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--cases", default="", metavar="A,B", help=f"these of {','.join(ALL)} (default: all)")
    what = "of the mouse in a drag, at 125 Hz (default: %(default)s)"
    parser.add_argument("--places", type=int, default=PLACES, metavar="N", help=what)
    parser.add_argument("--quiet", action="store_true", help="refuse to measure while other programs run")


def check(args: argparse.Namespace) -> None:
    """Refuse scenes, unknown names, and what cannot measure."""
    if args.scenes:
        raise UserError("it has scenes of its own", "SCENE", "leave it out")
    if args.places < 10:
        raise UserError(f"{args.places} places measure nothing", "--places", "at least 10")
    names = chosen(args.cases, "cases", ALL) or ALL
    if any(name != BESIDE for name in names):
        browser()
    load, cores = os.getloadavg()[0], os.cpu_count() or 1
    if args.quiet and load > 0.25 * cores:
        what = f"the machine is busy: its load is {load:.2g} on {cores} cores"
        raise UserError(what, "--quiet", "wait until other programs have ended, or leave it out")


def own(args: argparse.Namespace) -> list[Case]:
    """Its cases."""
    return [Case(name, Path(), None) for name in chosen(args.cases, "cases", ALL) or ALL]


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """What is found of a session, or of live frames beside a replay."""
    announce(case.name)
    load = os.getloadavg()[0]
    found = _beside(args) if case.name == BESIDE else SESSIONS[case.name].measured(args.places, args.set)
    return {"load": load, **found}


def _beside(args: argparse.Namespace) -> dict[str, Any]:
    """Live frames and frames of a hand beside those of a replay, in a process of their own."""
    with tempfile.TemporaryDirectory(prefix="restshape-bench-") as folder:
        script = Path(folder) / "drag.jsonl"
        script.write_text("".join(json.dumps(line) + "\n" for line in PLATE.script(args.places)))
        job = Job(
            str(PLATE.scene),
            str(script),
            "auto",
            (*PLATE.overrides, *args.set),
            tuple(args.petsc),
            measure="live_beside",
        )
        outcome = run(job)
    if outcome.found is None:
        raise UserError(f"the process {outcome.problem}", BESIDE, "start it again")
    return outcome.found


def show(_: argparse.Namespace, name: str, found: dict[str, Any]) -> None:
    """Print the table of a case."""
    if name == BESIDE:
        heads = ("replay [ms]", "live, more [ms]", "of it frames", "hand.to, more [us]", "frames")
        row = [
            f"{found['replay_ms']:.3g}",
            f"{found['live_more_ms']:.3f}",
            f"{found['frames_more_ms']:.3f}",
            f"{1e3 * found['hand_more_ms']:.1f}",
            str(found["frames"]),
        ]
        print_table(
            "the simulating process beside a replay of the same script, processor time a frame", heads, [row], heads
        )
        return
    heads = [
        "shown, p50 [ms]",
        "p95 [ms]",
        "frames/s",
        "empty drag",
        "share",
        "answers",
        "kB a frame",
        "first answer [s]",
    ]
    row = [f"{found['shown_ms'][key]:.1f}" for key in ("p50", "p95")]
    row += [
        f"{found['frames_per_second']:.1f}",
        f"{found['ceiling_per_second']:.1f}",
        f"{found['frames_per_second'] / found['ceiling_per_second']:.3f}",
        str(found["answers"]),
        f"{found['bytes'] / 1e3:.1f}",
        f"{found['first_s']:.2f}",
    ]
    if "rest_s" in found:
        heads, row = [*heads, "rest after [s]"], [*row, f"{found['rest_s']:.2f}"]
    quiet = found["elsewhere"] <= QUIET
    others = f"other programs used {found['elsewhere']:.2f} cores" + ("" if quiet else ": times are doubtful")
    print_table(
        f"{name}: {SESSIONS[name].title}, holding {found['held']} ({others})", heads, [row], heads, doubtful=not quiet
    )
    used = found["processor_ms"]
    print_table("processor time a drawn frame [ms]", OWN, [[f"{used.get(kind, 0.0):.2g}" for kind in OWN]], OWN)


KINDS = (
    Kind(
        "live",
        "how soon and how often a hand in the browser sees its answers",
        declare,
        check,
        measure,
        show,
        scenes="still",
        own=own,
        times="the clock, until the page has drawn, and of the processor where it is named",
    ),
)
