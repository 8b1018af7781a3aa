"""Where the names of panels stand in pictures of the flat pattern."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from restshape.errors import UserError
from restshape.replay.recording.recording import Recording
from restshape.report.scene_overlay import rebuilt_frames
from restshape.shape.outline import Outline


def panel_names(recording: Recording, frames: np.ndarray) -> dict[int, Mapping[str, np.ndarray]]:
    """The middle (2,) [m] of each panel in the pattern plane by its name, by frame; none of a scene of one sheet.

    Args:
        recording: of cloth.
        frames: indices that are looked at.
    """
    scene = recording.header.get("scene_values")
    if not (isinstance(scene, dict) and scene.get("panels")):
        return {}
    try:
        rebuilt = rebuilt_frames(recording, [int(i) for i in frames])
    except UserError:
        return {}
    return {i: _middles(frame.outline) for i, frame in rebuilt.items() if frame.outline is not None}


def _middles(outline: Outline) -> Mapping[str, np.ndarray]:
    """The middle (2,) of the box around the vertices of each piece."""
    found = {}
    for k, name in enumerate(outline.piece_names):
        own = outline.points[outline.layout.control_piece == k]
        found[name] = np.asarray(0.5 * (own.min(axis=0) + own.max(axis=0)))
    return found
