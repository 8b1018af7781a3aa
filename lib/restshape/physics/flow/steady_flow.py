"""The steady flow of each frame."""

from math import sqrt
from typing import cast

import numpy as np

from restshape.algebra.linear import LinearSolver
from restshape.algebra.linear_report import LinearReport
from restshape.analysis.analysis import Context, RowValues
from restshape.analysis.correction import KeptOperation
from restshape.analysis.static.nonlinear import NonlinearSteadyAnalysis
from restshape.analysis.static.residual_equations import ResidualEquations
from restshape.analysis.static.steady_predictor import SteadyPredictor
from restshape.fem.problem import SteadyProblem
from restshape.fem.residuals import Operation, unconstrained_residual
from restshape.physics.flow.flow_search import FlowSearch
from restshape.physics.flow.incompressible_flow import IncompressibleFlow
from restshape.physics.flow.swing import STEADY_NOTE
from restshape.scene.model import Scene
from restshape.scene.plan import Plan

SMOOTH = 0.5
"""What Newton's last step leaves is smooth: flows are off by up to 1.7 times the residual, that of a ring whose inside
turns. With a complete factor steps end at this share of the tolerance, so that flows agree within it."""


def distance(problem: SteadyProblem, between: np.ndarray, x: np.ndarray) -> float:
    """The relative distance of flows x (n, f) that are apart by `between` (n, f), in the norm over all nodes.

    That of velocities, or of temperatures over how far they spread, where they have a history and are farther apart.
    """
    columns = [*cast(IncompressibleFlow, problem).history[2:]]
    spread = [x[:, k] - x[:, k].mean() for k in columns]
    pairs = [(between[:, :2], x[:, :2]), *((between[:, k], one) for k, one in zip(columns, spread))]
    norms = [(float(np.square(a).sum()), float(np.square(b).sum())) for a, b in pairs]
    return max(sqrt(a / b) if b > 0.0 else 0.0 for a, b in norms)


class SteadyFlowPredictor(SteadyPredictor):
    """A `SteadyPredictor` of flows, whose distances are those of velocities."""

    def quantity_distances(self) -> dict[str, float]:
        """As of `SteadyPredictor`, but at least the share of each quantity by which velocities may be off.

        A step with the kept factor is one of an equation that is not linear: what it leaves of a drag may be larger
        than what it changes. What it leaves to the last bit, such as an area, does not depend on the flow.
        """
        found, share = super().quantity_distances(), self.analysis.errors().get("estimate", 0.0)
        shown = self.analysis.observe() if found else {}
        return {name: max(one, share * abs(shown[name])) if one else 0.0 for name, one in found.items()}

    def _distance(self, predicted: np.ndarray, exact: np.ndarray) -> float:
        return distance(self.analysis.problem, predicted - exact, exact)


class SteadyFlowAnalysis(NonlinearSteadyAnalysis):
    """Steady flow, frame after frame, by `FlowSearch`; arguments as `analysis.steady.SteadyAnalysis`.

    No factor shows whether a steady flow is stable: tangents are not symmetric.

    Source: docs/theory/flow.md.
    """

    def __init__(self, scene: Scene, plan: Plan, context: Context, make: type[IncompressibleFlow]) -> None:
        super().__init__(scene, plan, context, make)
        self.estimated_quantity = "velocity"
        self._applied: tuple[tuple[LinearSolver, int, slice], Operation] | None = None

    @property
    def predictor(self) -> SteadyFlowPredictor:
        """Predicts frames from the state."""
        return SteadyFlowPredictor(self)

    def errors(self) -> dict[str, float]:
        """Of a prediction its estimated distance from the flow on the same mesh, by a step with the kept factor.

        None where there is no complete factor: what an incomplete one makes of a residual is smaller.
        """
        state, missing = self.state, self.missing()
        return {} if missing is None else {"estimate": distance(state.problem, missing, state.x + missing)}

    def missing(self) -> np.ndarray | None:
        """About what predicted unknowns (n, f) lack to be the flow, found once a prediction; None where not known."""
        state = self.state
        if not state.predicted:
            return None
        if self._missing[0] is not state:
            found = self._lacking(state.problem, state.x)
            if found is None:
                return None
            self._missing = state, found
        return self._missing[1]

    def _lacking(self, problem: SteadyProblem, x: np.ndarray) -> np.ndarray | None:
        """About what unknowns x (n, f) lack to be the flow, by the kept factor; None where there is no complete one."""
        kept = self.solver.kept
        if not (kept.ready and kept.exact and kept.size.unknowns == x.size):
            return None
        rest = unconstrained_residual(problem, x)
        problem.boundary.zero(rest)
        return -self._factor(rest.ravel()).reshape(rest.shape)

    def _factor(self, rest: np.ndarray) -> np.ndarray:
        """What the kept factor makes of a residual (n f,), by vectors that stay as long as there are as many rows."""
        key = self.solver, len(rest), self.state.system.rows
        if self._applied is None or self._applied[0] != key:
            self._applied = key, KeptOperation(self.solver, self.state.system.rows)
        return self._applied[1](rest)

    def row(self) -> RowValues:
        """What the frame's row reports besides: that there is no Strouhal number where one is asked for."""
        wanted = any(one.kind == "strouhal" for one in self.state.scene.quantities.values())
        return ({"note": STEADY_NOTE} if wanted else {}) | super().row()

    def _search(self, equations: ResidualEquations) -> FlowSearch:
        return FlowSearch(equations.problem, equations, self.state.system.newton, self._goal)

    def _goal(self) -> float:
        """The residual over its scale to aim at with the preconditioner as it is."""
        return self.solver.aim * (SMOOTH if self.solver.kept.exact else 1.0)

    def _confirmed(self, report: LinearReport) -> LinearReport:
        return report

    @property
    def _tests_factor(self) -> bool:
        return False
