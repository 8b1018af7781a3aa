"""The entry point `restshape`: picks the command, turns errors into messages and exit codes."""

import argparse
import sys
import time
from importlib import import_module

from restshape import __version__
from restshape.cli.ranks import first_rank
from restshape.errors import UserError

COMMANDS = (
    "new",
    "script",
    "check",
    "list",
    "schema",
    "info",
    "replay",
    "report",
    "explain",
    "validate",
    "stability",
    "accuracy",
    "bench",
    "tables",
)
LAST_WORD = 2.0
"""Seconds that the first rank has for its message."""
EXIT_CODES = "exit codes: 0 success, 1 a check failed, 2 bad input, 130 interrupted"


def parser_for(commands: tuple[str, ...]) -> argparse.ArgumentParser:
    """The argument parser, with the full arguments of the commands given and names only of the others."""
    parser = argparse.ArgumentParser(
        prog="restshape",
        description="Simulates an object while its rest shape is being edited.",
        epilog=f"Everything after -- goes to PETSc's options database. {EXIT_CODES}.",
    )
    parser.add_argument("--version", action="version", version=f"restshape {__version__}")
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name in commands:
        module = import_module(f"restshape.cli.{name}")
        sub = subparsers.add_parser(name, help=module.SUMMARY, description=module.SUMMARY, epilog=EXIT_CODES)
        module.arguments(sub)
        sub.set_defaults(run=module.run)
    return parser


def main(argv: list[str] | None = None) -> int:
    """The exit code of one command line."""
    words = list(sys.argv[1:] if argv is None else argv)
    petsc = words[words.index("--") + 1 :] if "--" in words else []
    words = words[: words.index("--")] if "--" in words else words
    named = tuple(word for word in words[:1] if word in COMMANDS)
    args = parser_for(named or COMMANDS).parse_args(words)
    args.petsc, args.words = petsc, words
    try:
        return args.run(args)
    except UserError as error:
        if first_rank():
            print(f"restshape {args.command}: {error}", file=sys.stderr)
        else:
            # mpiexec ends all ranks as soon as one has failed: the first one must have said why by then.
            time.sleep(LAST_WORD)
        return 2
    except KeyboardInterrupt:
        print(f"restshape {args.command}: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        return 0


if __name__ == "__main__":
    raise SystemExit(main())
