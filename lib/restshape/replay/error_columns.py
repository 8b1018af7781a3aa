"""Errors of quantities beside their values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from restshape.analysis.row_values import text, whole
from restshape.analysis.static.quantity_errors import LEAVE_OUT, NO_ERRORS, NONE_HERE
from restshape.errors import UserError
from restshape.replay.columns import asked_errors, error_column, estimated_quantities
from restshape.scene.plain_values import table_in
from restshape.scene.quantity import ALL_ERRORS

if TYPE_CHECKING:
    from restshape.analysis.analysis import QuantityErrors, RowValues
    from restshape.application import Application
    from restshape.replay.estimated_frames import WantedErrors
    from restshape.scene.model import Scene


def refuse_asked_errors(scene: Scene) -> None:
    """Refuses errors that a scene asks for where its analysis estimates none.

    Raises:
        UserError: a quantity asks for its error.
    """
    for name in asked_errors(scene):
        raise scene.located(UserError(NONE_HERE, f"quantities.{name}.error", LEAVE_OUT))


class QuantityErrorColumns:
    """Estimates errors of the quantities that a scene wants them of, frame after frame.

    Args:
        scene: of the replay.
        application: of the scene.
        estimates: of the analysis that gives the quantities; None: it has none.
        singular: quantities without a limit under refinement; may change from frame to frame.

    Raises:
        UserError: a quantity asks for an error that this analysis does not estimate.

    Attributes:
        asked: those of `names` whose errors the scene asks for; the others have a limit.
        solves: an estimate takes a solve of its own, or two.
        note: that there are none, where the scene asks for those of all quantities.
    """

    def __init__(
        self, scene: Scene, application: Application, estimates: QuantityErrors | None, singular: Mapping[str, float]
    ) -> None:
        self.note = ""
        self.names = estimated_quantities(scene, application)
        self.estimates = estimates
        if self.estimates is None:
            refuse_asked_errors(scene)
            self.note = NO_ERRORS if table_in(scene.raw, "quantities").get(ALL_ERRORS) is True else ""
            self.names = []
        self.singular = singular
        self._known: tuple[object, list[str], dict[str, float]] = (None, [], {})
        self.solves = bool(getattr(estimates, "solves", False))
        self.asked = [name for name in self.names if scene.quantities[name].error]

    def __call__(self, row: RowValues, wanted: WantedErrors, state: object) -> RowValues:
        """The columns of a frame that was solved; infinite where a quantity has no limit under refinement.

        The first frame also has the note.

        Args:
            row: of the frame.
            wanted: what is estimated of it; the others are no numbers.
            state: of the analysis; what has been estimated of it is not estimated again.
        """
        if self.estimates is None:
            first = self.note and not whole(row, "index")
            return {"note": "; ".join(filter(None, (text(row, "note"), self.note)))} if first else {}
        if not self.names:
            return {}
        found: dict[str, float] = dict.fromkeys(self.singular, np.inf)
        # An estimate that solves for nothing costs next to nothing.
        wished = self.names if wanted.solves or (wanted.answer and not self.solves) else self.asked
        names = [name for name in wished if name not in self.singular] if wanted.answer else []
        if self._known[0] is not state or self._known[1] != names:
            self._known = (state, names, self.estimates(names) if names else {})
        found |= self._known[2]
        return {error_column(name): found.get(name, np.nan) for name in self.names}
