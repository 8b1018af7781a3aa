"""Where cloth is held, in each frame of a recording."""

from __future__ import annotations

import numpy as np

from restshape.errors import UserError
from restshape.replay.recording import Recording
from restshape.report.scene_overlay import rebuilt_frames

ON = 1e-6
"""How far nodes are from an edge that they lie on, over the size of the pattern."""


def pins(recording: Recording, frames: np.ndarray) -> dict[int, np.ndarray]:
    """Nodes (k,) on which supports act, by frame; nothing of scenes that cannot be rebuilt, such as those of a file.

    Args:
        recording: of cloth.
        frames: indices that are looked at.
    """
    scene = recording.header.get("scene_values")
    if not (isinstance(scene, dict) and scene.get("supports")):
        return {}
    try:
        rebuilt = rebuilt_frames(recording, [int(i) for i in frames])
    except UserError:
        return {}
    found = {}
    for i, frame in rebuilt.items():
        outline, X = frame.outline, recording.points(i)
        assert outline is not None, "what has no outline is refused"
        names = {name for support in frame.scene.supports.values() for name in support.on}
        entities = [outline.entity(name) for name in sorted(names)]
        points = [outline.points[list(entity.vertices)] for entity in entities if not entity.edges]
        chains = [outline.polyline(edge, ON * outline.size) for entity in entities for edge in entity.edges]
        on_it = [_near(X, one[None], one[None], ON * outline.size) for part in points for one in part]
        on_it += [_near(X, chain[:-1], chain[1:], 2.0 * ON * outline.size) for chain in chains]
        found[i] = np.flatnonzero(np.any(on_it, axis=0)) if on_it else np.empty(0, dtype=int)
    return found


def _near(X: np.ndarray, starts: np.ndarray, ends: np.ndarray, far: float) -> np.ndarray:
    """Whether nodes (n, 2) are no farther than this from any of some sides (m, 2) [m]."""
    found = np.zeros(len(X), dtype=bool)
    for a, b in zip(starts, ends):
        side, away = b - a, X - a
        share = np.clip(away @ side / max(float(side @ side), 1e-300), 0.0, 1.0)
        found |= np.linalg.norm(away - share[:, None] * side, axis=1) <= far
    return found
