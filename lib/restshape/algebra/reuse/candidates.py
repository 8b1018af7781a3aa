"""Preconditioners that a linear system may get, and what is expected of them before anything has been counted."""

from dataclasses import dataclass, replace
from typing import NamedTuple

from restshape.algebra.reuse.traits import Traits

DECADES = 2.5
"""Powers of ten by which solves of Newton's steps make residuals smaller, as prior iterations were measured."""
SHORT = 0.7
"""Iterations of BiCGStab over those of GMRES."""


class Law(NamedTuple):
    """A count that grows like factor x n^power."""

    factor: float
    power: float

    def __call__(self, n: float) -> float:
        return self.factor * n**self.power


NO_MORE = Law(0.0, 0.0)


@dataclass(frozen=True)
class Prior:
    """What is expected of a preconditioner before the replay has counted anything.

    Measured on the plate whose hole is dragged (2,000, 18,000 and 70,000 unknowns; guesses extrapolated, 1e-6) and on
    boxes of first-order tetrahedra constrained on one side (2,200, 6,600 and 21,000 unknowns): two and three unknowns a
    node.

    Args:
        filled: nonzeros of the factor, or of the matrices of all grids; of the unknowns (complete) or of the matrix.
        fresh: iterations with a fresh one.
        growth: part of them that each solve of age adds, of the nodes: steps of a hand are no larger on a finer mesh.
        block: part of the iterations of an incomplete factor that each doubling of the ranks adds, where it is of the
            ranks' own rows.
        exact: iterations that a complete one of the ranks' own rows takes more on two ranks, of the unknowns: what
            couples the ranks is in neither. An incomplete one of the same rows takes as many more at least.
    """

    filled: Law
    fresh: Law
    growth: Law
    block: float = 0.0
    exact: Law = NO_MORE


SLOW, STEADY = Law(0.02, 0.0), Law(0.03, 0.0)
AGED = Law(3.9, -0.3)
"""Growth with incomplete factors, with multigrid, and with complete factors: on the plate, with projected guesses,
these add 0.47, 0.23, 0.10 and 0.07 a solve at 2,100, 19,000, 77,000 and 242,000 unknowns, those of heat in it 0.03 from
10,000 on (iterations and factors of `replay --csv` with `-solid_pc_type cholesky`)."""
COUPLED = Law(1.2, 1 / 3)
"""Iterations that Cholesky factors of the ranks' rows with two layers of others' take more on two ranks: on the plate
15, 23 and 31 at 2,100, 5,700 and 19,300 unknowns."""
MORE_RANKS = 0.75
"""Power of the doublings of the ranks in these iterations: on four and eight ranks 58 and 71 at 19,300 unknowns."""


@dataclass(frozen=True)
class Candidate:
    """A preconditioner that `auto` may choose.

    Args:
        name: in tables.
        kind: PETSc's type.
        levels: of fill, where incomplete.
        plane, space: what to expect of problems that declare these dimensions.
        krylov: PETSc's type of the iteration; empty leaves it to the traits.
        exchanges: a complete factor exchanges rows (MUMPS).
        shared: a complete factor of the whole matrix that several ranks share.
    """

    name: str
    kind: str
    levels: int
    plane: Prior
    space: Prior
    krylov: str = ""
    exchanges: bool = False
    shared: bool = False

    @property
    def complete(self) -> bool:
        """Whether it is a complete factor."""
        return self.kind in ("cholesky", "lu")

    def prior(self, dimension: int) -> Prior:
        """What to expect in that dimension of space."""
        return self.space if dimension == 3 else self.plane


def incomplete(kind: str) -> tuple[Candidate, Candidate]:
    """The incomplete factors ICC(k), or ILU(k), with the level that served best: 3 in the plane, 1 in space."""
    half = 0.5 if kind == "icc" else 1.0
    plane = Prior(Law(2.75 * half, 1.0), Law(0.56, 1 / 2), SLOW, 0.1, COUPLED)
    space = Prior(Law(1.75 * half, 1.0), Law(1.6, 1 / 3), SLOW, 0.1, COUPLED)
    return Candidate(f"{kind}(3)", kind, 3, plane, plane), Candidate(f"{kind}(1)", kind, 1, space, space)


WHOLE = Prior(Law(4.05, 1.24), Law(1.0, 0.0), AGED)
WHOLE_SPACE = Prior(Law(1.76, 1.58), Law(1.0, 0.0), Law(0.4, 0.0))
"""Complete factors of a whole matrix."""
CHOLESKY = Candidate("cholesky", "cholesky", 0, replace(WHOLE, exact=COUPLED), replace(WHOLE_SPACE, exact=COUPLED))
SHARED = Candidate("cholesky, shared", "cholesky", 0, WHOLE, WHOLE_SPACE, shared=True)
ICC, ICC_SPACE = incomplete("icc")
ILU, ILU_SPACE = incomplete("ilu")
GAMG = Candidate(
    "gamg",
    "gamg",
    0,
    Prior(Law(1.4, 1.0), Law(8.0, 0.0), STEADY),
    Prior(Law(1.25, 1.0), Law(9.0, 0.0), STEADY),
)
PLANE = (CHOLESKY, SHARED, ICC, ILU, GAMG)
SPACE = (CHOLESKY, ICC_SPACE, ILU_SPACE, GAMG)


def of_flow(rate: bool) -> tuple[Candidate, ...]:
    """Candidates for matrices that are not symmetric: a complete factor, ILU(0) to ILU(2), and how they iterate.

    Measured on flows of three unknowns a node, 2,000 to 17,000 unknowns (`python scripts/unsymmetric.py`): steady, and
    with a rate of a time step in the matrix (`rate`), which leaves less to the pressure alone. Iterations are those of
    GMRES to a residual that is smaller by `DECADES`; BiCGStab takes `SHORT` times as many, of two products each.
    """
    power = (0.38, 0.38, 0.38) if rate else (0.6, 0.5, 0.5)
    fresh = (0.75, 0.46, 0.36) if rate else (0.37, 0.45, 0.32)
    growth, fill = (0.1, 0.12, 0.15) if rate else (0.05, 0.05, 0.05), (1.0, 1.5, 2.04)
    complete = Prior(Law(4.05, 1.24), Law(1.0, 0.0), Law(0.5, 0.0), exact=Law(6.0, 0.0))
    found = [Candidate("lu", "lu", 0, complete, complete, "fgmres")]
    for krylov, before, share in (("fgmres", "", 1.0), ("bcgs", "bicgstab+", SHORT)):
        for level in range(3):
            prior = Prior(Law(fill[level], 1.0), Law(share * fresh[level], power[level]), Law(growth[level], 0.0), 0.1)
            found.append(Candidate(f"{before}ilu({level})", "ilu", level, prior, prior, krylov))
    return (*found, Candidate("lu, rows exchanged", "lu", 0, complete, complete, "fgmres", True))


FLOW_IN_TIME, STEADY_FLOW = of_flow(True), of_flow(False)
THESIS_FLOW = next(one for one in FLOW_IN_TIME if one.name == "bicgstab+ilu(0)")
"""What the thesis solves systems by that are not symmetric (4.2.3)."""


def candidates(traits: Traits) -> tuple[Candidate, ...]:
    """What may be chosen for matrices with these traits; nothing where a complete factor is all that is known of.

    Those of bodies that are not symmetric are nearly so, and may be indefinite: no incomplete factor is known to serve.
    """
    if traits.minimises:
        return SPACE if traits.dimension == 3 else PLANE
    if traits.symmetric or traits.rigid_motions:
        return ()
    return FLOW_IN_TIME if traits.rate else STEADY_FLOW
