"""A relaxation of cloth that goes on step by step, and may be left at any of them."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace
from typing import Protocol

import numpy as np

from restshape.algebra.nonlinear.descent import MEMORY
from restshape.algebra.solve_counts import SolveCounts
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.contact.contact import FrictionHistory
from restshape.physics.cloth.relaxation.binding import friction_of, layers_of
from restshape.physics.cloth.relaxation.mixed_newton import MixedNewton
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.self_contact.layer_friction import LayerFriction

Memory = tuple[FrictionHistory | None, LayerFriction | None]


class Relaxed(Protocol):
    """What is relaxed: an analysis of cloth."""

    state: RelaxationState
    counts: SolveCounts

    def entered(self) -> RelaxationState:
        """The state that a solve begins with."""


class Refinement:
    """Leads predicted cloth to rest, a step of Newton's method or a short descent at a time.

    The prediction is shown until `take`: then the analysis holds the positions that were reached, with the friction
    that has followed, and its next `solve` has little left to do but to certify them.

    Args:
        analysis: that holds a prediction.
        most: steps.

    Attributes:
        reached: (n, 3) where the last step has led; better: with less forces than what is shown.
    """

    def __init__(self, analysis: Relaxed, most: int) -> None:
        self.analysis, self.most = analysis, most
        self.report, self.reached, self.better = ConvergenceReport(), np.empty((0, 3)), False
        self._begun = analysis.entered()
        self._steps = self._run(self._begun.x.copy())
        problem = self._begun.problem
        self._residual = self._begun.solver.residual_norm(analysis.state.x)
        shown = _memory(problem)
        problem.begin(self._begun.x)
        self._memory = _memory(problem)
        _remember(problem, shown)

    def advance(self) -> bool:
        """Take a step; whether there is another one."""
        problem, report, counts = self._begun.problem, self.report, self.analysis.counts
        shown, before = _memory(problem), (report.steps, report.iterations, report.factors)
        _remember(problem, self._memory)
        try:
            self._note(next(self._steps))
        except StopIteration as end:
            self._note(end.value)
            return False
        finally:
            self._memory = _memory(problem)
            _remember(problem, shown)
            counts.matrices += report.steps - before[0]
            counts.iterations += report.iterations - before[1]
            counts.factors += report.factors - before[2]
        return True

    def _note(self, x: np.ndarray) -> None:
        """Take note of where a step has led, and whether that is nearer to rest than what is shown."""
        self.reached, self.better = x, self._begun.solver.residual_norm(x) < self._residual

    def take(self) -> None:
        """Let the analysis hold the positions that were reached, from which its next `solve` goes on."""
        friction, layers = self._memory
        self.analysis.state = replace(self._begun, x=self.reached, friction=friction, layers=layers)

    def _run(self, x: np.ndarray) -> Generator[np.ndarray, None, np.ndarray]:
        """Steps from x (n, 3), which is changed; the value is where they led."""
        solver, report = self._begun.solver, self.report
        if not solver.tries.left_out():
            found, rests = yield from MixedNewton(solver, report).steps(x)
            solver.tries.count(rests)
            if found is not None:
                x = found
            if rests:
                return x
        while report.steps < self.most:
            before = report.steps
            solver.converge(x, MEMORY, report)
            if report.converged or report.falls or report.steps == before:
                break
            yield x
        return x


def _memory(problem: ClothProblem) -> Memory:
    """What friction remembers now."""
    return friction_of(problem), layers_of(problem)


def _remember(problem: ClothProblem, memory: Memory) -> None:
    """Let friction remember something else."""
    history, layers = memory
    if history is not None:
        problem.contact.history = history
    if layers is not None:
        problem.self_contact.history = layers
