"""Signals that end a command as Ctrl-C does, and standard streams that are closed."""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

ENDING = (signal.SIGINT, signal.SIGHUP, signal.SIGQUIT, signal.SIGTERM)
"""Signals at which frames are kept and the command ends, with 128 and their number."""
PATIENCE = 2
"""Signals that wait for the end of a frame on several ranks: launchers send the first one twice."""
_received: list[int] = []
_postponing = False


@contextmanager
def ending_signals() -> Iterator[None]:
    """Has the signals of `ENDING` interrupt what is done within as Ctrl-C does; those ignored before stay ignored."""
    _received.clear()
    before = {number: signal.getsignal(number) for number in ENDING}
    try:
        for number, handler in before.items():
            if handler is not signal.SIG_IGN:
                signal.signal(number, _interrupt)
    except ValueError:
        # Only the main thread may; in others a program looks after its signals itself.
        yield
        return
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)


def _interrupt(number: int, _: FrameType | None) -> None:
    _received.append(number)
    if not _postponing or len(_received) > PATIENCE:
        raise KeyboardInterrupt


def interrupt_if_asked() -> None:
    """Interrupts if a signal came that code which must not be interrupted has swallowed.

    Raises:
        KeyboardInterrupt: one came.
    """
    if _received:
        raise KeyboardInterrupt


@contextmanager
def agreeing(ranks: Any) -> Iterator[Callable[[], None]]:
    """What ends all ranks after the same frame where a signal came to one of them; to be called after each frame.

    A signal within waits for the end of the frame; one after `PATIENCE` of them interrupts at once.

    Args:
        ranks: communicator of mpi4py.
    """
    global _postponing
    if ranks.size == 1:
        yield interrupt_if_asked
        return
    from mpi4py import MPI

    from restshape.interface.run import AgreedInterrupt

    def end_together() -> None:
        number = ranks.allreduce(_received[0] if _received else 0, op=MPI.MAX)
        if number:
            _received[:] = [number]
            raise AgreedInterrupt

    _postponing = True
    try:
        yield end_together
    finally:
        _postponing = False


def exit_code() -> int:
    """What a shell says of a program that the signal received has ended."""
    return 128 + (_received[0] if _received else signal.SIGINT)


def open_streams() -> None:
    """Gives streams that the caller has closed to /dev/null: else the next file opened would take their number."""
    for number, (name, flags) in enumerate((("stdin", os.O_RDONLY), ("stdout", os.O_WRONLY), ("stderr", os.O_WRONLY))):
        try:
            os.fstat(number)
        except OSError:
            nowhere = os.open(os.devnull, flags)
            os.dup2(nowhere, number)
            if nowhere != number:
                os.close(nowhere)
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(number, "r" if number == 0 else "w", closefd=False))
