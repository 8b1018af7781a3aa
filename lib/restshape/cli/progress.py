"""Progress of a replay: a bar on a terminal, plain lines elsewhere."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from restshape.cli.console import Output


@contextmanager
def progress(quiet: bool) -> Iterator[Callable[[], None]]:
    """A function that counts a frame: a bar on a terminal, a line every hundred frames elsewhere."""
    console = Output(stderr=True)
    if quiet:
        yield lambda: None
    elif console.is_terminal:
        layout = (TextColumn("replay"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
        with Progress(*layout, console=console, transient=True, refresh_per_second=4) as bar:
            task = bar.add_task("replay", total=None)
            yield lambda: bar.advance(task)
    else:
        count = 0

        def line() -> None:
            nonlocal count
            count += 1
            if count % 100 == 0:
                # A replay goes on although nobody reads how far it is.
                with suppress(BrokenPipeError):
                    print(f"{count} frames", file=sys.stderr, flush=True)

        yield line
