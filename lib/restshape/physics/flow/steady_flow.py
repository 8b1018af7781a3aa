"""The steady flow of each frame."""

from restshape.analysis.nonlinear import NonlinearSteadyAnalysis
from restshape.analysis.residual_equations import ResidualEquations
from restshape.physics.flow.flow_search import FlowSearch


class SteadyFlowAnalysis(NonlinearSteadyAnalysis):
    """Steady flow, frame after frame, by `FlowSearch`; arguments as `analysis.steady.SteadyAnalysis`.

    No factor shows whether a steady flow is stable: tangents are not symmetric.

    Source: docs/theory/flow.md.
    """

    def _search(self, equations: ResidualEquations) -> FlowSearch:
        return FlowSearch(equations.problem, equations, self.state.system.newton, lambda: self.solver.aim)

    @property
    def _tests_factor(self) -> bool:
        return False
