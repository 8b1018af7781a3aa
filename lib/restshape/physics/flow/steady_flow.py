"""The steady flow of each frame."""

from restshape.algebra.linear_report import LinearReport
from restshape.analysis.analysis import RowValues
from restshape.analysis.nonlinear import NonlinearSteadyAnalysis
from restshape.analysis.residual_equations import ResidualEquations
from restshape.physics.flow.flow_search import FlowSearch
from restshape.physics.flow.swing import STEADY_NOTE


class SteadyFlowAnalysis(NonlinearSteadyAnalysis):
    """Steady flow, frame after frame, by `FlowSearch`; arguments as `analysis.steady.SteadyAnalysis`.

    No factor shows whether a steady flow is stable: tangents are not symmetric.

    Source: docs/theory/flow.md.
    """

    def row(self) -> RowValues:
        """What the frame's row reports besides: that there is no Strouhal number where one is asked for."""
        wanted = any(one.kind == "strouhal" for one in self.state.scene.quantities.values())
        return ({"note": STEADY_NOTE} if wanted else {}) | super().row()

    def _search(self, equations: ResidualEquations) -> FlowSearch:
        return FlowSearch(equations.problem, equations, self.state.system.newton, lambda: self.solver.aim)

    def _confirmed(self, report: LinearReport) -> LinearReport:
        return report

    @property
    def _tests_factor(self) -> bool:
        return False
