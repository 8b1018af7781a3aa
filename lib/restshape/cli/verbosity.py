"""The options -v and -vv: what was decided in each frame and why, in the words of PETSc's monitors."""

import argparse
import logging
import os
import sys

from restshape.cli.ranks import first_rank

LEVELS = (logging.WARNING, logging.INFO, logging.DEBUG)
INHERITED = "RESTSHAPE_VERBOSE"
"""Variable of the environment that holds, for the processes of a command, how many -v it has."""


def add_verbose(parser: argparse.ArgumentParser) -> None:
    """Adds ``-v``, which may come twice."""
    parser.add_argument(
        "-v",
        "--verbose",
        action="count",
        default=0,
        help="log to stderr what was decided and why: mesh, preconditioner, solution strategy; -vv: each iteration too",
    )


def set_verbosity(count: int) -> None:
    """Logs to stderr, on the first rank alone, what so many -v ask for."""
    if not count or not first_rank():
        return
    logger = logging.getLogger("restshape")
    handler = StandardError()
    handler.setFormatter(Indented())
    logger.addHandler(handler)
    logger.setLevel(LEVELS[min(count, len(LEVELS) - 1)])
    logger.propagate = False
    os.environ[INHERITED] = str(count)


def inherit_verbosity() -> None:
    """Logs, in a process that a command has started, as the command does."""
    set_verbosity(int(os.environ.get(INHERITED, "0")))


def relay(text: str) -> None:
    """Writes to stderr what such a process has written there, where -v asks for it."""
    if os.environ.get(INHERITED):
        print(text, end="", file=sys.stderr, flush=True)


class StandardError(logging.Handler):
    """Writes to whatever stderr is at the time: a progress bar puts another one in its place."""

    def emit(self, record: logging.LogRecord) -> None:
        """Writes one line."""
        print(self.format(record), file=sys.stderr, flush=True)


class Indented(logging.Formatter):
    """Lines of the package they come from; those of each iteration are indented, as PETSc's monitors do it."""

    def format(self, record: logging.LogRecord) -> str:
        """One line."""
        indent = "  " if record.levelno < logging.INFO else ""
        return f"{record.name.removeprefix('restshape.')}: {indent}{record.getMessage()}"
