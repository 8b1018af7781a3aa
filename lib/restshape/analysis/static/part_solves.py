"""Frames of a drag with a reach: when the part that moves is solved for by itself, and with what."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np

from restshape.algebra.linear import LinearSolver
from restshape.analysis.guess import Guess
from restshape.errors import ReplayProblem
from restshape.fem.problem import INTERNAL, SteadyProblem

if TYPE_CHECKING:
    from collections.abc import Callable

    from restshape.algebra.operator import Operator
    from restshape.analysis.analysis import Context
    from restshape.analysis.static.substructure import Substructure
    from restshape.mesh.reach import MovingPart

log = logging.getLogger("restshape.analysis")


class PartSolves:
    """Keeps the substructure of a drag for as long as the same part of the same problem moves.

    Args:
        context: of the analysis.
        make_solver: a solver like that of the whole.

    Attributes:
        solved: the state that the last solve of a part has given.
        found: the substructure; None: there is none.
        overwritten: the operator of the whole has had its values overwritten; set back by who has taken that in.
    """

    def __init__(self, context: Context, make_solver: Callable[[], LinearSolver]) -> None:
        self.context, self._make_solver = context, make_solver
        self.solved: object = None
        self._solver: LinearSolver | None = None
        self._key: tuple[MovingPart | None, SteadyProblem | None] = (None, None)
        self.found: Substructure | None = None
        self.overwritten = False

    def of(self, part: MovingPart | None, problem: SteadyProblem, whole: Operator) -> Substructure | None:
        """What solves for a part that alone has moved; None where the whole is to be solved for.

        Args:
            part: of the mesh; None: everything moves.
            problem: on it, as the last frame has left it.
            whole: its operator, whose values are overwritten.
        """
        if part is None:
            return None
        if self._key != (part, problem):
            self._key, self.solved = (part, problem), None
            self.found = self._made(part, problem, whole)
        found = self.found
        if found is not None and not found.values_stay():
            log.info("Reach: values of the part that stays change with the shape, and the whole is solved for")
            return None
        return found

    def flip(self, changed: np.ndarray, interpolated: bool) -> None:
        """Follow flips of the cells (k,); nodes at the middle of their edges may have gone elsewhere."""
        found = self.found
        if found is None:
            return
        if not found.flip(changed):
            self._key, self.found = (None, None), None
        if interpolated:
            self.solved = None
            found.guess.restart()

    def _made(self, part: MovingPart, problem: SteadyProblem, whole: Operator) -> Substructure | None:
        if why := self._objection(problem):
            log.info("Reach: the whole is solved for: %s", why)
            return None
        # It brings SciPy, which drags without a reach do not need.
        from restshape.analysis.static.substructure import Substructure

        policy, self._solver = self.context.policy, self._solver or self._make_solver()
        cells, self.overwritten = problem.space.follow(part.cells), True
        try:
            with self.context.stages("factor"):
                found = Substructure(
                    problem, whole, cells, policy.backend, self._solver, Guess(policy.extrapolate, policy.warm)
                )
        except ReplayProblem as why_not:
            log.info("Reach: the whole is solved for: %s", why_not)
            return None
        log.info(
            "Reach: %d of %d unknowns condensed onto %d, %d are solved for",
            len(found.part.rest),
            problem.boundary.mask.size,
            len(found.part.border),
            len(found.part.nodes) * problem.boundary.mask.shape[1],
        )
        return found

    def _objection(self, problem: SteadyProblem) -> str:
        """Why no part of a problem can be solved for by itself; empty where it can."""
        if self.context.comm.size > 1:
            return "several ranks share it"
        if not (problem.linear and problem.symmetric and problem.definite):
            return "its equations are not linear, symmetric and definite"
        if problem.boundary.sliding is not None:
            return "unknowns slide along edges"
        if any(one.block is None for one in problem.integrals(INTERNAL)):
            return "some of its forces belong to no cells"
        return ""
