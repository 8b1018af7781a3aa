"""Which preconditioner a linear system gets: the one of which counted work, priced by the calibration, costs least."""

import logging
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

from restshape.algebra.traits import Traits
from restshape.calibration import Calibration

log = logging.getLogger("restshape.algebra")

MEMORY = 4e9
"""Bytes that a complete factor may take, over all ranks, unless the scene says otherwise (`solve.factor_memory`)."""
FACTOR_BYTES = 12.0
"""Of a nonzero of a factor: its value and its column."""
SINGLE_SYMBOLIC, SINGLE_NUMERIC, SINGLE_SOLVE = 4.0, 2.2, 1.9
"""Seconds a nonzero of a factor of single numbers over those of one in blocks of a node, which the calibration has:
`python scripts/factors.py`. Complete Cholesky factors have blocks where a node has several unknowns."""
PRIOR_SOLVES = 4
"""Solves that the prior iterations weigh as much as, beside those that this replay has counted."""
PRIOR_LIFE = 100.0
"""Solves on one mesh before the replay has counted any."""
ROW = 14.0
"""Nonzeros of a row in the plane, two unknowns a node, with the first-order triangles that priors were measured on."""
WIDER_FILL, WIDER_FRESH = 0.45, -0.9
"""Powers of a row's nonzeros over `ROW` in the nonzeros of a complete factor and in the iterations with an incomplete
one: measured with second-order triangles (23 a row), 2,000 to 70,000 unknowns, within 5 %."""
PRIOR_AGE = 5.0
"""Age of a preconditioner up to which the prior growth of iterations was measured."""


class Law(NamedTuple):
    """A count that grows like factor x n^power."""

    factor: float
    power: float

    def __call__(self, n: float) -> float:
        return self.factor * n**self.power


@dataclass(frozen=True)
class Prior:
    """What is expected of a preconditioner before the replay has counted anything.

    Measured on the plate whose hole is dragged (2,000, 18,000 and 70,000 unknowns; guesses extrapolated, 1e-6) and on
    boxes of first-order tetrahedra constrained on one side (2,200, 6,600 and 21,000 unknowns): two and three unknowns a
    node.

    Args:
        filled: nonzeros of the factor, or of the matrices of all grids; of the unknowns (complete) or of the matrix.
        fresh: iterations with a fresh one.
        growth: part of them that each solve of age adds.
        block: what each doubling of the ranks adds, for factors of the ranks' own rows: iterations of a complete
            factor, part of the iterations of an incomplete one.
    """

    filled: Law
    fresh: Law
    growth: float
    block: float = 0.0


@dataclass(frozen=True)
class Candidate:
    """A preconditioner that `auto` may choose.

    Args:
        name: in tables.
        kind: PETSc's type.
        levels: of fill, where incomplete.
        plane, space: what to expect of problems that declare these dimensions.
    """

    name: str
    kind: str
    levels: int
    plane: Prior
    space: Prior

    def prior(self, dimension: int) -> Prior:
        """What to expect in that dimension of space."""
        return self.space if dimension == 3 else self.plane


def incomplete(kind: str) -> tuple[Candidate, Candidate]:
    """The incomplete factors ICC(k), or ILU(k), with the level that served best: 3 in the plane, 1 in space."""
    half = 0.5 if kind == "icc" else 1.0
    plane = Prior(Law(2.75 * half, 1.0), Law(0.56, 1 / 2), 0.02, 0.1)
    space = Prior(Law(1.75 * half, 1.0), Law(1.6, 1 / 3), 0.02, 0.1)
    return Candidate(f"{kind}(3)", kind, 3, plane, plane), Candidate(f"{kind}(1)", kind, 1, space, space)


CHOLESKY = Candidate(
    "cholesky",
    "cholesky",
    0,
    Prior(Law(4.05, 1.24), Law(1.0, 0.0), 0.4, 12.0),
    Prior(Law(1.76, 1.58), Law(1.0, 0.0), 0.4, 12.0),
)
ICC, ICC_SPACE = incomplete("icc")
ILU, ILU_SPACE = incomplete("ilu")
GAMG = Candidate(
    "gamg",
    "gamg",
    0,
    Prior(Law(1.4, 1.0), Law(8.0, 0.0), 0.03),
    Prior(Law(1.25, 1.0), Law(9.0, 0.0), 0.03),
)
PLANE = (CHOLESKY, ICC, ILU, GAMG)
SPACE = (CHOLESKY, ICC_SPACE, ILU_SPACE, GAMG)


def candidates(traits: Traits) -> tuple[Candidate, ...]:
    """What may be chosen for matrices with these traits; nothing where a complete factor is all that is known of."""
    if not traits.minimises:
        return ()
    return SPACE if traits.dimension == 3 else PLANE


@dataclass(frozen=True)
class Size:
    """A linear system as the choice sees it; all counts are global, so that all ranks choose alike.

    Args:
        unknowns: rows.
        nonzeros: of the matrix.
        dimension: that the problem declares.
        ranks: that share it.
        fields: unknowns a node that the problem declares; 0: those of elastic bodies, as priors were measured on.
    """

    unknowns: int
    nonzeros: float
    dimension: int = 2
    ranks: int = 1
    fields: int = 0

    @property
    def share(self) -> float:
        """Unknowns a node over those of elastic bodies in that dimension."""
        return self.fields / self.dimension if self.fields else 1.0

    @property
    def width(self) -> float:
        """Nonzeros of a row over those of first-order triangles, in the plane; never less than 1."""
        return (
            max(1.0, self.nonzeros / (ROW * self.share * self.unknowns))
            if self.dimension == 2 and self.unknowns
            else 1.0
        )


class Prices(NamedTuple):
    """Seconds of an iteration, of a refresh on a pattern that has been analysed, and of a first set-up."""

    iteration: float
    refresh: float
    setup: float


def prices(kind: str, size: Size, filled: float, known: Calibration) -> Prices:
    """What a preconditioner of PETSc's type `kind` costs with `filled` nonzeros in all; ranks share the work evenly."""
    if kind != "cholesky" or size.fields == 1:
        known = _of_single_numbers(known)
    filled = filled / size.ranks
    work = (math.ceil(size.unknowns / size.ranks), size.nonzeros / size.ranks)
    once = known.pass_seconds(*work)
    if kind in ("ilu", "icc"):
        numeric = (known.ilu_numeric_nonzero if kind == "ilu" else known.numeric_nonzero) * filled
        apply = known.ilu_solve_nonzero * filled if kind == "ilu" else known.solve_nonzero * 2.0 * filled
        return Prices(apply + once, numeric + once, known.symbolic_nonzero * filled + numeric + once)
    if kind == "gamg":
        refresh = known.gamg_refresh_nonzero * filled + once
        return Prices(known.gamg_solve_nonzero * filled + once, refresh, known.gamg_setup_nonzero * filled + once)
    return Prices(
        known.iteration_seconds(*work, filled),
        known.refresh_seconds(*work, filled),
        known.factor_seconds(*work, filled),
    )


@lru_cache(maxsize=4)
def _of_single_numbers(known: Calibration) -> Calibration:
    return replace(
        known,
        symbolic_nonzero=SINGLE_SYMBOLIC * known.symbolic_nonzero,
        numeric_nonzero=SINGLE_NUMERIC * known.numeric_nonzero,
        numeric_work=SINGLE_NUMERIC * known.numeric_work,
        solve_nonzero=SINGLE_SOLVE * known.solve_nonzero,
    )


class Iterations:
    """Iterations of a solve as a line over the age of its preconditioner, in units of those expected of a fresh one.

    Fitted by least squares to what is counted and to the prior, which weighs as much as `PRIOR_SOLVES` solves.
    """

    def __init__(self, growth: float) -> None:
        self.sums = (0.0, 0.0, 0.0, 0.0, 0.0)
        for _ in range(PRIOR_SOLVES // 2):
            self.count(0.0, 1.0)
            self.count(PRIOR_AGE, 1.0 + growth * PRIOR_AGE)

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

    Source: docs/theory/levels-of-reuse.md.
    """

    def __init__(self, calibration: Calibration, memory: float = MEMORY) -> None:
        self.calibration, self.memory = calibration, memory
        self.iterations: dict[tuple[str, int, int], Iterations] = {}
        self.fill: dict[tuple[str, int], float] = {}
        self.excluded: set[str] = set()
        self.systems, self.solves = 1.0, PRIOR_LIFE

    def __call__(self, size: Size) -> Candidate:
        """The candidate of which a solve is expected to cost least; ties go to the first of the list."""
        self.systems += 1.0
        found = self.open(size)
        costs = [(candidate, self.cost(candidate, size)) for candidate in found]
        chosen = min(costs, key=lambda priced: priced[1])[0]
        if log.isEnabledFor(logging.INFO):
            prices = ", ".join(f"{candidate.name} {cost:.3g} s" for candidate, cost in costs)
            left_out = self._left_out(size, found)
            log.info(
                "PC %s chosen for %d unknowns; a solve is expected to cost: %s%s",
                chosen.name,
                size.unknowns,
                prices,
                left_out,
            )
        return chosen

    def foreseen(self, size: Size) -> Candidate:
        """The candidate that a call would choose; nothing is counted."""
        self.systems += 1.0
        try:
            return min(self.open(size), key=lambda candidate: self.cost(candidate, size))
        finally:
            self.systems -= 1.0

    @staticmethod
    def candidates(traits: Traits) -> tuple[Candidate, ...]:
        """What may be chosen for matrices with these traits."""
        return candidates(traits)

    def open(self, size: Size) -> list[Candidate]:
        """The candidates that fit in memory and have not failed; GAMG where there is no other."""
        known = candidates(Traits(dimension=size.dimension))
        return [c for c in known if c.name not in self.excluded and self.fits(c, size)] or [GAMG]

    def _left_out(self, size: Size, found: Sequence[Candidate]) -> str:
        """The candidates that are not priced, and why, for the log."""
        reasons = []
        for candidate in candidates(Traits(dimension=size.dimension)):
            if candidate.name in self.excluded:
                reasons.append(f"{candidate.name} has failed")
            elif candidate not in found:
                factor = FACTOR_BYTES * self.filled(candidate, size)
                reasons.append(f"{candidate.name} needs {factor:.3g} bytes of {self.memory:.3g}")
        return "; left out: " + ", ".join(reasons) if reasons else ""

    def fits(self, candidate: Candidate, size: Size) -> bool:
        """Whether a complete factor is small enough; others always are."""
        return candidate.kind != "cholesky" or FACTOR_BYTES * self.filled(candidate, size) <= self.memory

    def cost(self, candidate: Candidate, size: Size) -> float:
        """Seconds of a solve: iterations, and a share of refreshes and of the set-up.

        With iterations that grow by g a solve, a refresh every sqrt(2 refresh / (iteration g)) solves costs least: by
        then the iterations spent beyond those of a fresh preconditioner have cost as much as the refresh.
        """
        price = prices(candidate.kind, size, self.filled(candidate, size), self.calibration)
        fresh, growth = self.expected(candidate, size)
        system = self.solves / self.systems
        rent = price.iteration * growth
        life = min(system, math.sqrt(2.0 * price.refresh / rent)) if rent > 0 else system
        life = max(1.0, life)
        setup = max(0.0, price.setup - price.refresh) / system
        return price.iteration * (fresh + growth * life / 2.0) + price.refresh / life + setup

    def expected(self, candidate: Candidate, size: Size) -> tuple[float, float]:
        """Iterations with a fresh preconditioner, and how many each solve of age adds."""
        scale = self._scale(candidate, size)
        fresh, growth = self._iterations_of(candidate, size).line()
        return max(1.0, fresh * scale), growth * scale

    def filled(self, candidate: Candidate, size: Size) -> float:
        """Nonzeros of the factors, or grids, on all ranks: by the prior, corrected by the last one counted."""
        return self._prior_fill(candidate, size) * self.fill.get((candidate.name, size.dimension), 1.0)

    def count(self, candidate: Candidate, size: Size, age: int, iterations: int) -> None:
        """Take in a solve with a preconditioner that was made `age` solves before."""
        self._iterations_of(candidate, size).count(age, iterations / self._scale(candidate, size))
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
            self.iterations[key] = Iterations(candidate.prior(size.dimension).growth)
        return self.iterations[key]

    def _scale(self, candidate: Candidate, size: Size) -> float:
        """Iterations that the prior expects of a fresh preconditioner."""
        prior = candidate.prior(size.dimension)
        # Patterns of nodes are what iterations and fill hang on, whatever the number of unknowns a node.
        fresh, doublings = prior.fresh(size.unknowns / size.share), math.log2(size.ranks)
        if candidate.kind == "cholesky":
            return fresh + prior.block * doublings
        if candidate.kind in ("icc", "ilu"):
            fresh *= size.width**WIDER_FRESH
        return fresh * (1.0 + prior.block * doublings)

    def _prior_fill(self, candidate: Candidate, size: Size) -> float:
        prior = candidate.prior(size.dimension)
        if candidate.kind != "cholesky":
            return prior.filled(size.nonzeros)
        wider = size.width**WIDER_FILL
        rows = size.unknowns / size.share / size.ranks
        return max(size.nonzeros / 2.0, wider * size.ranks * size.share**2 * prior.filled(rows))
