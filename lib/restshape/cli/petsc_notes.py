"""What a command says at its end of the words that a user has given to PETSc."""

import sys
from collections.abc import Sequence


def note_petsc(words: Sequence[str], left: Sequence[str] | None = None) -> None:
    """Which words after -- PETSc has made no use of, misspelt ones most often, and which change nothing here.

    Args:
        words: all of them.
        left: those that were of no use, where other processes had them; else PETSc is asked in this one.
    """
    if not words:
        return
    from restshape.replay.petsc_options import unused, without_effect

    left = unused(words) if left is None else left
    if left:
        print(f"note: PETSc made no use of these words after --: {' '.join(left)}", file=sys.stderr)
    for one in without_effect(words):
        print(f"note: this option has no effect here: {one}", file=sys.stderr)
