"""Eigenfrequencies of a shape beside its motion, and the mass that moves with each mode."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import scipy.sparse as sp

from restshape.analysis.modal.base_modes import BaseModes, base_modes
from restshape.analysis.motion.transient_state import TransientState
from restshape.analysis.row_values import RowValues

ALONG = (1.0, 0.0)
"""Direction of the effective mass where the ground stands still."""


class LinearMotion(Protocol):
    """What modes need of the analysis of a linear motion."""

    @property
    def state(self) -> TransientState: ...

    def matrices(self) -> tuple[sp.csr_matrix, sp.csr_matrix, sp.csr_matrix]:
        """Stiffness, mass and damping of the free unknowns, whole on each rank."""


class ModesBeside:
    """The lowest modes of what an analysis in time holds, computed once a shape and scene.

    Args:
        count: how many.
    """

    def __init__(self, count: int) -> None:
        self.count = count
        self._known: tuple[tuple[object, ...], BaseModes] | None = None

    def __call__(self, analysis: LinearMotion) -> BaseModes:
        """The modes of the present shape, along the direction in which the ground moves."""
        state = analysis.state
        key = (state.body, state.scene, state.topology, state.geometry)
        if self._known is None or any(a is not b and a != b for a, b in zip(self._known[0], key)):
            self._known = (key, present_modes(analysis, self.count))
        return self._known[1]

    def row(self, analysis: LinearMotion) -> RowValues:
        """The columns of a frame: frequencies [Hz] and shares of the mass; nothing for modes that there are not."""
        modes = self(analysis)
        found: RowValues = {}
        for k in range(self.count):
            known = k < len(modes.omega)
            found[f"f_{k + 1}"] = float(modes.frequencies[k]) if known else np.nan
            found[f"effective_mass_{k + 1}"] = float(modes.effective_mass[k]) if known else np.nan
        return found


def present_modes(analysis: LinearMotion, count: int) -> BaseModes:
    """The lowest modes of the shape that an analysis holds; all ranks must ask.

    Args:
        analysis: after a frame.
        count: how many modes.
    """
    body, excitation = analysis.state.body, analysis.state.integration.excitation
    direction = np.array(ALONG) if excitation is None else excitation.direction
    stiffness, mass, _ = analysis.matrices()
    rigid = np.broadcast_to(direction, body.constrained.shape).copy()
    inertia = body.mass.apply(rigid)
    return base_modes(stiffness, mass, inertia[~body.constrained], float(np.vdot(rigid, inertia)), count)
