"""Which equations a scene makes, and which solvers they get, and why."""

from collections.abc import Sequence
from dataclasses import dataclass

DEFINITE, INDEFINITE, UNSYMMETRIC = "symmetric positive definite", "symmetric indefinite", "unsymmetric"

HARDNESS = ("linear", "eigenvalues", "nonlinear")
"""Kinds of equations, from the easiest on."""


@dataclass(frozen=True)
class System:
    """Linear systems of one kind.

    Args:
        of: what they give.
        matrix: "symmetric positive definite", "symmetric indefinite" or "unsymmetric".
        krylov: PETSc's KSP, beside a kept preconditioner; empty where eigenvalues are iterated for.
        factor: "cholesky" or "lu", where it is complete.
        why: for people.
    """

    of: str
    matrix: str
    krylov: str
    factor: str
    why: str


@dataclass(frozen=True)
class SolverPlan:
    """How the equations of a scene are solved.

    Args:
        equations: "linear", "nonlinear" or "eigenvalues".
        systems: the linear systems that are solved, those of the displacement first.
        why: the equations are of that kind.
    """

    equations: str
    systems: tuple[System, ...]
    why: str

    @property
    def symmetric(self) -> bool:
        """Whether the first of the systems is symmetric."""
        return self.systems[0].matrix != UNSYMMETRIC


def joint(plans: Sequence[SolverPlan]) -> SolverPlan:
    """The plan of several physics at once: as hard as the hardest of them."""
    if not plans:
        return SolverPlan("linear", (), "nothing is looked for")
    if len(plans) == 1:
        return plans[0]
    equations = max((plan.equations for plan in plans), key=HARDNESS.index)
    return SolverPlan(equations, tuple(s for plan in plans for s in plan.systems), "; ".join(p.why for p in plans))
