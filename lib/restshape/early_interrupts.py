"""Ctrl-C in the program `restshape` before its command runs: a line and 130, as later, and no traceback.

Commands handle signals themselves as soon as they run (`restshape.cli.signals`). A program that imports restshape keeps
its own handling.
"""

import os
import signal
import sys
from contextlib import suppress
from types import FrameType

PROGRAM, MODULE = "restshape", "restshape.cli.main"


def end_at_interrupts() -> None:
    """From now on Ctrl-C ends the process, if it is the program `restshape` and Python would raise an exception."""
    if _is_program() and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)


def _is_program() -> bool:
    """Whether the process was started as ``restshape`` or by ``python -m``; the module has no name of its own yet."""
    script = sys.argv[0] if sys.argv else ""
    if script == "-m":
        return ("-m", MODULE) in zip(sys.orig_argv, sys.orig_argv[1:])
    return os.path.basename(script) == PROGRAM


def _end(number: int, _: FrameType | None) -> None:
    """Ends the process at once: modules are half imported, and nothing is there to be kept."""
    # Not by sys.stderr, which may be closed.
    with suppress(OSError):
        os.write(2, b"restshape: interrupted\n")
    os._exit(128 + number)
