"""Which preconditioner a linear system gets: the one of which counted work, priced by the calibration, costs least."""

import logging
import math
from collections.abc import Sequence
from dataclasses import replace

from restshape.algebra.reuse.candidates import MORE_RANKS, Candidate, candidates
from restshape.algebra.reuse.outlay import Outlay, Rival
from restshape.algebra.reuse.prices import (
    MOST_BORDER,
    Prices,
    Size,
    border_unknowns,
    flow_prices,
    prices,
    shared_prices,
)
from restshape.algebra.reuse.traits import Traits
from restshape.calibration import Calibration
from restshape.first_use import made

log = logging.getLogger("restshape.algebra")

MEMORY = 4e9
"""Bytes that a complete factor may take, over all ranks, unless the scene says otherwise (`solve.factor_memory`)."""
FACTOR_BYTES = 12.0
"""Of a nonzero of a factor: its value and its column."""
PRIOR_SOLVES = 4
"""Solves that the prior iterations weigh as much as, beside those that this replay has counted."""
PRIOR_LIFE = 100.0
"""Solves on one mesh before the replay has counted any."""
WIDER_FILL, WIDER_FRESH = 0.45, -0.9
"""Powers of a row's nonzeros over `prices.ROW` in the nonzeros of a complete factor and in the iterations with an
incomplete one: measured with second-order triangles (23 a row), 2,000 to 70,000 unknowns, within 5 %."""
FADING = 0.95
"""Weight of a solve over that of the next one with the same preconditioner, where matrices are not symmetric: a flow
that starts changes them more than one that goes on."""
PATIENCE = 50
"""Solves on one mesh before a refresh may change to another candidate."""
LESS = 0.9
"""Cost of another candidate over that of the present one at which a refresh changes to it."""
ANY = Traits()
"""Of matrices of which nothing is said."""
PRIOR_AGE = 5.0
"""Age of a preconditioner up to which the prior growth of iterations was measured."""


class Iterations:
    """Iterations of a solve as a line over the age of its preconditioner, in units of those expected of a fresh one.

    Fitted by least squares to what is counted and to the prior, which weighs as much as `PRIOR_SOLVES` solves.
    """

    def __init__(self, growth: float) -> None:
        self.sums = (0.0, 0.0, 0.0, 0.0, 0.0)
        for _ in range(PRIOR_SOLVES // 2):
            self.count(0.0, 1.0)
            self.count(PRIOR_AGE, 1.0 + growth * PRIOR_AGE)
        self._prior = self.sums

    def count(self, age: float, iterations: float) -> None:
        """Take in a solve."""
        one, ages, squares, all_iterations, products = self.sums
        self.sums = (
            one + 1.0,
            ages + age,
            squares + age * age,
            all_iterations + iterations,
            products + age * iterations,
        )

    def fade(self) -> None:
        """Let what has been counted weigh a little less; the prior stays."""
        one, ages, squares, iterations, products = (p + FADING * (s - p) for s, p in zip(self.sums, self._prior))
        self.sums = (one, ages, squares, iterations, products)

    def line(self) -> tuple[float, float]:
        """Iterations at age 0, and how many each solve of age adds; neither is negative."""
        one, age, square, iterations, product = self.sums
        growth = max(0.0, (one * product - age * iterations) / (one * square - age * age))
        return max(0.0, (iterations - growth * age) / one), growth


class Choice:
    """Chooses a preconditioner for each new system, from prices and from what the replay has counted so far.

    Args:
        calibration: seconds a unit of counted work.
        memory: bytes that a complete factor may take; a larger one is never chosen.
        traits: of the matrices, but for their dimension, which is the system's.

    Attributes:
        krylov: the iteration that the user names, so that candidates with another one are left out; empty: none.
        uses: solves with each matrix of the system that are known to come.
        outlay: what the chosen candidate has cost on the system.

    Source: docs/theory/levels-of-reuse.md.
    """

    def __init__(self, calibration: Calibration, memory: float = MEMORY, traits: Traits = ANY) -> None:
        self.calibration, self.memory, self.traits, self.krylov = calibration, memory, traits, ""
        self.iterations: dict[tuple[str, int, int], Iterations] = {}
        self.fill: dict[tuple[str, int], float] = {}
        self.excluded: set[str] = set()
        self.systems, self.solves, self._since = 1.0, PRIOR_LIFE, 0
        self.uses, self.outlay = 1, Outlay()
        # Of what was counted last: solves of a system follow one another.
        self._counted: tuple[Candidate | None, Size | None, Iterations, float] = (None, None, Iterations(0.0), 1.0)

    def __call__(self, size: Size) -> Candidate:
        """The candidate of which a solve is expected to cost least; ties go to the first of the list."""
        self.systems += 1.0
        found = self.open(size)
        costs = [(candidate, self.cost(candidate, size)) for candidate in found]
        chosen = min(costs, key=lambda priced: priced[1])[0]
        self._begin(chosen, costs, size)
        self._log_choice(chosen, costs, size)
        return chosen

    def _begin(self, chosen: Candidate, costs: Sequence[tuple[Candidate, float]], size: Size) -> None:
        """Begin the account of a candidate of symmetric systems; others are chosen again after `PATIENCE`."""
        others = [priced for priced in costs if priced[0] is not chosen]
        if chosen.krylov or not others:
            self.outlay.begin(None)
            return
        rival, cost = min(others, key=lambda priced: priced[1])
        self.outlay.begin(Rival(rival, cost, self.prices(rival, size).setup))

    def again(self, size: Size, present: Candidate) -> Candidate:
        """The candidate for a refresh on the same mesh: another one where what has been counted makes it cheaper.

        Candidates of symmetric systems stay until their `outlay` has exceeded what another one would have cost.
        """
        if not present.krylov:
            return self._instead(size) if self.outlay.exceeded else present
        if self._since < PATIENCE or present not in self.open(size):
            return present
        costs = [(candidate, self.cost(candidate, size)) for candidate in self.open(size)]
        chosen, least = min(costs, key=lambda priced: priced[1])
        if least > LESS * self.cost(present, size):
            return present
        self._since = 0
        self._log_choice(chosen, costs, size)
        return chosen

    def _instead(self, size: Size) -> Candidate:
        """The rival of a candidate that has cost too much, whose own account begins."""
        chosen = made(self.outlay.rival).candidate
        self.instead(chosen, size)
        return chosen

    def instead(self, chosen: Candidate, size: Size) -> None:
        """Take in that a candidate comes in place of another one, which has failed or cost too much."""
        costs = [(candidate, self.cost(candidate, size)) for candidate in self.open(size)]
        self._begin(chosen, costs, size)
        self._log_choice(chosen, costs, size)

    def _log_choice(self, chosen: Candidate, costs: Sequence[tuple[Candidate, float]], size: Size) -> None:
        if log.isEnabledFor(logging.INFO):
            prices = ", ".join(f"{candidate.name} {cost:.3g} s" for candidate, cost in costs)
            left_out = self._left_out(size, [candidate for candidate, _ in costs])
            log.info(
                "PC %s chosen for %d unknowns; a solve is expected to cost: %s%s",
                chosen.name,
                size.unknowns,
                prices,
                left_out,
            )

    def foreseen(self, size: Size) -> Candidate:
        """The candidate that a call would choose; nothing is counted."""
        self.systems += 1.0
        try:
            return min(self.open(size), key=lambda candidate: self.cost(candidate, size))
        finally:
            self.systems -= 1.0

    def candidates(self, size: Size) -> tuple[Candidate, ...]:
        """What may be chosen for matrices of that size."""
        known = candidates(replace(self.traits, dimension=size.dimension))
        known = tuple(one for one in known if not one.shared or size.ranks > 1)
        if not self.krylov:
            return known
        same = tuple(one for one in known if one.krylov == self.krylov)
        return same or tuple(one for one in known if one.krylov != "bcgs")

    def open(self, size: Size) -> list[Candidate]:
        """The candidates that fit in memory and have not failed; the last one where there is no other."""
        known = self.candidates(size)
        return [c for c in known if c.name not in self.excluded and self.fits(c, size)] or [known[-1]]

    def _left_out(self, size: Size, found: Sequence[Candidate]) -> str:
        """The candidates that are not priced, and why, for the log."""
        reasons = []
        for candidate in self.candidates(size):
            if candidate.name in self.excluded:
                reasons.append(f"{candidate.name} has failed")
            elif candidate not in found:
                factor = self._bytes(candidate, size)
                reasons.append(f"{candidate.name} needs {factor:.3g} bytes of {self.memory:.3g}")
        return "; left out: " + ", ".join(reasons) if reasons else ""

    def fits(self, candidate: Candidate, size: Size) -> bool:
        """Whether a complete factor is small enough; others always are."""
        if candidate.shared and border_unknowns(size) > MOST_BORDER:
            return False
        return not candidate.complete or self._bytes(candidate, size) <= self.memory

    def _bytes(self, candidate: Candidate, size: Size) -> float:
        """That a factor takes; LU has two triangles."""
        return FACTOR_BYTES * self.filled(candidate, size) * (2.0 if candidate.kind == "lu" else 1.0)

    def cost(self, candidate: Candidate, size: Size) -> float:
        """Seconds of a solve: iterations, and a share of refreshes and of the set-up.

        With iterations that grow by g a solve, a refresh every sqrt(2 refresh / (iteration g)) solves costs least: by
        then the iterations spent beyond those of a fresh preconditioner have cost as much as the refresh.
        """
        price = self.prices(candidate, size)
        fresh, growth = self.expected(candidate, size)
        system = self.solves / self.systems
        rent = price.iteration * growth
        life = min(system, math.sqrt(2.0 * price.refresh / rent)) if rent > 0 else system
        life = max(1.0, life)
        setup = max(0.0, price.setup - price.refresh) / system
        aged = price.iteration * (fresh + growth * life / 2.0) + price.refresh / life
        if self.uses > 1 and candidate.complete and size.ranks == 1:
            # A new factor for each matrix is applied without an iteration.
            aged = min(aged, price.refresh / self.uses + price.apply)
        return aged + setup

    def prices(self, candidate: Candidate, size: Size, filled: float = 0.0) -> Prices:
        """What a candidate costs, with so many nonzeros where they are known."""
        filled = filled or self.filled(candidate, size)
        if candidate.shared:
            return shared_prices(size, filled, self.calibration)
        if not candidate.krylov:
            return prices(candidate.kind, size, filled, self.calibration)
        fresh, _ = self.expected(candidate, size)
        known, exchanges = self.calibration, candidate.exchanges
        return flow_prices(candidate.kind, candidate.krylov, size, filled, known, fresh, exchanges)

    def expected(self, candidate: Candidate, size: Size) -> tuple[float, float]:
        """Iterations with a fresh preconditioner, and how many each solve of age adds."""
        scale = self._scale(candidate, size)
        fresh, growth = self._iterations_of(candidate, size).line()
        return max(1.0, fresh * scale), growth * scale

    def filled(self, candidate: Candidate, size: Size) -> float:
        """Nonzeros of the factors, or grids, on all ranks: by the prior, corrected by the last one counted."""
        return self._prior_fill(candidate, size) * self.fill.get((candidate.name, size.dimension), 1.0)

    def count(self, candidate: Candidate, size: Size, age: int, iterations: float) -> None:
        """Take in a solve with a preconditioner that was made `age` solves before."""
        if self._counted[0] is not candidate or self._counted[1] is not size:
            self._counted = candidate, size, self._iterations_of(candidate, size), self._scale(candidate, size)
        _, _, known, scale = self._counted
        if candidate.krylov:
            known.fade()
        known.count(age, iterations / scale)
        self._since += 1
        self.solves += 1.0

    def count_fill(self, candidate: Candidate, size: Size, filled: float) -> None:
        """Take in the nonzeros, on all ranks, of a preconditioner that has been made."""
        self.fill[candidate.name, size.dimension] = filled / self._prior_fill(candidate, size)

    def exclude(self, candidate: Candidate) -> None:
        """Never choose a candidate again: it has failed."""
        self.excluded.add(candidate.name)

    def _iterations_of(self, candidate: Candidate, size: Size) -> Iterations:
        key = (candidate.name, size.dimension, size.ranks)
        if key not in self.iterations:
            self.iterations[key] = Iterations(candidate.prior(size.dimension).growth(size.unknowns / size.share))
        return self.iterations[key]

    def _scale(self, candidate: Candidate, size: Size) -> float:
        """Iterations that the prior expects of a fresh preconditioner."""
        prior = candidate.prior(size.dimension)
        # Patterns of nodes are what iterations and fill hang on, whatever the number of unknowns a node.
        nodes = size.unknowns / size.share
        fresh, doublings = prior.fresh(nodes), math.log2(size.ranks)
        coupled = prior.exact(nodes) * doublings**MORE_RANKS
        if candidate.complete:
            return fresh + coupled
        if candidate.kind in ("icc", "ilu"):
            fresh *= size.width**WIDER_FRESH
        return fresh + max(prior.block * fresh * doublings, coupled)

    def _prior_fill(self, candidate: Candidate, size: Size) -> float:
        prior = candidate.prior(size.dimension)
        if not candidate.complete:
            return prior.filled(size.nonzeros)
        wider = size.width**WIDER_FILL
        rows = size.unknowns / size.share / size.ranks
        return max(size.nonzeros / 2.0, wider * size.ranks * size.share**2 * prior.filled(rows))
