"""Lines on what is not to be trusted, which are orange on a terminal."""

from collections.abc import Mapping
from typing import Any

from restshape.cli.terminal import on_terminal


def print_doubtful(line: str, doubtful: bool = True) -> None:
    """Prints a line, orange where it is of something that is not to be trusted."""
    if not on_terminal():
        print(line)
        return
    # Rich takes as long to import as short commands take in all.
    from rich.text import Text

    from restshape.cli.console import ORANGE, console

    console().print(Text(line, style=ORANGE if doubtful else ""), soft_wrap=True)


def untrusted_words(found: Mapping[str, Any]) -> str:
    """How many frames that have converged are not to be trusted; empty where all are."""
    return f", {found['untrusted']} not to be trusted" if found.get("untrusted") else ""
