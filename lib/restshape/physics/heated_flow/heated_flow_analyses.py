"""The analyses of fluids with heat: of flow, with heat where temperatures differ, or of conduction alone."""

# More than 15 modules: each kind of analysis, and the equations that it may have.

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from restshape.algebra.linear_report import LinearReport
from restshape.analysis.analysis import Analysis, Comparison, Context
from restshape.analysis.comparison import compared_by_fields
from restshape.analysis.frame import Frame
from restshape.analysis.motion.transient import TransientAnalysis
from restshape.analysis.static.nonlinear import NonlinearSteadyAnalysis
from restshape.analysis.static.residual_equations import ResidualEquations
from restshape.application import application_of
from restshape.fem.problem import SteadyProblem
from restshape.first_use import made
from restshape.physics.flow.flow_in_time import FlowInTimeAnalysis
from restshape.physics.flow.flow_search import FlowSearch
from restshape.physics.flow.history import Past
from restshape.physics.flow.incompressible_flow import IncompressibleFlow
from restshape.physics.flow.steady_flow import SteadyFlowAnalysis
from restshape.physics.heated_flow.heated_flow import HeatedFlow
from restshape.physics.heated_flow.heated_flow_search import HeatedFlowSearch
from restshape.physics.heated_flow.isothermal_flow import IsothermalFlow
from restshape.physics.heated_flow.split_search import SplitParts, SplitSearch
from restshape.physics.heated_flow.still_fluid import StillFluid
from restshape.physics.heated_flow.still_fluid_analysis import StillFluidAnalysis
from restshape.physics.heated_flow.temperature_differences import uniform
from restshape.scene.model import Scene
from restshape.scene.plan import Plan
from restshape.scene.plan import plan as planned

UNIFORM = 1e-9
"""Difference of temperatures, over the largest, below which there is none."""


def fluid_analysis(scene: Scene, plan: Plan, context: Context) -> Analysis[SteadyProblem]:
    """Of a fluid with or without heat, steady or in time; arguments as of any `Analysis`."""
    if not plan.on("flow"):
        if plan.on("storage"):
            return TransientAnalysis(scene, plan, context, StillFluid)
        return StillFluidAnalysis(scene, plan, context, StillFluid)
    in_time = plan.settings("flow").time_step is not None
    make = HeatedFlowInTime if in_time else SteadyHeatedFlow
    return make(scene, plan, context, _equations(plan))


def _equations(plan: Plan) -> type[IncompressibleFlow]:
    """Those of flow alone where no temperature differs from another."""
    return HeatedFlow if plan.on("temperature_difference") else IsothermalFlow


class Switching(NonlinearSteadyAnalysis):
    """An analysis whose equations are others as soon as temperatures differ; arguments as of its bases."""

    _parts: SplitParts | None = None

    def solve(self, frame: Frame) -> LinearReport:
        """Bring the unknowns up to date with a frame; see its bases."""
        if self.state.bound is not None and frame.scene is not self.state.scene:
            wanted = self._wanted(frame.scene)
            if wanted is not type(self.state.problem):
                self._switch(frame.scene, wanted)
        return super().solve(frame)

    def _search(self, equations: ResidualEquations) -> FlowSearch:  # type: ignore[override]
        problem = equations.problem
        if not isinstance(problem, HeatedFlow) or self.state.plan.settings("heat").coupling == "monolithic":
            return super()._search(equations)  # type: ignore[return-value]
        if self._parts is None:
            self._parts = SplitParts(self.state.scene, self.state.plan, self.context)
        newton, (tolerance, missing) = self.state.system.newton, self._accuracy(problem)
        return SplitSearch(problem, equations, newton, lambda: self.solver.aim, tolerance, missing, self._parts)

    def _accuracy(self, _: HeatedFlow) -> tuple[float, Callable[[np.ndarray], np.ndarray | None]]:
        """What fields may lack, over their ranges, and what finds how much it is; in time residuals say it."""
        return np.inf, lambda _: None

    def compare_cold(self) -> Comparison:
        """The state beside a cold solve: velocity, pressure and temperature each by its own range."""
        problem = self.state.problem
        if not isinstance(problem, HeatedFlow) or not self._has_solved:
            return super().compare_cold()
        return compared_by_fields(self.warm_system(), self.cold_system(), problem.usual(self.x))

    @property
    def tolerance(self) -> float:
        """That fields meet, each over its range: twice that of residuals, which hold in the norm of forces."""
        return 2.0 * super().tolerance

    @property
    def _has_solved(self) -> bool:
        """Whether the last frame has solved anything."""
        return True

    def _wanted(self, scene: Scene) -> type[IncompressibleFlow]:
        """The equations of a scene."""
        return _equations(planned(scene, application_of(scene)))

    def _switch(self, scene: Scene, wanted: type[IncompressibleFlow]) -> None:
        """Go on with other equations, whose unknowns are those of before, as on a new mesh."""
        x, bound = self._with_temperature(self.state.x, wanted), self.state.bound
        self.make = wanted
        self.solver = self._make_solver(scene)
        # A mesh that is none of the frame's: it is set up again, from the unknowns of before.
        self.state = replace(self.state, x=x, bound=replace(bound, mesh=None), interrupted=True)

    def _with_temperature(self, x: np.ndarray, wanted: type[IncompressibleFlow]) -> np.ndarray:
        """Unknowns (n, 3) or (n, 4) as those of the wanted equations; the fluid is as warm as its last scene was."""
        if wanted is IsothermalFlow:
            return x[:, :3].copy()
        return np.column_stack([x[:, :3], np.full(len(x), uniform(self.state.scene))])


class SteadyHeatedFlow(Switching, SteadyFlowAnalysis):
    """Steady flow, with heat where temperatures differ; arguments as `analysis.steady.SteadyAnalysis`.

    Source: docs/theory/flow.md.
    """

    def _search(self, equations: ResidualEquations) -> FlowSearch:
        found, problem = super()._search(equations), equations.problem
        if isinstance(found, SplitSearch) or not isinstance(problem, HeatedFlow):
            return found
        return HeatedFlowSearch(problem, equations, self.state.system.newton, self._goal, *self._accuracy(problem))

    def _accuracy(self, problem: HeatedFlow) -> tuple[float, Callable[[np.ndarray], np.ndarray | None]]:
        return self.solver.tolerance, partial(self._lacking, problem)


class HeatedFlowInTime(Switching, FlowInTimeAnalysis):
    """Flow in time, with heat as soon as temperatures differ; arguments as `analysis.steady.SteadyAnalysis`.

    Source: docs/theory/flow.md.
    """

    def _wanted(self, scene: Scene) -> type[IncompressibleFlow]:
        """The equations of a scene; a fluid whose temperatures differ keeps them until they do not."""
        wanted, x = super()._wanted(scene), self.state.x
        if wanted is HeatedFlow:
            return wanted
        warm = x[:, 3] if x.shape[1] == 4 else np.array([uniform(self.state.scene)])
        even = np.abs(warm - uniform(scene)).max() <= UNIFORM * np.abs(warm).max()
        return wanted if even else HeatedFlow

    @property
    def _has_solved(self) -> bool:
        return self.state.problem.step is not None

    def _switch(self, scene: Scene, wanted: type[IncompressibleFlow]) -> None:
        super()._switch(scene, wanted)
        self._ahead = self._time_guess()
        past, x = made(self.state.past), self.state.x
        self.state = replace(self.state, past=Past(past.time, replace(past.last, values=x[:, list(wanted.history)])))
