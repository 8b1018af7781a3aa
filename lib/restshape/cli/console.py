"""Where tables and progress are written on a terminal."""

import sys

from rich.console import Console

ORANGE = "#e69f00"
"""What is not to be trusted, on a terminal that has colours."""


class Output(Console):
    """A console that leaves it to the caller what a pipe means whose reader has gone."""

    def on_broken_pipe(self) -> None:
        """Raises the error that there was."""
        raise BrokenPipeError


def console() -> Console:
    """Where tables go on a terminal: as wide as that."""
    return Output(file=sys.stdout, force_terminal=True, highlight=False, soft_wrap=False)
