"""A comparison of a computed value with a reference."""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any, Literal

from petsc4py import PETSc

Kind = Literal["closed form", "published", "independent program", "identity", "own"]

CLOSED_FORM: Kind = "closed form"
PUBLISHED: Kind = "published"
PROGRAM: Kind = "independent program"
IDENTITY: Kind = "identity"
OWN: Kind = "own"
REFERENCE_KINDS = (CLOSED_FORM, PUBLISHED, PROGRAM, IDENTITY)
"""Kinds of references that restshape did not compute: the only ones of `restshape validate`. docs/validation.md."""

ROUNDING = 1e-12
"""The tolerance of what is exact but for rounding."""


@dataclass(frozen=True)
class Check:
    """One computed value beside its reference.

    Args:
        quantity: what is compared, with its unit.
        value: computed.
        reference: what it should be.
        tolerance: largest error that passes: relative to the reference, absolute where the reference is 0.
        source: where the reference comes from.
        kind: what it is: a formula, a printed number, another program's number, what must be equal, or restshape's own.
    """

    quantity: str
    value: float
    reference: float
    tolerance: float
    source: str
    kind: Kind

    @property
    def error(self) -> float:
        """The error, relative to the reference, or absolute where that is 0."""
        difference = abs(self.value - self.reference)
        return difference / abs(self.reference) if self.reference else difference

    @property
    def passed(self) -> bool:
        """Whether the error is within the tolerance."""
        return bool(self.error <= self.tolerance)

    def as_dict(self, case: str) -> dict[str, Any]:
        """The row of `validate --json`."""
        return {"case": case, **asdict(self), "error": self.error, "passed": self.passed}


Case = Callable[[PETSc.Comm], list[Check]]
"""A named comparison: runs on all ranks of a communicator and gives the same checks on each."""
