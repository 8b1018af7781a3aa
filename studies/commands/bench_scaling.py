"""The study `restshape bench scaling`: the same edits on several numbers of ranks."""

from __future__ import annotations

import argparse
import os
import shlex
from pathlib import Path
from typing import Any

from restshape_studies.bench.rank_job import cores
from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import FRAMES, Kind, add_frames, add_policy, add_repeat, check_runs, job_of
from restshape_studies.commands.bench_limit import triangles

from restshape.cli.options import print_table
from restshape.errors import UserError
from restshape.outputs.atomic_files import writable, write_whole
from restshape.outputs.claims import refuse_foreign
from restshape.outputs.kinds import JobScriptFile, PageFile
from restshape.surroundings import cpu_model

MODES = ("strong", "weak")
PAGE, SCRIPT = "README.md", "scaling.sbatch"
MOST = 4096
"""Ranks at most."""
CLUSTER = 64
"""Ranks that the job script asks for at least."""


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--ranks", default="1,2", metavar="N,N", help="numbers of ranks (default: %(default)s)")
    parser.add_argument("--strong", action="store_true", help="one mesh on all numbers of ranks (default)")
    parser.add_argument("--weak", action="store_true", help="finer meshes, so that each rank has as many unknowns")
    what = "about how many on the first number of ranks, a mesh each (default: the scene's mesh)"
    parser.add_argument("--triangles", default="", metavar="N,N", help=what)
    add_policy(parser)
    add_frames(parser)
    add_repeat(parser)
    parser.set_defaults(repeat=1, out=Path("results/scaling"))
    parser.add_argument("--oversubscribe", action="store_true", help="let ranks share cores, which says little of time")


def ranks_of(args: argparse.Namespace) -> tuple[int, ...]:
    """Numbers of ranks that are asked for, ascending.

    Raises:
        UserError: they are no such numbers, or more than there are cores.
    """
    words = args.ranks.split(",")
    found = sorted({int(word) for word in words if word.strip().isdecimal()})
    if not all(word.strip().isdecimal() for word in words) or not 1 <= found[0] <= found[-1] <= MOST:
        raise UserError(f"{args.ranks!r} is no list of numbers of ranks", "--ranks", "--ranks 1,2")
    if found[-1] > cores() and not args.oversubscribe:
        what = f"{found[-1]} ranks are more than the {cores()} cores that there are here"
        do = "take fewer ranks; with --oversubscribe they share cores, and times say little"
        raise UserError(what, "--ranks", do)
    return tuple(found)


def check(args: argparse.Namespace) -> None:
    """Refuse what measures nothing, and files that are not to be replaced, before any work."""
    check_runs(args)
    ranks_of(args)
    args.named = str(args.scenes[0])
    if args.triangles:
        triangles(args)
    for path in (PageFile(args.out / PAGE), JobScriptFile(args.out / SCRIPT)):
        refuse_foreign(path, f"--out {args.out}")
        try:
            if args.out.is_dir():
                writable(path)
        except OSError as error:
            what = f"{path} cannot be written: {error.strerror}"
            raise UserError(what, "--out", "choose another folder") from error


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """The record of a scene."""
    from restshape_studies.bench.scaling import Plan, study

    modes = tuple(mode for mode in MODES if getattr(args, mode)) or MODES[:1]
    counts = tuple(triangles(args)) if args.triangles else ()
    plan = Plan(ranks_of(args), modes, counts, args.repeat, args.oversubscribe)
    load = os.getloadavg()[0]
    found = study(case.name, job_of(args, case), plan, announce)
    asked = {"scene": args.named, "edits": str(args.edits or ""), "overrides": list(args.set)}
    asked |= {"modes": list(modes), "triangles": args.triangles, "ranks": list(plan.ranks)}
    return {"command": command_of(args), "machine_name": cpu_model(), "load": load, "asked": asked, **found}


def command_of(args: argparse.Namespace) -> str:
    """The command that this run is."""
    return shlex.join(["restshape", *args.words])


def show(_: argparse.Namespace, name: str, found: dict[str, Any]) -> None:
    """Print all tables of a scene."""
    from restshape_studies.bench.scaling_page import remarks, tables

    for one in tables(found):
        print_table(f"{name}: {one.title}", one.heads, one.rows, right=one.heads[1:])
        print()
    for words in remarks(found):
        print(words)


def draw(found: dict[str, Any], args: argparse.Namespace, path: Path) -> None:
    """Draw the picture, and write the page and the job script beside it."""
    from restshape_studies.bench.cluster_script import Measured, job_script
    from restshape_studies.bench.scaling_page import write_page
    from restshape_studies.pictures.ranks import draw_ranks

    ((name, one),) = found.items()
    draw_ranks(name, one, path)
    write_page(name, one, path.with_name(PAGE))
    asked = dict(one["asked"])
    ranks, most = asked.pop("ranks"), max(asked_ranks(one))
    more = [2**k for k in range(most.bit_length())]
    write_whole(path.with_name(SCRIPT), job_script(Measured(**asked, ranks=sorted({*ranks, *more}))))


def asked_ranks(one: dict[str, Any]) -> list[int]:
    """Ranks that were run, those of the model, and `CLUSTER`."""
    beyond = [entry["ranks"] for run in one["runs"] if run["model"] for entry in run["model"]["beyond"]]
    return [*one["asked"]["ranks"], *beyond, CLUSTER]


KINDS = (
    Kind(
        "scaling",
        "the same edits on several numbers of ranks, beside what the memory allows",
        declare,
        check,
        measure,
        show,
        about="ranks share meshes",
        picture="scaling.png",
        times=FRAMES,
        draw=draw,
    ),
)
