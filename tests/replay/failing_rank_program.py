"""Run by mpiexec: a command line whose second rank fails in its third frame, or whose ranks stand in unlike folders."""

import os
import sys

from restshape.cli.main import main
from restshape.cli.ranks import rank_number
from restshape.replay import loop

FRAME = 3


def fail_in_a_frame() -> None:
    """From the third frame on, frames of this rank end in an error that nobody expects."""
    compute = loop.Replay._frame

    def fail(replay, edit):
        if edit.index >= FRAME:
            raise ArithmeticError("this rank has had enough")
        return compute(replay, edit)

    loop.Replay._frame = fail


if __name__ == "__main__":
    kind, *words = sys.argv[1:]
    if kind == "apart":
        os.chdir(f"rank-{rank_number()}")
    elif rank_number() == "1":
        fail_in_a_frame()
    sys.argv[1:] = words
    raise SystemExit(main())
