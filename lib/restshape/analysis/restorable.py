"""Analyses that can be brought back to an answer that they have had."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np

    from restshape.algebra.linear_report import LinearReport
    from restshape.analysis.frame import Frame


class KeptAnswer(Protocol):
    """All that an analysis needs to have an answer again; no factors."""

    @property
    def nbytes(self) -> int:
        """Of its arrays."""


class RestorableAnalysis(Protocol):
    """An analysis whose answers hang on the way to them, so that those that there were are worth keeping.

    Its attribute `restorable` is the analysis itself.
    """

    def kept_answer(self) -> KeptAnswer:
        """The answer that it has."""

    def restore(self, kept: KeptAnswer, frame: Frame) -> LinearReport:
        """Have an answer again in a frame whose mesh and scene are those that it was found with, without a solve.

        Raises:
            UserError: the scene's values make no sense; the state is that of before.
        """


@dataclass(frozen=True, eq=False)
class KeptUnknowns:
    """Unknowns of an answer, for a mesh with the same cells.

    Args:
        mesh: they are of; topology: version of its cells.
        x: (n, f) unknowns, to be read only.
    """

    mesh: object
    topology: int
    x: np.ndarray

    @property
    def nbytes(self) -> int:
        """Of the unknowns."""
        return self.x.nbytes


class RecallingAnalysis(Protocol):
    """An analysis that may find another answer than there was where its search starts from the last one.

    Its attribute `recalling` is the analysis itself.
    """

    def kept_answer(self) -> KeptAnswer:
        """What it needs of the answer that it has."""

    def recall(self, kept: KeptAnswer) -> None:
        """Let the next frame find an answer that there was, of which this was kept."""
