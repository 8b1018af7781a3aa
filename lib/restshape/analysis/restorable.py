"""Analyses that can be brought back to an answer that they have had."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
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
