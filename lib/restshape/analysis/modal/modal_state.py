"""What an analysis of free vibrations knows after a frame."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from restshape.algebra.eigenproblems.eigen import EigenReport
from restshape.analysis.modal.modal_matrices import ModalMatrices
from restshape.analysis.modal.mode_search import FoundModes
from restshape.analysis.modal.mode_tracking import ModeIds
from restshape.fem.eigenproblem import Eigenproblem
from restshape.fem.observer import Observer
from restshape.fem.space import Space
from restshape.first_use import made
from restshape.scene.model import Scene
from restshape.scene.plan import Plan


@dataclass(frozen=True, eq=False)
class Modes:
    """All modes that are carried along, solved for or predicted.

    Args:
        values: (k,) eigenvalues [1/s^2], ascending.
        basis: (k, n f) the modes, or what `turn` mixes them of.
        mass_products: (k, n f) products M phi of the last solution.
        participation: (k,) parts of the kinetic energy normal to the plane.
        ids: of the modes.
        chosen: (modes,) indices of those that the scene asks for.
        turn: (k, k) mixes the modes, column by column; None: they are the basis.
    """

    values: np.ndarray
    basis: np.ndarray
    mass_products: np.ndarray
    participation: np.ndarray
    ids: ModeIds
    chosen: np.ndarray
    turn: np.ndarray | None = None

    @classmethod
    def none(cls) -> Modes:
        """Before the first solution."""
        empty = np.empty((0, 0))
        return cls(np.empty(0), empty, empty, np.empty(0), ModeIds.none(), np.empty(0, dtype=int))

    @cached_property
    def vectors(self) -> np.ndarray:
        """The modes (k, n f), with phi M phi = 1: made when they are asked for, which frames in passing never do."""
        return self.basis if self.turn is None else self.turn.T @ self.basis


@dataclass(frozen=True, eq=False)
class BoundBody:
    """What is set up for a mesh and the values of a scene.

    Args:
        body: what vibrates; matrices: its.
        observer: of the scene's quantities.
    """

    body: Eigenproblem
    matrices: ModalMatrices
    observer: Observer


@dataclass(frozen=True, eq=False)
class ModalState:
    """The last solution, or a prediction that was made from it.

    Args:
        scene, plan, space: of the last solution, the plane mesh as the space.
        topology, geometry: versions of the plane mesh.
        bound: None before the first frame.
        modes: shown now; solved: those of the last solution, the same unless these are predicted.
        count: of the lowest modes that are solved for.
        report: of the last solve.
        interrupted: the last solve has failed, so that what it has moved belongs to no solution.
        recalled: the last solve was of an undo or redo, whose modes have the ids that they had on that shape.
    """

    plan: Plan
    scene: Scene
    space: Space | None = None
    topology: int = -1
    geometry: int = -1
    bound: BoundBody | None = None
    modes: Modes = field(default_factory=Modes.none)
    solved: Modes | None = None
    count: int = 0
    report: EigenReport = field(default_factory=lambda: EigenReport(0, False, 0, ""))
    interrupted: bool = False
    recalled: bool = False

    @property
    def body(self) -> Eigenproblem:
        """What vibrates."""
        return made(self.bound).body

    @property
    def problem(self) -> Eigenproblem:
        """The eigenproblem of the body, which the body itself is."""
        return self.body

    @property
    def matrices(self) -> ModalMatrices:
        """Of the body."""
        return made(self.bound).matrices

    @property
    def observer(self) -> Observer:
        """Of the scene's quantities."""
        return made(self.bound).observer

    @property
    def predicted(self) -> bool:
        """Whether the modes are a prediction."""
        return self.solved is not None and self.modes is not self.solved

    @property
    def frequencies(self) -> np.ndarray:
        """Frequencies (modes,) [Hz] of the modes that the scene asks for, ascending."""
        return frequencies(self.modes.values[self.modes.chosen])

    @property
    def ids(self) -> np.ndarray:
        """The ids (modes,) of these modes."""
        return self.modes.ids.ids[self.modes.chosen]

    def solved_for(self, found: FoundModes, ids: ModeIds) -> ModalState:
        """This state with modes that have been solved for."""
        modes = Modes(found.values, found.vectors, found.mass_products, found.participation, ids, found.chosen)
        return replace(self, modes=modes, solved=modes, count=found.count, report=found.report)


def frequencies(values: np.ndarray) -> np.ndarray:
    """Frequencies (k,) [Hz] of eigenvalues (k,) [1/s^2]; 0 of negative ones."""
    return np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi)
