"""How a relaxation ended."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass
class ConvergenceReport:
    """How far an equilibrium was reached, filled in by the methods on the way.

    Args:
        residual: norm of the residual over the load.
        converged: it is small enough, and friction has stopped slipping.
        stable: the true tangent there is positive definite; None: not looked at.
        steps: of all methods; newton: of Newton's; iterations: of linear solvers; factors: made.
        slip: largest slip distance of friction at the end [m].
        saddles: of the energy that were left on the way.
        falls: nothing catches the cloth.
        softness: the least part of its stiffness that the membrane had in a step.
        why: it has not converged, for people.
    """

    residual: float = np.inf
    converged: bool = False
    stable: bool | None = None
    steps: int = 0
    newton: int = 0
    iterations: int = 0
    factors: int = 0
    slip: float = 0.0
    saddles: int = 0
    falls: bool = False
    softness: float = 1.0
    why: str = ""

    def count(self, other: ConvergenceReport) -> None:
        """Take over what another relaxation has spent."""
        self.steps, self.newton = self.steps + other.steps, self.newton + other.newton
        self.saddles += other.saddles
        self.iterations, self.factors = self.iterations + other.iterations, self.factors + other.factors

    def take_softness(self, part: float) -> None:
        """Take note of a part of its stiffness that the membrane has in a step."""
        self.softness = min(self.softness, part)
