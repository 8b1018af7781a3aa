"""What a sweep says of how its values were found, in its table, its JSON file and its picture."""

from collections.abc import Sequence

from restshape.outputs.si_numbers import counted
from restshape.variation.swept_run import SweptRun

MOVED = (1, 2)
"""Levels of reuse of a mesh that keep its nodes or most of its cells."""


def sweep_notes(remembered: Sequence[str], runs: Sequence[SweptRun]) -> list[str]:
    """The notes, a line each: which runs start from rest, and which have the mesh of another shape.

    Args:
        remembered: parts of the physics whose equilibria depend on the path to them.
        runs: that are done.
    """
    found = []
    if remembered:
        found.append(f"each run starts from rest: equilibria depend on the path to them ({', '.join(remembered)})")
    if moved := sum(meshes_moved(runs)):
        which = f"{counted(moved, 'run')} on the mesh of the run before, moved to its shape (level 1 or 2)"
        found.append(f"{which}: values hold to the error of the mesh; --from-rest gives each run its own mesh")
    return found


def meshes_moved(runs: Sequence[SweptRun]) -> list[bool]:
    """Of each run whether it begins on the mesh of the run before, moved to its shape."""
    return [one.level in MOVED for one in runs]
