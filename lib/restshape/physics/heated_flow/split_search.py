"""The search for a flow with heat in two parts by turns: the flow, then the heat that it carries, until both hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from restshape.algebra.linear import LinearSolver
from restshape.algebra.newton import Newton
from restshape.algebra.newton_convergence import Outcome
from restshape.analysis.analysis import Context
from restshape.analysis.nonlinear import NonlinearSystem
from restshape.analysis.residual_equations import ResidualEquations
from restshape.fem.problem import SteadyProblem
from restshape.physics.flow.flow_search import FlowSearch
from restshape.physics.heated_flow.heated_flow import HeatedFlow
from restshape.physics.heated_flow.split_problems import HeatInFlow, LiftedFlow
from restshape.scene.model import Scene
from restshape.scene.plan import Plan

TURNS = 60
"""Of both parts, after which they are believed not to agree."""
SHARE = 0.5
"""Part of the residual that each of both may leave: together they leave less than all of it."""


@dataclass
class Part:
    """One of both parts on a space.

    Args:
        problem: of it; system: its operator and Newton's method; equations: that are solved.
        topology: of the space that its operator knows.
    """

    problem: SteadyProblem
    system: NonlinearSystem
    equations: ResidualEquations
    topology: int


class SplitParts:
    """Both parts of flows with heat, and what they keep from frame to frame.

    Args:
        scene: for its tolerance.
        plan: which effects are on.
        context: what all parts of the replay share.
    """

    def __init__(self, scene: Scene, plan: Plan, context: Context) -> None:
        self.context = context
        self._solvers = {make: self._solver(make, scene, plan) for make in (LiftedFlow, HeatInFlow)}
        self._parts: dict[type[SteadyProblem], Part] = {}

    def of(self, whole: HeatedFlow) -> tuple[Part, Part]:
        """Both parts of a problem, with its values of now."""
        flow, heat = (self._part(make, whole) for make in (LiftedFlow, HeatInFlow))
        return flow, heat

    def _part(self, make: type[LiftedFlow] | type[HeatInFlow], whole: HeatedFlow) -> Part:
        known, space = self._parts.get(make), whole.space
        if known is not None and known.problem.whole is whole and known.topology == space.topology:
            known.problem.update()
            return known
        problem, patched = make(whole), known is not None and known.problem.space is space
        if known is None or not patched:
            if known is not None:
                known.system.newton.destroy()
            backend = self.context.policy.backend or (make.backend if self.context.comm.size == 1 else None)
            solver = self._solvers[make]
            system = NonlinearSystem(self.context.comm, problem, backend, solver, f"{make.name}_newton_")
        else:
            system = known.system
            system.operator.set_topology(problem.blocks(), problem.boundary.mask)
        equations = ResidualEquations(problem, system.operator, self.context.stages)
        system.newton.set_equations(equations)
        system.newton.begin(not patched, patched, None)
        self._parts[make] = Part(problem, system, equations, space.topology)
        return self._parts[make]

    def _solver(self, make: type[LiftedFlow] | type[HeatInFlow], scene: Scene, plan: Plan) -> LinearSolver:
        rate = plan.settings("flow").time_step is not None
        context, traits = self.context, replace(make.traits(plan), symmetric=False, rate=rate)
        return LinearSolver(
            context.comm,
            f"{make.name}_",
            context.policy.solver,
            scene.solve.tolerance,
            context.calibration,
            context.stages,
            memory=scene.solve.factor_memory,
            traits=traits,
        )


class SplitSearch(FlowSearch):
    """Finds a flow with heat by turns; arguments as of `FlowSearch`, and both parts.

    Source: docs/theory/flow.md.
    """

    def __init__(
        self,
        problem: HeatedFlow,
        equations: ResidualEquations,
        newton: Newton,
        goal: Callable[[], float],
        parts: SplitParts,
    ) -> None:
        super().__init__(problem, equations, newton, goal)
        self.parts = parts

    def _solve(self, x: np.ndarray, tolerance: float = 0.0) -> Outcome:
        """By turns from x (n, 4), which is changed; both parts together where these do not agree."""
        start = x.copy()
        outcome = self._by_turns(x, tolerance)
        if outcome.converged:
            return outcome
        x[:] = start
        return super()._solve(x, tolerance).after(outcome)

    def _by_turns(self, x: np.ndarray, tolerance: float) -> Outcome:
        problem, total = self.problem, Outcome(True, 0, 0, False, True)
        problem.boundary.apply(x)
        flow, heat = self.parts.of(problem)
        for _ in range(TURNS):
            self.scale = problem.force_scale(x)
            goal = max(self.goal(), tolerance) * self.scale
            flow.problem.temperature = x[:, 3:].copy()
            if not problem.drawing_in and problem.draws_in(x):
                self._change(drawing_in=True)
                flow.problem.update()
            one = self._turn(flow, x, slice(0, 3), goal)
            heat.problem.velocity = x[:, :2].copy()
            before = x[:, 3:].copy()
            other = self._turn(heat, x, slice(3, 4), goal) if one.converged else one
            if problem.step is None and other.newton:
                # A steady temperature answers so strongly to the flow that turns of full length swing.
                x[:, 3:] += (1.0 - problem.relaxation) * (before - x[:, 3:])
            settled = total.newton > 0 and not one.newton and not other.newton
            norm = float(np.hypot(one.norm, other.norm))
            total = replace(other.after(one).after(total), norm=norm)
            if not total.converged or settled or not (one.newton or other.newton):
                return total
        return replace(total, converged=False, why="flow and heat do not agree by turns")

    def _turn(self, part: Part, x: np.ndarray, columns: slice, goal: float) -> Outcome:
        """The solution of one part in its columns of x (n, 4), which are changed."""
        part.equations.begin()
        own = np.ascontiguousarray(x[:, columns])
        outcome = part.system.newton.solve(own, SHARE * goal, self.scale, rounding=self.problem.rounding())
        x[:, columns] = own
        return outcome
