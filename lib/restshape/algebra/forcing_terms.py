"""What the linear model of a step of Newton's method leaves over."""

KINDS = 3
"""Steps that learn by themselves: the first, the second, all later ones. They see different errors: those of a guess
where nodes have moved are stiff and nearly linear, those of later steps are soft."""
HOPE = 0.5
"""A linear solve that was no more exact than the model hides what that would have left over: less is hoped for."""


class Remainder:
    """An estimate c |r|^2 of the residual after an exact step from the residual r, c from the steps before.

    Source: docs/theory.md, section 2.
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
        hidden = known is not None and rest <= 2.0 * target
        self.factors[k] = HOPE * min(known, seen) if hidden else seen
