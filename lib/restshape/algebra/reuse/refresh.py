"""When a preconditioner that has become old is worth making again."""

import math

from restshape.algebra.reuse.prices import Prices

MOST_AHEAD = 15
"""Refreshes ahead in a row, before an old preconditioner is tried again."""
TRIAL, SLACK, SHORT = 1.5, 0.01, 50
"""What old preconditioners may cost beyond a new one for each solve before none is tried: so many refreshes, and so
large a part of what comes after as many of them, with which a long replay goes back to old ones."""


class RefreshCriterion:
    """Rent or buy: a refresh is worth it once what an old preconditioner costs beyond a fresh one comes to as much.

    Where a matrix has several uses that are known to come, their cost is counted ahead. Of one use, half of what the
    last solve took beyond a fresh preconditioner is expected, with which growing costs are cut at their least mean.

    Where matrices change so much that already the next one costs as much as a refresh, some are made ahead: 1 after
    such a trial, then 3, 7 and `MOST_AHEAD` after as many in a row. Nor is an old one tried as long as solves of one
    use, of the whole replay, have cost more than `TRIAL` refreshes beyond what a new one for each would, and the part
    `SLACK` of that once it is more than `SHORT` refreshes.

    Args:
        most: iterations of a solve.

    Attributes:
        break_even: iterations that cost as much as a refresh.
        extra_iterations: iterations beyond those of a fresh preconditioner, since it was made.
        last_extra: such iterations of the last solve.
        fresh_iterations: of a solve with a fresh one.
        weight: times these, those of the present solve with a fresh one; callers set it where solves are not alike.
        uses: solves since it was made, -1 before the first.
        ahead: refreshes that are still to be made ahead; trials: in vain, in a row.
        product: iterations that cost as much as a product with the matrix.
        spent, fresh: iterations, refreshes as `break_even` each, that solves of one use have cost, and would have cost
            with a new one for each.

    Source: docs/theory/levels-of-reuse.md.
    """

    def __init__(self, most: int) -> None:
        self.most = most
        self.uses = -1
        self.extra_iterations: float = 0
        self.last_extra: float = 0
        self.break_even = self.product = self.spent = self.fresh = 0.0
        self.fresh_iterations: float = 1
        self.weight = 1.0
        self.ahead = self.trials = 0

    def restart(self) -> None:
        """Take in that the preconditioner has just been made."""
        self.uses, self.extra_iterations, self.last_extra = -1, 0, 0
        self.ahead = max(0, self.ahead - 1)

    def set_refresh_price(self, price: Prices, pattern_changed: bool, product: float = 0.0) -> None:
        """Take in what the preconditioner costs, and a product with the matrix [s]; a new pattern is analysed first."""
        self.product = product / price.iteration
        refresh = price.setup if pattern_changed else price.refresh
        self.break_even = max(1.0, refresh / price.iteration)

    def worth_refreshing(self, known: int = 1) -> bool:
        """Whether a refresh is worth it before a solve.

        Args:
            known: uses of the matrix that are known to come. If they are several, an old preconditioner costs each of
                them one iteration at least, for a fresh factor is applied without any.
        """
        expected = known * max(1, self.last_extra) if known > 1 else self.last_extra / 2
        long = max(0.0, self.fresh - SHORT * self.break_even)
        behind = known == 1 and self.spent > self.fresh + SLACK * long + TRIAL * self.break_even
        return behind or self.ahead > 0 or self.extra_iterations + expected >= self.break_even

    def limit(self, complete: bool, known: int = 1) -> int:
        """Iterations after which a solve with an old preconditioner is better given up for a new one.

        Args:
            complete: it is a complete factor.
            known: uses of the matrix that are known to come, this solve among them: each would take as many.
        """
        # An iteration that is cut short has to restart: where a fresh one is long too, that must be paid twice.
        fresh = self._fresh if complete else 2 * self._fresh
        return min(self.most, math.ceil(fresh) + math.ceil(self.break_even / known))

    @property
    def _fresh(self) -> float:
        """Iterations of the present solve, had it a fresh preconditioner."""
        return max(1, self.fresh_iterations * self.weight)

    def give_up(self, iterations: int, known: int = 1) -> None:
        """Take in that a solve with an old preconditioner, for as many known uses, has been cut short."""
        if known == 1:
            self.spent += iterations
        if known == 1 and self.uses == 1:
            self._try(in_vain=True)
            # The one that is made now is none of them.
            self.ahead += 1

    def _try(self, in_vain: bool) -> None:
        """Take in whether the first solve with an old preconditioner has cost as much as another one."""
        self.trials = self.trials + 1 if in_vain else 0
        self.ahead = min(2**self.trials - 1, MOST_AHEAD)

    def count(self, iterations: int, refreshed: bool, complete: bool, known: int = 1) -> None:
        """Take in the iterations of a solve, all of them with the preconditioner as it is now.

        Args:
            iterations: of the solve.
            refreshed: the preconditioner was made in it.
            complete: it is a complete factor of the whole matrix.
            known: uses of the matrix that were known to come.
        """
        if refreshed:
            self.fresh_iterations = 1 if complete else max(1, iterations / self.weight)
        fresh = self._fresh
        if known == 1:
            # A new complete factor is applied, without a product.
            new = self.break_even - (self.product if complete else 0.0)
            self.spent += iterations + (new if refreshed else 0.0)
            self.fresh += fresh + new
        if refreshed:
            return
        if self.uses == 1 and not complete:
            # The guess on a new mesh is worse than those that follow it.
            self.fresh_iterations = max(1, min(self.fresh_iterations, iterations / self.weight))
            fresh = self._fresh
        self.last_extra = max(0, iterations - fresh)
        if self.uses == 1:
            self._try(in_vain=self.last_extra >= self.break_even)
        self.extra_iterations += self.last_extra
