"""Load stepping: equilibria followed from a state that is known, in steps of load whose length adapts."""

import logging
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from restshape.algebra.nonlinear.newton_convergence import Outcome

log = logging.getLogger("restshape.analysis")

SHORTEST = 2.0**-12
"""The shortest step, as a part of the load. A column that is pushed aside by 1e-4 of its load takes steps of 2^-11 past
its buckling load. By 2e-5 of its load or less it may be lost there."""
SEARCHED = 2.0**-5
"""Steps as short as this are tried again with line search."""
EASY = 6
"""A step that took no more of Newton's steps is doubled."""

Attempt = Callable[[np.ndarray, "np.ndarray | None", bool], tuple[Outcome, str]]


@dataclass
class LoadPath:
    """How far the equilibria were followed.

    Args:
        x: (n, 2) the last equilibrium [m].
        reached: the part of the load, 1 at the end.
        outcome: of all runs of Newton's method.
        why: it ends before that.
    """

    x: np.ndarray
    reached: float
    outcome: Outcome
    why: str = ""


def step_load(
    attempt: Attempt,
    start: np.ndarray,
    lacking: np.ndarray,
    put_on: Callable[[np.ndarray, float], None],
    before: Outcome,
    most: int,
) -> LoadPath:
    """Follow the equilibria under the load that keeps `start` where it is, while this load is taken away.

    From the rest shape these are steps of the scene's own load. A step that fails is halved; one that was easy is
    doubled. The guess of a step goes on along the one before.

    Args:
        attempt: solves from a guess (n, 2) under an added load (n, 2), with line search or without; changes the guess,
            and shows what speaks against the result.
        start: (n, 2) [m].
        lacking: (n, 2) residual forces there [N].
        put_on: sets the constrained unknowns of a guess to their values at a part of the load, and what else dead loads
            are not.
        before: runs of Newton's method that went before.
        most: steps that are tried.
    """
    found = LoadPath(start, 0.0, before)
    step, last = 1.0, None
    for _ in range(most):
        part = min(1.0, found.reached + step)
        guess = found.x.copy()
        if last is not None:
            guess += (found.x - last.x) * ((part - found.reached) / (found.reached - last.reached))
        put_on(guess, part)
        added = None if part == 1.0 else (1.0 - part) * lacking
        outcome, problem = attempt(guess, added, False)
        found.outcome = outcome.after(found.outcome)
        if problem and step <= SEARCHED:
            guess = found.x.copy()
            put_on(guess, part)
            outcome, problem = attempt(guess, added, True)
            found.outcome = outcome.after(found.outcome)
        if not problem:
            last, found = found, LoadPath(guess, part, found.outcome)
            if part == 1.0:
                return found
            step *= 2.0 if outcome.newton <= EASY else 1.0
            continue
        found.why, last, step = problem, None, 0.5 * step
        log.info("Load step cut to %g of the load, at %g: %s", step, found.reached, problem)
        if step < SHORTEST:
            break
    else:
        found.why = f"more than {most} load steps would be needed; raise effects.large_deformation.load_steps"
    return found
