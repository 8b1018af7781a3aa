"""The entry point `restshape`: picks the command, turns errors into messages and exit codes."""

import argparse
import errno
import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from importlib.metadata import entry_points
from types import ModuleType
from typing import TextIO

from restshape import __version__
from restshape.application import brought_commands
from restshape.cli import lone_process
from restshape.cli.limits import LIMIT_REACHED
from restshape.cli.parser import Parser
from restshape.cli.ranks import first_rank
from restshape.cli.ranks_ending import end_all_ranks, refused
from restshape.cli.signals import ending_signals, exit_code, open_streams
from restshape.errors import UserError, quoted
from restshape.surroundings import start_petsc

COMMANDS = (
    "new",
    "script",
    "check",
    "list",
    "schema",
    "info",
    "replay",
    "live",
    "sweep",
    "report",
    "compare",
    "export",
    "salvage",
)
GROUP = "restshape.commands"
"""Entry points of further commands: modules with SUMMARY, `arguments` and `run`, listed by their PLACE in the help."""
SET_UP_LATER = ("replay",)
"""Commands that say themselves when all is set up that stays: after the first frame."""
EXIT_CODES = (
    "exit codes: 0 success, 1 a check failed, 2 bad input, 3 a limit of time or memory was reached, "
    "128 + N ended by signal N (130: interrupted), "
    "141 nobody reads the output any more"
)
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)
UNREAD = 128 + signal.SIGPIPE
"""What a shell says of a program that ends because nobody reads its output any more."""


def all_commands() -> dict[str, ModuleType]:
    """The modules of the commands that no application brings, by name, imported now, in the order of the help."""
    own = {name: import_module(f"restshape.cli.{name}") for name in COMMANDS}
    others = {entry.name: entry.load() for entry in entry_points(group=GROUP) if entry.name not in own}
    return own | dict(sorted(others.items(), key=lambda item: (item[1].PLACE, item[0])))


def named_command(name: str, petsc: list[str]) -> tuple[str, ModuleType] | None:
    """Summary and module of a command, imported now; None where there is no such command.

    Args:
        name: of the command.
        petsc: words for PETSc, which commands that applications bring may start as soon as they are imported.
    """
    found = import_module(f"restshape.cli.{name}") if name in COMMANDS else None
    found = found or next((entry.load() for entry in entry_points(group=GROUP, name=name)), None)
    if found:
        return found.SUMMARY, found
    brought = [one for many in brought_commands().values() for one in many if one.name == name]
    if brought and petsc:
        start_petsc(petsc)
    return (brought[0].summary, brought[0].load()) if brought else None


def help_parser() -> argparse.ArgumentParser:
    """The parser of the help: it lists all commands, and imports none that applications bring."""
    parser = argparse.ArgumentParser(
        prog="restshape",
        description="Simulates an object while its rest shape is being edited.",
        epilog=f"Everything after -- goes to PETSc's options database. {EXIT_CODES}.",
    )
    parser.add_argument("--version", action="version", version=f"restshape {__version__}")
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, module in all_commands().items():
        subparsers.add_parser(name, help=module.SUMMARY)
    for application, many in brought_commands().items():
        for one in many:
            subparsers.add_parser(one.name, help=f"{application}: {one.summary}")
    return parser


def command_parser(name: str, summary: str, module: ModuleType) -> argparse.ArgumentParser:
    """The argument parser of one command."""
    parser = Parser(prog=f"restshape {name}", description=summary, epilog=EXIT_CODES)
    module.arguments(parser)
    parser.set_defaults(run=module.run, command=name)
    return parser


def main(argv: list[str] | None = None) -> int:
    """The exit code of one command line; by default that of the process, which may end with it."""
    words = list(sys.argv[1:] if argv is None else argv)
    if argv is None:
        lone_process.begin()
        code = _ended(words)
        lone_process.end(code, words)
        return code
    return _ended(words)


def _ended(words: list[str]) -> int:
    """The exit code of the words of a command line, with a message of what has ended it early."""
    open_streams()
    try:
        with ending_signals(), quiet_pipes():
            return _run(words)
    except BrokenPipeError:
        return UNREAD
    except KeyboardInterrupt:
        # While modules were imported, or after all was done.
        if first_rank():
            print("restshape: interrupted", file=sys.stderr)
        return exit_code()
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            print(f"restshape: the name of a file is too long: {quoted(str(error.filename))}", file=sys.stderr)
            print("  try: a shorter name", file=sys.stderr)
            return 2
        if error.errno not in FULL:
            raise
        _leave(sys.stdout)
        print(f"restshape: the output cannot be written: {(error.strerror or '').lower()}", file=sys.stderr)
        return 2


def _run(words: list[str]) -> int:
    """The exit code of the words of a command line, with a message where something is wrong."""
    petsc = words[words.index("--") + 1 :] if "--" in words else []
    words = words[: words.index("--")] if "--" in words else words
    asked = " ".join(words[:1])
    try:
        named = named_command(asked, petsc)
        args = command_parser(asked, *named).parse_args(words[1:]) if named else help_parser().parse_args(words)
        args.petsc, args.words = petsc, words
        from restshape.cli.options import permit, refuse_overwriting

        permit(args)
        refuse_overwriting(args)
        if verbose := getattr(args, "verbose", 0):
            from restshape.cli.verbosity import set_verbosity

            set_verbosity(verbose)
        if asked not in SET_UP_LATER:
            lone_process.set_up()
        return args.run(args)
    except UserError as error:
        refused(f"restshape {asked}: {error}")
        return 2
    except KeyboardInterrupt:
        if first_rank():
            print(f"restshape {asked}: interrupted", file=sys.stderr)
        return exit_code()
    except MemoryError as error:
        end_all_ranks(error, asked)
        print(f"restshape {asked}: not enough memory ({error})", file=sys.stderr)
        print("  try: a coarser mesh, or fewer points", file=sys.stderr)
        return LIMIT_REACHED
    except Exception as error:
        end_all_ranks(error, asked)
        raise


@contextmanager
def quiet_pipes() -> Iterator[None]:
    """Let a pipe whose reader has gone be an error of Python's alone, for all that is printed within.

    PETSc and gmsh end the process with messages of their own at the signal, whenever they are loaded; a signal that is
    blocked they do not see. All is flushed here, for at the end of the process it would be too late to be quiet.
    """
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGPIPE})
    try:
        try:
            yield
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
    except BrokenPipeError:
        _leave(sys.stdout, sys.stderr)
        raise


def _leave(*streams: TextIO) -> None:
    """Lets what waits in streams go nowhere, so that the end of the process does not stumble over it."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in streams:
        os.dup2(nowhere, stream.fileno())
    os.close(nowhere)


if __name__ == "__main__":
    raise SystemExit(main())
