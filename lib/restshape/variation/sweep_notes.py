"""What a sweep says of how its values were found, in its table, its JSON file and its picture."""

from collections.abc import Sequence
from itertools import pairwise

from restshape.outputs.si_numbers import counted
from restshape.variation.swept_run import SweptRun

MOVED = (1, 2)
"""Levels of reuse of a mesh that keep its nodes or most of its cells."""


def sweep_notes(runs: Sequence[SweptRun]) -> list[str]:
    """The notes, a line each: which start from rest, have the mesh of another shape, or modes of other ranks.

    Args:
        runs: that are done.
    """
    found = []
    if remembered := [*dict.fromkeys(part for one in runs if one.frames for part in one.remembered)]:
        found.append(_from_rest(runs, ", ".join(remembered)))
    if moved := sum(meshes_moved(runs)):
        which = f"{counted(moved, 'run')} on the mesh of the run before, moved to its shape (level 1 or 2)"
        found.append(f"{which}: values hold to the error of the mesh; --from-rest gives each run its own mesh")
    if crossed := sum(one.crossed for one in runs):
        which = f"modes keep their numbers from run to run: in {counted(crossed, 'run')} these are not their ranks"
        found.append(f"{which}; --from-rest numbers those of each run by rank, as a replay of its own does")
    return found


def _from_rest(runs: Sequence[SweptRun], remembered: str) -> str:
    """How many runs start from rest: their equilibria depend on the path, or those of the run before do."""
    valid = [one for one in runs if one.frames]
    own = [bool(one.remembered) for one in valid]
    if all(own):
        return f"each run starts from rest: equilibria depend on the path to them ({remembered})"
    after = [before and not now for before, now in pairwise(own)]
    begin, do = "starts" if sum(own) == 1 else "start", "does" if sum(after) == 1 else "do"
    what = f"{counted(sum(own), 'run')} of {len(valid)} {begin} from rest"
    also = f"; so {do} {counted(sum(after), 'run')} right after one of them" if any(after) else ""
    return f"{what}: equilibria depend on the path to them ({remembered}){also}"


def meshes_moved(runs: Sequence[SweptRun]) -> list[bool]:
    """Of each run whether it begins on the mesh of the run before, moved to its shape."""
    return [one.level in MOVED for one in runs]
