"""A batch of random examples."""

from dataclasses import dataclass

DRAWN, DAMAGED, FILES, RECORDINGS = KINDS = ("drawn", "damaged", "files", "recordings")
"""What batches are of: scenes as they were drawn, with damage, with drawings and meshes, recordings."""
FAULT = "fault"
"""Folder of the last example at fault."""


@dataclass(frozen=True)
class Batch:
    """What a process plays.

    Args:
        seed: all follows from it.
        count: number of examples.
        apps: applications that the scenes are of.
        kind: one of `KINDS`.
        known: signatures of faults that are counted only, and neither end the batch nor are made smaller.
        shrink: look for a smaller example of a fault.
        alone: play only the example whose files lie in the folder.
    """

    seed: int
    count: int
    apps: tuple[str, ...]
    kind: str
    known: tuple[str, ...] = ()
    shrink: bool = True
    alone: bool = False
