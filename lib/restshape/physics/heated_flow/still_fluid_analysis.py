"""The analysis of heat in a fluid that does not flow, which solves nothing where no temperature differs."""

from dataclasses import replace

from restshape.algebra.linear_report import LinearReport
from restshape.analysis.analysis import Comparison
from restshape.analysis.frame import Frame
from restshape.analysis.static.steady import SteadyAnalysis
from restshape.physics.heated_flow.still_fluid import StillFluid


class StillFluidAnalysis(SteadyAnalysis[StillFluid]):
    """Conduction, frame after frame; arguments as `analysis.steady.SteadyAnalysis`."""

    @property
    def uniform(self) -> bool:
        """Whether no temperature of the scene differs from another."""
        return not self.state.plan.on("temperature_difference")

    def residual_norm(self) -> float:
        """The true residual over the right side; 0 of a temperature that is the same everywhere."""
        return 0.0 if self.uniform else super().residual_norm()

    def compare_cold(self) -> Comparison:
        """The state beside a cold solve; there is none of what is not solved."""
        return Comparison(0.0, None) if self.uniform else super().compare_cold()

    def _solve(self, frame: Frame, new_mesh: bool) -> LinearReport:
        if not self.uniform:
            return super()._solve(frame, new_mesh)
        state, mesh = self.state, frame.mesh
        self.solver.age += 1
        self.guess.restart()
        self.state = replace(
            state,
            scene=frame.scene,
            x=state.problem.start(),
            topology=mesh.topology,
            geometry=mesh.geometry,
            predicted=False,
            interrupted=False,
        )
        return LinearReport(0, False, self.solver.age, self.solver.name)
