"""The search for a flow with heat in two parts by turns: the flow, then the heat that it carries, until both hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from restshape.algebra.linear import LinearSolver
from restshape.algebra.nonlinear.newton import Newton
from restshape.algebra.nonlinear.newton_convergence import Outcome
from restshape.analysis.analysis import Context
from restshape.analysis.static.nonlinear import NonlinearSystem
from restshape.analysis.static.residual_equations import ResidualEquations
from restshape.fem.problem import SteadyProblem
from restshape.physics.heated_flow.heated_flow import HeatedFlow
from restshape.physics.heated_flow.heated_flow_search import HeatedFlowSearch
from restshape.physics.heated_flow.split_problems import HeatInFlow, LiftedFlow
from restshape.scene.model import Scene
from restshape.scene.plan import Plan

TURNS = 60
"""Of both parts, after which they are believed not to agree."""
SHARE = 0.5
"""Part of the residual that each of both may leave: together they leave less than all of it. Of the tolerance, what
steady fields may lack."""
LITTLE = "turns of flow and heat bring little"
SLOWEST = 0.99
"""Ratio of the changes of two turns above which that of turns further on is not taken."""


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


class SplitSearch(HeatedFlowSearch):
    """Finds a flow with heat by turns; arguments as of `HeatedFlowSearch`, and both parts.

    Source: docs/theory/flow.md.
    """

    def __init__(
        self,
        problem: HeatedFlow,
        equations: ResidualEquations,
        newton: Newton,
        goal: Callable[[], float],
        tolerance: float,
        missing: Callable[[np.ndarray], np.ndarray | None],
        parts: SplitParts,
    ) -> None:
        super().__init__(problem, equations, newton, goal, tolerance, missing)
        self.parts = parts
        self._changes: list[float] = []

    def _solve(self, x: np.ndarray, tolerance: float = 0.0) -> Outcome:
        """By turns from x (n, 4), which is changed; both parts together where these do not agree."""
        self._aim, start = np.inf, x.copy()
        outcome = self._by_turns(x, tolerance)
        if outcome.converged:
            return outcome
        if outcome.why != LITTLE:
            x[:] = start
            return super()._solve(x, tolerance).after(outcome)
        self._aim = SHARE * outcome.norm * self._tolerance / (self._to_come() * self.scale)
        nearer = x.copy()
        more = super()._solve(nearer, tolerance)
        self._aim = np.inf
        if not more.converged:
            # Rounding may be in the way: the flow is within the tolerance of residuals.
            return replace(outcome, converged=True, why="")
        x[:] = nearer
        return more.after(outcome)

    def _by_turns(self, x: np.ndarray, tolerance: float) -> Outcome:
        problem, total = self.problem, Outcome(True, 0, 0, False, True)
        problem.boundary.apply(x)
        self._changes = []
        flow, heat = self.parts.of(problem)
        for _ in range(TURNS):
            self.scale = problem.force_scale(x)
            goal, start = max(self.goal(), tolerance) * self.scale, x.copy()
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
            norm = float(np.hypot(one.norm, other.norm))
            total = replace(other.after(one).after(total), norm=norm)
            if not total.converged:
                return total
            if one.newton or other.newton:
                self._changes.append(self._changed(start, x))
            elif problem.step is None and self._to_come() > self._tolerance:
                # Turns that bring little leave more than their residual shows.
                return replace(total, converged=False, why=LITTLE)
            else:
                return total
        return replace(total, converged=False, why="flow and heat do not agree by turns")

    def _changed(self, before: np.ndarray, x: np.ndarray) -> float:
        """How far the worst field of x (n, 4) is from what it was before, over its range."""
        worst, start = 0.0, 0
        for columns, usual in self.problem.usual(x):
            own = slice(start, start + columns)
            worst = max(worst, float(np.abs(x[:, own] - before[:, own]).max()) / max(float(np.ptp(x[:, own])), usual))
            start += columns
        return worst

    def _to_come(self) -> float:
        """About how far turns that follow would change the worst field, over its range, by what the last ones have.

        With a ratio q of the last change d to the one before, those to come add up to d q/(1 - q).
        """
        if len(self._changes) < 2 or not self._changes[-2]:
            return 0.0
        ratio = min(self._changes[-1] / self._changes[-2], SLOWEST)
        return self._changes[-1] * ratio / (1.0 - ratio)

    def _turn(self, part: Part, x: np.ndarray, columns: slice, goal: float) -> Outcome:
        """The solution of one part in its columns of x (n, 4), which are changed."""
        part.equations.begin()
        own = np.ascontiguousarray(x[:, columns])
        outcome = part.system.newton.solve(own, SHARE * goal, self.scale, rounding=self.problem.rounding())
        x[:, columns] = own
        return outcome
