"""Where tables and progress are written."""

import sys

from rich.console import Console

from restshape.cli.ranks import launched

ORANGE = "#e69f00"
"""What is not to be trusted, on a terminal that has colours."""
ENDLESS = 1_000_000
"""Columns of a table where there is no terminal: a row is one line there, for `grep` and `awk`."""


class Output(Console):
    """A console that leaves it to the caller what a pipe means whose reader has gone."""

    def on_broken_pipe(self) -> None:
        """Raises the error that there was."""
        raise BrokenPipeError


def console() -> Console:
    """Where tables go: as wide as the terminal, or as wide as they come where there is none, or a launcher's."""
    terminal = sys.stdout.isatty() and not launched()
    width = None if terminal else ENDLESS
    return Output(file=sys.stdout, force_terminal=terminal, width=width, highlight=False, soft_wrap=False)
