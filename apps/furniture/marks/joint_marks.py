"""Marks of what a piece bears: forces of feet, loads, and utilisation of joints, of the case that is worst."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from restshape_apps.furniture.physics.foot_forces import foot_forces
from restshape_apps.furniture.physics.joint_label import joint_label
from restshape_apps.furniture.physics.plank_phrases import joint_name
from restshape_apps.furniture.physics.worst_load_case import worst_of

from restshape.live.shown_marks import Arrows, Lines, Mark, Meaning
from restshape.outputs.si_numbers import si

if TYPE_CHECKING:
    from collections.abc import Sequence

    from restshape_apps.furniture.physics.furniture import Forces, Furniture, Geometry
    from restshape_apps.furniture.shape.planks import Piece


def force_marks(model: Furniture, geometry: Geometry, every: Sequence[Forces]) -> list[Mark]:
    """Forces of feet, loads and joints.

    Args:
        model: of the piece, which says what acts in each case; geometry: as the piece is now.
        every: forces of each case; empty where there are none, as joints are lost: then loads alone are shown.
    """
    case = worst_of(every) if every else 0
    marks = [_loads(model, geometry, case)]
    if every:
        marks = [_feet(geometry, every[case]), *marks, *_joints(model.piece, geometry, every)]
    return [mark for mark in marks if mark is not None]


def _feet(geometry: Geometry, forces: Forces) -> Mark | None:
    """The reactions of the feet, which push on the planks."""
    places, vectors = foot_forces(geometry, forces)
    if not len(places):
        return None
    words = [si(float(size), "N") for size in np.sqrt((vectors**2).sum(axis=1))]
    return Arrows("forces of feet", places, vectors, "N", "force", words, None, [True] * len(places))


def _loads(model: Furniture, geometry: Geometry, case: int) -> Mark | None:
    """The weights, and the push of the case."""
    piece, forces = model.piece, model.cases[case]
    loads = (*piece.weights, *piece.pushes)
    acting = [k for k in range(len(loads)) if forces[k].any()]
    if not acting:
        return None
    planks, places = [loads[k].plank for k in acting], np.array([loads[k].place for k in acting])
    at = geometry.centre[planks] + np.einsum("kij,kj->ki", geometry.axes[planks], places * geometry.size[planks])
    words = [f"{loads[k].name} {si(float(np.sqrt(forces[k] @ forces[k])), 'N')}" for k in acting]
    return Arrows("loads", at, forces[acting], "N", "load", words, None, [True] * len(acting))


def _joints(piece: Piece, geometry: Geometry, every: Sequence[Forces]) -> list[Mark]:
    """The joints as lines: those that break, those that only moments overload, and the others, the worst with words."""
    if not len(geometry.p):
        return []
    utilisation = np.max([one.utilisation for one in every], axis=0)
    moments = np.max([one.moment_utilisation for one in every], axis=0)
    half = 0.5 * geometry.length[:, None] * geometry.y
    ends = np.stack([geometry.p - half, geometry.p + half], axis=1)
    breaks, doubt = utilisation > 1.0, (utilisation <= 1.0) & (moments > 1.0)
    worst = int(utilisation.argmax())
    kinds: tuple[tuple[str, Meaning, np.ndarray, np.ndarray], ...] = (
        ("joints that break", "limit", breaks, utilisation),
        ("joints that only moments overload", "uncertain", doubt, moments),
        ("joints", "guide", ~breaks & ~doubt, utilisation),
    )
    return [
        Lines(
            name,
            ends[chosen].reshape(-1, 3),
            range(0, 2 * int(chosen.sum()), 2),
            meaning,
            None,
            [
                f"{joint_name(piece, k)}: {joint_label(float(of[k])) if of[k] > 1.0 else f'{of[k]:.2f}'}"
                if meaning != "guide" or k == worst
                else ""
                for k in np.flatnonzero(chosen).tolist()
            ],
        )
        for name, meaning, chosen, of in kinds
        if chosen.any()
    ]
