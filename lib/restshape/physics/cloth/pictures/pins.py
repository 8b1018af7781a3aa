"""Where cloth is held, in each frame of a recording."""

from __future__ import annotations

import numpy as np

from restshape.errors import UserError
from restshape.replay.recording.recording import Recording
from restshape.report.scene_overlay import rebuilt_frames
from restshape.scene.held_point import CLOTH, hold_of
from restshape.shape.nearness import distances

ON = 1e-6
"""How far nodes are from an edge that they lie on, over the size of the pattern."""


def pins(recording: Recording, frames: np.ndarray) -> dict[int, np.ndarray]:
    """Nodes (k,) on which supports act, or that a hand holds, by frame; nothing of scenes that cannot be rebuilt.

    Such are those of a file.

    Args:
        recording: of cloth.
        frames: indices that are looked at.
    """
    scene = recording.header.get("scene_values")
    hold = f'"{CLOTH}"' in str(recording.header.get("script_text", ""))
    if not (isinstance(scene, dict) and (hold or scene.get("supports") or scene.get("hold"))):
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
        on_it = [distances(X, part, part) <= ON * outline.size for part in points]
        on_it += [distances(X, chain[:-1], chain[1:]) <= 2.0 * ON * outline.size for chain in chains]
        point = hold_of(frame.scene)
        if point is not None:
            on_it.append(np.arange(len(X)) == np.hypot(*(X[:, :2] - point.at).T).argmin())
        found[i] = np.flatnonzero(np.any(on_it, axis=0)) if on_it else np.empty(0, dtype=int)
    return found
