"""Whether people see at once what is printed."""

import sys

from restshape.cli.ranks import launched


def on_terminal() -> bool:
    """Whether output goes to a terminal, and not through a launcher of ranks."""
    return sys.stdout.isatty() and not launched()
