"""Marks of what a piece bears: forces of feet, loads, and utilisation of joints, of the case that is worst."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

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


class ForceMarks:
    """Makes the marks of each frame of a piece.

    Args:
        model: of the piece, which says what acts in each case.
    """

    def __init__(self, model: Furniture) -> None:
        self._model = model
        self._loads: dict[int, ActingLoads] = {}

    def __call__(self, geometry: Geometry, every: Sequence[Forces]) -> list[Mark]:
        """Forces of feet, loads and joints.

        Args:
            geometry: as the piece is now.
            every: forces of each case; empty where there are none, as joints are lost: then loads alone are shown.
        """
        case = worst_of(every) if every else 0
        if case not in self._loads:
            self._loads[case] = ActingLoads.of(self._model, case)
        marks = [self._loads[case].mark(geometry)]
        if every:
            marks = [_feet(geometry, every[case]), *marks, *_joints(self._model.piece, geometry, every)]
        return [mark for mark in marks if mark is not None]


@dataclass(frozen=True, eq=False)
class ActingLoads:
    """The weights, and the push of a case.

    Args:
        planks: (k,) on which they act; places: (k, 3) where, in parts of their sizes from their centres.
        forces: (k, 3) [N]; words: of each.
    """

    planks: np.ndarray
    places: np.ndarray
    forces: np.ndarray
    words: Sequence[str]

    @classmethod
    def of(cls, model: Furniture, case: int) -> Self:
        """Those of a case of a model."""
        loads, forces = (*model.piece.weights, *model.piece.pushes), model.cases[case]
        acting = np.flatnonzero(forces.any(axis=1))
        planks, places = np.array([one.plank for one in loads]), np.array([one.place for one in loads])
        words = [f"{loads[k].name} {si(float(np.sqrt(forces[k] @ forces[k])), 'N')}" for k in acting.tolist()]
        return cls(planks[acting], places[acting], forces[acting], words)

    def mark(self, geometry: Geometry) -> Mark | None:
        """Their arrows on the piece as it is; None where there are none."""
        if not self.words:
            return None
        arms = (self.places * geometry.size[self.planks])[:, :, None]
        at = geometry.centre[self.planks] + (geometry.axes[self.planks] @ arms)[:, :, 0]
        return Arrows("loads", at, self.forces, "N", "load", self.words, None, [True] * len(self.words))


def _feet(geometry: Geometry, forces: Forces) -> Mark | None:
    """The reactions of the feet, which push on the planks."""
    places, vectors = foot_forces(geometry, forces)
    if not len(places):
        return None
    words = [si(float(size), "N") for size in np.sqrt((vectors**2).sum(axis=1))]
    return Arrows("forces of feet", places, vectors, "N", "force", words, None, [True] * len(places))


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
