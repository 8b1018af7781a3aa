"""What frames of a recording may show besides the field, and what draws those things that must be rebuilt."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

from restshape.replay.recording.recording import Recording
from restshape.report.scenery import Scenery

if TYPE_CHECKING:
    import numpy as np

    from restshape.report.scene_overlay import Overlay
    from restshape.report.vectors import VectorSegments

REBUILT = ("supports", "loads", "hand", "names")
"""What frames may show that the recording does not hold: the scene and the script of its header give it."""
FOR_ARROWS = 0.13
"""Room for the arrows of loads, over the size of all frames."""
USUAL = ("mesh", "goal")
"""What they show where nobody says otherwise."""


def overlay(
    recording: Recording, scenery: Scenery, wanted: Sequence[int] | np.ndarray, things: Collection[str]
) -> Overlay | None:
    """What draws those things that must be rebuilt; None where there are none.

    Raises:
        UserError: see `Overlay`.
    """
    rebuilt = [thing for thing in things if thing in REBUILT]
    if not rebuilt:
        return None
    # The session of a script takes as long to import as a picture to draw.
    from restshape.report.scene_overlay import Overlay

    return Overlay(recording, scenery, list(map(int, wanted)), rebuilt)


def vector_segments(
    recording: Recording, scenery: Scenery, wanted: Sequence[int] | np.ndarray, things: Collection[str]
) -> VectorSegments | None:
    """What draws a field of vectors; None where it is not among what frames show.

    Raises:
        UserError: the recording has none.
    """
    if "vectors" not in things:
        return None
    from restshape.report.vectors import VectorSegments

    return VectorSegments(recording, scenery, list(map(int, wanted)))
