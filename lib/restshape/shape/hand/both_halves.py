"""Edits of panels that are cut on the fold: what is done to one half is done to the other one, as its mirror image."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from restshape.arrays import Indices, Reals
from restshape.errors import UserError
from restshape.scene.model import Scene
from restshape.scene.panels import folds_of
from restshape.scene.unfolding import IMAGE
from restshape.shape.hand.gesture import SAME_PLACE, Gesture
from restshape.shape.hand.panel_drag import fold_beside
from restshape.shape.outline import Entity, Outline


def of_both_halves(gesture: Gesture, outline: Outline, scene: Scene, entity: Entity) -> Gesture:
    """A gesture whose mirror image is carried out, too, where its entity is of a panel that is cut on the fold.

    What is moved in both halves, such as what lies on the fold, goes the mean of both ways: on the fold along it.

    Args:
        gesture: linear, of the entity; outline, scene: that it is of.

    Raises:
        UserError: the entity is part of several panels, or a control point has no mirror image.
    """
    line = fold_beside(outline, scene, entity)
    if line is None or gesture.basis is None:
        return gesture
    moved = gesture.basis.any(axis=(0, 2))
    partner, reflection = _partners(outline, np.flatnonzero(moved).astype(np.int32), line)
    basis = gesture.basis.copy()
    for p, q in partner.items():
        image = gesture.basis[:, p] @ reflection
        basis[:, q] = 0.5 * (gesture.basis[:, q] + image) if moved[q] else image
    whole = gesture.whole.copy()
    whole[list(partner.values())] = False
    return replace(gesture, basis=basis, whole=whole)


def _partners(outline: Outline, moved: Indices, line: Reals) -> tuple[dict[int, int], Reals]:
    """The mirror images of control points, by number, and the matrix (2, 2) that reflects directions."""
    along = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
    reflection = 2.0 * np.outer(along, along) - np.eye(2)
    images = line[0] + (outline.points[moved] - line[0]) @ reflection
    away = np.linalg.norm(images[:, None] - outline.points, axis=2)
    if (away.min(axis=1) > SAME_PLACE * outline.size).any():
        raise UserError("the halves of the panel are no mirror images any more", do="undo what has moved one of them")
    return dict(zip(moved.tolist(), away.argmin(axis=1).tolist())), reflection


def image_of(scene: Scene, name: str) -> str | None:
    """The name that a part of a panel on the fold has in the other half; None of a panel without a fold."""
    panel, _, own = name.partition(".")
    if panel not in folds_of(scene) or not own:
        return None
    first, _, rest = own.partition(".")
    return f"{panel}.{rest}" if first == IMAGE and rest else f"{panel}.{IMAGE}.{own}"


def reflected(outline: Outline, scene: Scene, name: str, place: tuple[float, float]) -> tuple[float, float]:
    """The mirror image of a place [m] in the fold of the panel that a part belongs to."""
    edge = outline.edges[outline.entity(folds_of(scene)[name.partition(".")[0]]).edges[0]]
    a, b = outline.points[edge.start], outline.points[edge.end]
    along = (b - a) / np.linalg.norm(b - a)
    x, y = (a + (np.asarray(place) - a) @ (2.0 * np.outer(along, along) - np.eye(2))).tolist()
    return x, y


def twice(outline: Outline, scene: Scene, on: str, operation: Callable[[Outline, str, bool], Outline]) -> Outline:
    """An outline after an operation on a part, and on its image where there is one.

    Args:
        outline, scene: before it; on: the part.
        operation: takes an outline, the part of it, and whether that is the image.

    Raises:
        UserError: the part is the fold itself, or an end of it: it has no image.
    """
    image = image_of(scene, on)
    found = operation(outline, on, False)
    if image is None:
        return found
    if on in outline.layout.entities and image not in outline.layout.entities:
        do = "drag it along the fold, or change the scene"
        raise UserError(f"{on} lies on the fold of its panel, which stays a straight line", do=do)
    return operation(found, image, True)
