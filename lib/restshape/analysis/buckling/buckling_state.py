"""What an analysis of buckling knows after a frame."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from restshape.algebra.eigenproblems.eigen import EigenReport
from restshape.analysis.buckling.buckling_matrices import BucklingMatrices
from restshape.analysis.modal.mode_tracking import ModeIds
from restshape.analysis.settings import buckling_settings
from restshape.analysis.static.steady import SteadyState
from restshape.fem.observer import area
from restshape.fem.problem import PrestressedProblem
from restshape.fem.residuals import energy

SIGNS = {"given": 1.0, "reversed": -1.0}

ROUNDING = 1e-10
"""Strains below this share of the displacement over the body's size are none."""


@dataclass(frozen=True, eq=False)
class BucklingModes:
    """Load factors and their modes.

    Args:
        load_factors: (k,) ascending, as many as there are up to those that the scene asks for.
        vectors: (k, 2 n) with phi K phi = 1; mass_products: (k, 2 n) their products K phi.
        ids: of the modes.
    """

    load_factors: np.ndarray
    vectors: np.ndarray
    mass_products: np.ndarray
    ids: ModeIds

    @classmethod
    def none(cls) -> BucklingModes:
        """Before the first solution."""
        empty = np.empty((0, 0))
        return cls(np.empty(0), empty, empty, ModeIds.none())


@dataclass(frozen=True, eq=False)
class BucklingState:
    """The load factors of an equilibrium.

    Args:
        prebuckling: the equilibrium whose stress loads the body.
        matrices: of the eigenproblem; None before the first solution.
        modes: load factors and modes; those of a prediction have the vectors of the last solution.
        most: the load factor beyond which there is none.
        predicted: the load factors are a prediction.
        report: of the last solve for them.
        interrupted: the last solve has failed.
    """

    prebuckling: SteadyState[PrestressedProblem]
    matrices: BucklingMatrices | None = None
    modes: BucklingModes = field(default_factory=BucklingModes.none)
    most: float = np.inf
    predicted: bool = False
    report: EigenReport = field(default_factory=lambda: EigenReport(0, False, 0, ""))
    interrupted: bool = False

    @property
    def problem(self) -> PrestressedProblem:
        """The problem of the equilibrium."""
        return self.prebuckling.problem

    @property
    def sign(self) -> float:
        """Of the load that is meant, -1 where it is turned round."""
        return SIGNS[buckling_settings(self.prebuckling.plan).load]

    def load_factor(self, k: int) -> float:
        """The k-th load factor, from 1; infinite where there is none, not a number where it is not computed."""
        if k > buckling_settings(self.prebuckling.plan).modes:
            return float("nan")
        found = self.modes.load_factors
        return float(found[k - 1]) if k <= len(found) else float("inf")


def most_load_factor(prebuckling: SteadyState[PrestressedProblem]) -> float:
    """The load factor at which the mean strain is 1: linear elasticity knows nothing beyond; infinite without load.

    The square of the mean strain is twice the strain energy over the stiffness of the body.
    """
    problem, size = prebuckling.problem, area(prebuckling.problem.space)
    strain = float(np.sqrt(2.0 * energy(problem, prebuckling.x) / (problem.stiffest * size)))
    # Supports may only carry the body somewhere else: what strain it then has is rounding.
    translation = float(np.abs(prebuckling.x).max()) / np.sqrt(size)
    return 1.0 / strain if strain > ROUNDING * translation else np.inf
