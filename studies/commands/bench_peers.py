"""The study `restshape bench peers`: the same edits through other solvers."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_drape import chosen
from restshape_studies.commands.bench_kind import Kind
from restshape_studies.peers.cases import CASES
from restshape_studies.peers.installed import PROGRAMS, python_of
from restshape_studies.peers.page import CASE_HEADS, START, START_HEADS, case_rows, start_rows, write_page

from restshape.cli.options import print_table
from restshape.errors import UserError
from restshape.outputs.kinds import PageFile

INSTALLED = Path(".peers")
ALL = (*CASES, START)


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    what = "where scripts/peers.sh has put them (default: %(default)s)"
    parser.add_argument("--installed", type=Path, default=INSTALLED, metavar="DIR", help=what)
    what = f"these of {','.join(PROGRAMS)} (default: those that are installed)"
    parser.add_argument("--peers", default="", metavar="A,B", help=what)
    parser.add_argument("--cases", default="", metavar="A,B", help=f"these of {','.join(ALL)} (default: all)")
    parser.add_argument(
        "--frames", type=int, metavar="N", help="that are timed (default: each case's own, 6 to 20; a drape has one)"
    )
    parser.add_argument("--repeat", type=int, default=3, metavar="R", help="starts of a process (default: %(default)s)")
    parser.add_argument("--page", dest="picture", type=PageFile, metavar="FILE", help="write a page in Markdown")


def check(args: argparse.Namespace) -> None:
    """Refuse scenes, unknown names, peers that are not installed, and numbers that measure nothing."""
    if args.scenes:
        raise UserError("it has scenes and edits of its own", "SCENE", "leave it out")
    if (args.frames is not None and args.frames < 1) or args.repeat < 1:
        raise UserError("this measures nothing", "--frames, --repeat", "at least 1 frame, at least 1 start")
    chosen(args.cases, "cases", ALL)
    args.named = named_peers(args.peers, args.installed)


def named_peers(words: str, folder: Path) -> tuple[str, ...]:
    """The peers that are asked for, or all that are installed in a folder.

    Raises:
        UserError: one that is named is not known or not installed, or none is installed.
    """
    named = chosen(words, "peers", tuple(PROGRAMS))
    for peer in named:
        python_of(peer, folder)
    there = named or tuple(peer for peer in PROGRAMS if (folder / peer / "python").is_file())
    if not there:
        raise UserError(f"no peer is installed in {folder}", "--installed", f"scripts/peers.sh {folder}")
    return there


def own(args: argparse.Namespace) -> list[Case]:
    """Its cases."""
    return [Case(name, Path(), None) for name in chosen(args.cases, "cases", ALL) or ALL]


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """The record of a case."""
    from restshape_studies.peers.comparison import compare, start_times

    if case.name == START:
        return start_times(CASES["static-2000"], args.named, args.installed, args.repeat, announce)
    one = CASES[case.name]
    frames = (args.frames or one.frames) if one.frames else 0
    return compare(one, args.named, args.installed, frames, announce)


def show(_: argparse.Namespace, name: str, found: Mapping[str, Any]) -> None:
    """Print the table of a case."""
    if name == START:
        print_table(
            "from the start of the process to the first answer", START_HEADS, start_rows(found), START_HEADS[1:]
        )
    else:
        print_table(f"{name}: {found['title']}", CASE_HEADS, case_rows(found), CASE_HEADS[1:])


def command_of(args: argparse.Namespace) -> str:
    """The command that this run was."""
    words = ["restshape bench peers"]
    words += [f"--{key} {getattr(args, key)}" for key in ("peers", "cases", "frames") if getattr(args, key)]
    return " ".join([*words, f"--page {args.picture}"])


def draw(found: Mapping[str, Any], args: argparse.Namespace, path: Path) -> None:
    """Write the page."""
    cases = found["still"] if list(found) == ["still"] else found
    single: Sequence[str] = chosen(args.cases, "cases", ALL)
    if "restshape" in cases and len(single) == 1:
        cases = {single[0]: cases}
    write_page(cases, path, command_of(args))


KINDS = (
    Kind(
        "peers",
        "the same edits through DOLFINx, scikit-fem, NGSolve and FreeFEM, cloth through Newton: times, memory, answers",
        declare,
        check,
        measure,
        show,
        scenes="still",
        about="edits on a mesh are compared",
        own=own,
        times="whole frames until the answer, of the processor and of the clock, without estimates and a recorder",
        draw=draw,
    ),
)
