"""What preconditioners and iterations cost, from counted nonzeros and a calibration."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

from restshape.calibration import Calibration

SINGLE_SYMBOLIC, SINGLE_NUMERIC, SINGLE_SOLVE, SINGLE_PRODUCT = 2.3, 1.25, 1.6, 1.45
"""Seconds a nonzero of a complete factor, or of a matrix, with one unknown a node over those of one with two, which the
calibration has: `python scripts/factors.py`, as are those that follow."""
SINGLE_CYCLE, SINGLE_REFRESH, SINGLE_SETUP = 2.3, 1.4, 1.7
"""The same of algebraic multigrid."""
PETSC_SYMBOLIC, PETSC_NUMERIC, PETSC_SOLVE = 2.3, 2.2, 3.3
"""Of PETSc's incomplete factors, whatever the unknowns a node: a nonzero over one of a complete factor in blocks of a
node, as was measured with the calibration."""
SPACE_WORK, SPACE_CYCLE, SPACE_PRODUCT = 3.0, 0.6, 3.4
"""Of bodies in space over the plane: the growing part of a complete factor, a nonzero of a cycle and of a product."""
ROW = 14.0
"""Nonzeros of a row in the plane, two unknowns a node, with the first-order triangles that priors were measured on."""
EXCHANGE, COARSENING = 5e-6, 10.0
"""Seconds of an exchange of values at borders of ranks, or of a sum over them; unknowns of a grid of GAMG's over those
of the next one, in the plane."""
SHARED_EXCHANGES, SHARED_SYMBOLIC = 10.0, 3.0
"""Exchanges of an application of a factor that ranks share; analysis of its pattern over that of one rank's factor."""
MOST_BORDER = 4_000
"""Unknowns that couple ranks up to which one factor of them all may be chosen: a dense factor of 0.1 GB."""
RESTART = 100
"""Directions that GMRES keeps: complete factors need few, incomplete ones of slender bodies stall with PETSc's 30."""


@dataclass(frozen=True)
class Size:
    """A linear system as the choice sees it; all counts are global, so that all ranks choose alike.

    Args:
        unknowns: rows.
        nonzeros: of the matrix.
        dimension: that the problem declares.
        ranks: that share it.
        fields: unknowns a node that the problem declares; 0: those of elastic bodies, as priors were measured on.
        blocks: the matrix is in blocks of a node (BAIJ).
        sheet: nodes couple along a surface.
    """

    unknowns: int
    nonzeros: float
    dimension: int = 2
    ranks: int = 1
    fields: int = 0
    blocks: bool = False
    sheet: bool = False

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
    """Seconds of an iteration, of a refresh on a pattern that has been analysed, and of a first set-up.

    Of an iteration: of one application, of one product, and of what is done besides.
    """

    iteration: float
    refresh: float
    setup: float
    apply: float = 0.0
    product: float = 0.0
    vectors: float = 0.0


def prices(kind: str, size: Size, filled: float, known: Calibration) -> Prices:
    """What a preconditioner of PETSc's type `kind` costs with `filled` nonzeros in all; ranks share the work evenly."""
    known = _scaled(known, "incomplete factors") if kind in ("ilu", "icc") else known
    known = _scaled(known, "single numbers") if size.fields == 1 and kind in ("cholesky", "gamg") else known
    known = _scaled(known, "bodies in space") if size.dimension == 3 and not size.sheet else known
    filled = filled / size.ranks
    work = (math.ceil(size.unknowns / size.ranks), size.nonzeros / size.ranks)
    once, product = known.pass_seconds(*work) + exchange_seconds(kind, size), known.matvec_nonzero * work[1]
    if kind in ("ilu", "icc"):
        numeric = (known.ilu_numeric_nonzero if kind == "ilu" else known.numeric_nonzero) * filled
        apply = known.ilu_solve_nonzero * filled if kind == "ilu" else known.solve_nonzero * 2.0 * filled
        costs = apply + once, numeric + once, known.symbolic_nonzero * filled + numeric + once
    elif kind == "gamg":
        refresh = known.gamg_refresh_nonzero * filled + once
        costs = known.gamg_solve_nonzero * filled + once, refresh, known.gamg_setup_nonzero * filled + once
    else:
        costs = (
            known.iteration_seconds(*work, filled) + exchange_seconds(kind, size),
            known.refresh_seconds(*work, filled),
            known.factor_seconds(*work, filled),
        )
    return Prices(*costs, costs[0] - once, product, once - product)


def border_unknowns(size: Size) -> int:
    """Unknowns that couple the parts of so many ranks, about: of halves of halves of a square."""
    nodes = size.unknowns / (size.fields or size.dimension)
    return round((size.fields or size.dimension) * math.sqrt(nodes) * (math.sqrt(2.0 * size.ranks) - 1.0))


def shared_prices(size: Size, filled: float, known: Calibration) -> Prices:
    """What a complete Cholesky factor costs that ranks share: each its inside, the first one their border, dense."""
    inside, border = prices("cholesky", size, filled, known), 0.5 * border_unknowns(size) ** 2
    apply = inside.apply + 2.0 * known.solve_nonzero * border + SHARED_EXCHANGES * EXCHANGE
    numeric = inside.refresh + known.numeric_nonzero * border + known.numeric_work * border**1.5
    symbolic = SHARED_SYMBOLIC * (inside.setup - inside.refresh)
    once = inside.product + inside.vectors
    return Prices(apply + once, numeric, symbolic + numeric, apply, inside.product, inside.vectors)


def exchange_seconds(kind: str, size: Size) -> float:
    """What an iteration waits for other ranks: a product, two sums, an overlap twice; of each grid four exchanges."""
    if size.ranks == 1:
        return 0.0
    grids = math.ceil(math.log(max(COARSENING, size.unknowns), COARSENING))
    return EXCHANGE * (3.0 + (4.0 * grids if kind == "gamg" else 2.0))


def flow_prices(
    kind: str, krylov: str, size: Size, filled: float, known: Calibration, iterations: float, exchanges: bool = False
) -> Prices:
    """What a preconditioner of systems that are not symmetric costs, with GMRES or BiCGStab.

    Args:
        kind: "lu", "ilu".
        krylov: "fgmres", "bcgs".
        size: of the system.
        filled: nonzeros in all; of a complete factor those of one triangle.
        known: seconds a unit of counted work.
        iterations: of a solve: GMRES makes each direction orthogonal to all before.
        exchanges: MUMPS makes the factor.
    """
    n, share = math.ceil(size.unknowns / size.ranks), filled / size.ranks
    scale = IN_BLOCKS if size.blocks else BY_POINTS
    product = known.matvec_nonzero * size.nonzeros / size.ranks * scale.product
    if kind == "ilu":
        apply, numeric = known.ilu_solve_nonzero * share * scale.incomplete, known.ilu_numeric_nonzero * share
        symbolic = known.symbolic_nonzero * share
    else:
        apply = known.solve_nonzero * 2.0 * share * scale.solve
        numeric = (known.numeric_nonzero * share + known.numeric_work * share**1.5) * scale.numeric
        symbolic = known.symbolic_nonzero * share * scale.symbolic
    if exchanges:
        apply, numeric, symbolic = EXCHANGED * apply, EXCHANGED * numeric, EXCHANGED * symbolic
    vectors = known.vector_unknown * n
    if krylov == "bcgs":
        vectors = BICGSTAB_VECTORS * vectors + known.iteration
        each = 2.0 * (apply + product) + vectors
    else:
        vectors = vectors * (1.0 + 0.5 * DIRECTION * min(iterations, RESTART)) + known.iteration
        each = apply + product + vectors
    return Prices(each, numeric, symbolic + numeric, apply, product, vectors)


class WorkScale(NamedTuple):
    """Seconds of work on a matrix that is not symmetric over those of the calibration, a nonzero."""

    product: float
    incomplete: float
    solve: float
    numeric: float
    symbolic: float


IN_BLOCKS = WorkScale(0.6, 0.5, 0.95, 1.7, 1.8)
"""In blocks of three, by `python scripts/unsymmetric.py`, as are those that follow."""
BY_POINTS = WorkScale(3.6, 1.3, 3.9, 4.1, 7.4)
EXCHANGED = 3.0
"""A factor with exchanges of rows, over one without."""
DIRECTION = 0.16
"""Making a direction of GMRES orthogonal to another one, over the work on vectors of an iteration of CG."""
BICGSTAB_VECTORS = 2.5
"""Work on vectors of an iteration of BiCGStab, over that of CG."""


_SCALES = {
    "single numbers": {
        "symbolic_nonzero": SINGLE_SYMBOLIC,
        "numeric_nonzero": SINGLE_NUMERIC,
        "numeric_work": SINGLE_NUMERIC,
        "solve_nonzero": SINGLE_SOLVE,
        "matvec_nonzero": SINGLE_PRODUCT,
        "gamg_solve_nonzero": SINGLE_CYCLE,
        "gamg_refresh_nonzero": SINGLE_REFRESH,
        "gamg_setup_nonzero": SINGLE_SETUP,
    },
    "bodies in space": {
        "numeric_work": SPACE_WORK,
        "gamg_solve_nonzero": SPACE_CYCLE,
        "matvec_nonzero": SPACE_PRODUCT,
    },
    "incomplete factors": {
        "symbolic_nonzero": PETSC_SYMBOLIC,
        "numeric_nonzero": PETSC_NUMERIC,
        "numeric_work": PETSC_NUMERIC,
        "solve_nonzero": PETSC_SOLVE,
    },
}
"""Entries of a calibration over those of blocks of two rows with complete factors, by what differs."""


@lru_cache(maxsize=12)
def _scaled(known: Calibration, what: str) -> Calibration:
    return replace(known, **{entry: factor * getattr(known, entry) for entry, factor in _SCALES[what].items()})
