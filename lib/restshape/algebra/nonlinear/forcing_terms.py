"""Forcing terms of Newton's method: how exact a linear solve is worth being, and when a tangent serves twice."""

KINDS = 3
"""Steps that learn by themselves: the first, the second, all later ones. They see different errors: those of a guess
where nodes have moved are stiff and nearly linear, those of later steps are soft."""
HOPE = 0.5
"""A linear solve that was no more exact than the model hides what that would have left over: less is hoped for."""
COARSE = 0.01
"""Least reduction of the residual that a linear solve is asked for: with 0.1 an old factor saves iterations and costs
steps, a tangent each (202 in place of 153 on the elastica)."""
SHARE = 0.5
"""Part of what the linear model leaves over that the linear solve leaves over at most."""


class ModelError:
    """An estimate c |r|^2 of the residual after an exact step from the residual r, c from the steps before.

    Source: docs/theory/solids.md.
    """

    def __init__(self) -> None:
        self.factors: list[float | None] = [None] * KINDS

    def factor(self, step: int) -> float | None:
        """The c of that step, from 0; None where nothing is known yet."""
        return self.factors[min(step, KINDS - 1)]

    def learn(self, step: int, size: float, rest: float, target: float) -> None:
        """Take in a step of full length with a tangent of its own.

        Args:
            step: its number, from 0.
            size, rest: norms of the residual before and after it.
            target: norm of the residual that its linear solve could leave.
        """
        if size == 0.0:
            return
        k, seen = min(step, KINDS - 1), rest / size**2
        known = self.factors[k]
        # The rest of the linear solve is all that is seen, or nearly so.
        if known is not None and rest <= 2.0 * target:
            seen = HOPE * min(known, seen)
        self.factors[k] = seen


class ForcingTerms:
    """The forcing terms of one run after another on one mesh, and which of their tangents are kept for another step.

    A linear solve is as exact as pays: its rest is kept below what the linear model leaves over, which is estimated
    from the steps before (it grows like the square of the residual), and below the goal in the step that is to be the
    last. Where preconditioners are kept, so is the tangent for a last small step that a new one would not make better.

    Attributes:
        chord: the present step is made with the tangent of the step before.
        fused: the next residual is best evaluated together with its tangent.
        target: norm of the residual that the last linear solve could leave.

    Source: docs/theory/solids.md; Eisenstat and Walker, SIAM J. Sci. Comput. 17 (1996) 16.
    """

    def __init__(self) -> None:
        self.error = ModelError()
        self.begin(0.0, False, False)

    def begin(self, goal: float, searched: bool, keeps: bool) -> None:
        """A new run to a residual of norm `goal`, by line search or not; `keeps` allows tangents to serve twice."""
        self.goal, self.searched = goal, searched
        self.chords = keeps and not searched
        self.chord, self.tangent_size, self.target = False, 0.0, 0.0
        # The first residual is evaluated together with the tangent, for one step is all but certain.
        self.fused = True

    def choose_tangent(self, step: int, norm: float, assembled: bool) -> bool:
        """Whether the step from a residual of that norm is made with the tangent of the step before.

        Args:
            step: its number, from 0.
            norm: of the residual.
            assembled: the present tangent is there already.
        """
        c = self.error.factor(step)
        self.chord = (
            not assembled and self.chords and c is not None and 2.0 * c * self.tangent_size * norm <= SHARE * self.goal
        )
        if not self.chord:
            self.tangent_size = norm
        return self.chord

    def tolerance(self, step: int, size: float) -> float:
        """The norm that a linear solve may leave of a residual of norm `size`."""
        goal, c = self.goal, self.error.factor(step)
        if c is None:
            target, self.fused = COARSE * size, True
        else:
            # With the tangent of the step before, the model leaves over what both steps together do.
            rest = c * size * (2.0 * self.tangent_size if self.chord else size)
            target = goal - rest if rest <= SHARE * goal else max(SHARE * goal, SHARE * min(rest, COARSE * size))
            # A residual that needs no further tangent, or none but the present one, is evaluated without.
            self.fused = not (rest <= SHARE * goal or (self.chords and 2.0 * c * size * rest <= SHARE * goal))
        self.target = min(target, COARSE * size)
        return self.target

    def learn(self, step: int, before: float, after: float) -> None:
        """Take in what the step number `step` has made of the residual's norm."""
        if self.searched:
            # Shorter steps show nothing of what full ones leave over.
            return
        if self.chord:
            # A kept tangent that does not serve is given up.
            self.chords = after < COARSE * before
        else:
            self.error.learn(step, before, after, self.target)
