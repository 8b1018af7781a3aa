"""Panels of a sewn scene that no seam, no support and no hand reaches, before anything is sewn."""

from __future__ import annotations

import numpy as np

from restshape.scene.held_point import hold_of
from restshape.scene.model import Scene
from restshape.shape.outline import Outline
from restshape.shape.pieces import PieceFinder


def loose_panels(scene: Scene, outline: Outline) -> list[str]:
    """What to warn of panels that neither a seam joins to another one nor a support, or `[hold]`, holds.

    They may be meant to lie on a body or on other cloth, as a lining that is only put on.

    Args:
        scene: of cloth; outline: of its panels. A scene without seams, or of one panel, is not doubted.
    """
    if not scene.seams or len(outline.piece_names) == 1:
        return []
    names, layout = outline.piece_names, outline.layout
    reached = np.zeros(len(names), dtype=bool)
    for on in (one.on for one in scene.supports.values()):
        for entity in map(outline.entity, on):
            reached[layout.control_piece[list(entity.vertices)]] = True
            reached[layout.edge_piece[list(entity.edges)]] = True
    hold = hold_of(scene)
    if hold is not None:
        reached[PieceFinder(outline).of_point(np.array(hold.at))] = True
    for seam in scene.seams.values():
        edges = [edge for side in seam.sides for name in side for edge in outline.entity(name).edges]
        joined = np.unique(layout.edge_piece[edges])
        reached[joined] |= len(joined) > 1
    return [
        f"panels.{name}: no seam joins it to another panel and no support holds it: a body or other cloth below must"
        for name, is_reached in zip(names, reached)
        if not is_reached
    ]
