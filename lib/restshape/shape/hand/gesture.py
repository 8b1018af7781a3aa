"""Gestures: how control points follow the hand, linearly where that is possible."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape import _kernels
from restshape.arrays import Flags, Reals
from restshape.errors import UserError
from restshape.shape.outline import Entity, Outline

SAME_PLACE = 1e-6
"""Distance of a control point from a mirror image, in parts of the shape's size, up to which it is that image."""


@dataclass(frozen=True, eq=False, slots=True)
class Gesture:
    """A motion of control points: reference + c[0] basis[0] + c[1] basis[1].

    Args:
        kind: "drag", "pull", "rotate", "scale", "smooth", "arc", "undo" or "redo".
        basis: (2, k, 2) displacements of all control points, or None where the motion is not linear.
        linear: the motion is linear in c and bulges stay.
        reference: (k, 2) control points at c = (0, 0).
        whole: (k,) control points that move with the selection itself (others follow along their edge).
    """

    kind: str
    basis: Reals | None
    linear: bool
    reference: Reals
    whole: Flags

    def points(self, c: tuple[float, float]) -> Reals:
        """Control points (k, 2) at the coefficients c; the reference where the motion is not linear."""
        if self.basis is None:
            return self.reference
        return _kernels.moved_points(self.reference, self.basis, c[0], c[1])


def extend_to_controls(outline: Outline, chosen: Flags, displacement: Reals) -> Reals:
    """Displacements (k, 2) of all control points when the chosen ones are displaced.

    Inner points of a spline or polyline of which one end alone moves follow it linearly along the chord parameter.

    Args:
        outline: the shape.
        chosen: (k,) bool.
        displacement: (k, 2), used where chosen.
    """
    result = np.where(chosen[:, None], displacement, 0.0)
    for edge in outline.edges:
        loose = [j for j, p in enumerate(edge.inner) if not chosen[p]]
        for j in loose:
            t = edge.knots[j + 1]
            result[edge.inner[j]] = (1.0 - t) * result[edge.start] + t * result[edge.end]
    return result


def chosen_points(outline: Outline, entity: Entity) -> Flags:
    """Mask (k,) of the control points of an entity, and of the inner points of edges both whose ends are in it."""
    chosen = np.zeros(len(outline.points), dtype=bool)
    chosen[outline.control_points(entity)] = True
    for edge in outline.edges:
        if edge.inner and chosen[edge.start] and chosen[edge.end]:
            chosen[list(edge.inner)] = True
    return chosen


def drag(outline: Outline, entity: Entity, tensor: Reals | None = None, mirror: Reals | None = None) -> Gesture:
    """The gesture of a drag: c is the displacement of the cursor [m].

    Args:
        outline: the shape.
        entity: what the hand holds.
        tensor: (2, 2) the displacement of its control points is this times c; default: the unit tensor.
        mirror: (2, 2) two points of a line [m], in which control points have mirror images that follow; None: no line.

    Raises:
        UserError: a control point has no mirror image.

    Source: docs/theory/moving-the-mesh.md; figure 5.8 of the thesis.
    """
    chosen = chosen_points(outline, entity)
    own = np.eye(2) if tensor is None else tensor
    tensors, whole = chosen[:, None, None] * own, chosen
    if mirror is not None:
        tensors, whole = mirrored(outline, chosen, own, mirror)
    follows = tensors.any(axis=(1, 2)) | chosen
    basis = np.stack([extend_to_controls(outline, follows, tensors[:, :, j]) for j in range(2)])
    return Gesture("drag", basis, True, outline.points, whole)


def mirrored(outline: Outline, chosen: Flags, tensor: Reals, line: Reals) -> tuple[Reals, Flags]:
    """Tensors (k, 2, 2) of all control points where what is held and its mirror image move as mirror images.

    A point that is held and is the image of one that is held too, such as one on the line, has the mean of both: it
    goes along the line.

    Args:
        outline: the shape.
        chosen: (k,) bool, control points that are held.
        tensor: (2, 2) theirs.
        line: (2, 2) two points of the mirror's line [m].

    Returns:
        The tensors, and which control points (k,) have the one that is given.

    Raises:
        UserError: a control point that is held has no mirror image.
    """
    along = line[1] - line[0]
    along = along / np.linalg.norm(along)
    reflection = 2.0 * np.outer(along, along) - np.eye(2)
    grabbed = np.flatnonzero(chosen)
    images = line[0] + (outline.points[grabbed] - line[0]) @ reflection
    away = np.linalg.norm(images[:, None] - outline.points, axis=2)
    partners = away.argmin(axis=1)
    if (lonely := ~(away.min(axis=1) <= SAME_PLACE * outline.size)).any():
        k = int(lonely.argmax())
        names, (x, y) = outline.vertex_names, images[k]
        what = f"vertex {names[grabbed[k]]}" if grabbed[k] < len(names) else "a point of a curve"
        raise UserError(f"{what} has no mirror image: no control point is at ({x:.4g}, {y:.4g}) m", do="move the line")
    tensors, image = chosen[:, None, None] * tensor, reflection @ tensor
    tensors[partners] = np.where(chosen[partners, None, None], 0.5 * (tensor + image), image)
    whole = chosen.copy()
    whole[partners] = False
    return tensors, whole


def rotate(outline: Outline, entity: Entity, about: Reals) -> Gesture:
    """The gesture of a turn about a point (2,): c = (cos(angle) - 1, sin(angle))."""
    chosen, arm = chosen_points(outline, entity), outline.points - about
    turned = np.stack([-arm[:, 1], arm[:, 0]], axis=1)
    basis = np.stack([extend_to_controls(outline, chosen, arm), extend_to_controls(outline, chosen, turned)])
    return Gesture("rotate", basis, True, outline.points, chosen)


def scale(outline: Outline, entity: Entity, about: Reals) -> Gesture:
    """The gesture of growing about a point (2,): c = (factor - 1, 0)."""
    chosen = chosen_points(outline, entity)
    grown = extend_to_controls(outline, chosen, outline.points - about)
    return Gesture("scale", np.stack([grown, np.zeros_like(grown)]), True, outline.points, chosen)


def bend(outline: Outline) -> Gesture:
    """The gesture of changing bulges: control points stay, nothing is linear."""
    return Gesture("arc", None, False, outline.points, np.zeros(len(outline.points), dtype=bool))


def other_curves(outline: Outline, target: Outline) -> bool:
    """Whether two outlines of the same layout have other bulges or knots: points on edges do not move linearly then."""
    knots = any(one.knots != other.knots for one, other in zip(outline.edges, target.edges))
    return knots or not np.array_equal(outline.bulges, target.bulges)


def towards(kind: str, outline: Outline, target: Outline) -> Gesture:
    """The gesture that takes an outline to another one of the same layout at c = (1, 0), for edits without a hand."""
    none = np.zeros(len(outline.points), dtype=bool)
    if other_curves(outline, target):
        return Gesture(kind, None, False, outline.points, none)
    step = target.points - outline.points
    return Gesture(kind, np.stack([step, np.zeros_like(step)]), True, outline.points, none)
