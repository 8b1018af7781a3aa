"""When a preconditioner that has become old is worth making again."""

import math

from restshape.algebra.choice import Prices


class RefreshCriterion:
    """Rent or buy: a refresh is worth it once the iterations beyond those of a fresh one have cost as much.

    Args:
        most: iterations of a solve.

    Attributes:
        break_even: iterations that cost as much as a refresh.
        extra_iterations: iterations beyond those of a fresh preconditioner, since it was made.
        fresh_iterations: of a solve with a fresh one.
        uses: solves since it was made, -1 before the first.
        patched: the pattern of the matrix is not that of the frame before: then nothing is made ahead of the iteration.

    Source: docs/theory/levels-of-reuse.md.
    """

    def __init__(self, most: int) -> None:
        self.most = most
        self.uses = -1
        self.extra_iterations = self.break_even = 0
        self.fresh_iterations = 1
        self.patched = False

    def restart(self) -> None:
        """Take in that the preconditioner has just been made."""
        self.uses, self.extra_iterations = -1, 0

    def set_refresh_price(self, price: Prices, pattern_changed: bool) -> None:
        """Take in what the preconditioner costs; a new pattern asks for an analysis of it."""
        refresh = price.setup if pattern_changed else price.refresh
        self.break_even = max(1, math.ceil(refresh / price.iteration))

    @property
    def worth_refreshing(self) -> bool:
        """Whether the iterations beyond those of a fresh preconditioner have cost as much as a refresh."""
        return not self.patched and self.extra_iterations >= self.break_even

    def limit(self, complete: bool) -> int:
        """Iterations after which a solve with an old preconditioner is better given up for a new one.

        Args:
            complete: it is a complete factor.
        """
        # An iteration that is cut short has to restart: where a fresh one is long too, that must be paid twice.
        fresh = self.fresh_iterations if complete else 2 * self.fresh_iterations
        break_even = 2 * self.break_even if self.patched else self.break_even
        return min(self.most, max(fresh + 1, fresh + break_even - self.extra_iterations))

    def count(self, iterations: int, refreshed: bool, complete: bool) -> None:
        """Take in the iterations of a solve, all of them with the preconditioner as it is now.

        Args:
            iterations: of the solve.
            refreshed: the preconditioner was made in it.
            complete: it is a complete factor of the whole matrix.
        """
        if refreshed:
            self.fresh_iterations = 1 if complete else max(1, iterations)
            return
        if self.uses == 1 and not complete:
            # The guess on a new mesh is worse than those that follow it.
            self.fresh_iterations = max(1, min(self.fresh_iterations, iterations))
        self.extra_iterations += max(0, iterations - self.fresh_iterations)
