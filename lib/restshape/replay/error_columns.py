"""Errors of quantities beside their values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from restshape.analysis.quantity_errors import LEAVE_OUT, NO_ERRORS, NONE_HERE
from restshape.analysis.row_values import text, whole
from restshape.errors import UserError
from restshape.replay.columns import error_column, estimated_quantities
from restshape.scene.plain_values import table_in
from restshape.scene.quantity import ALL_ERRORS

if TYPE_CHECKING:
    from restshape.analysis.analysis import QuantityErrors, RowValues
    from restshape.application import Application
    from restshape.scene.model import Scene


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
        note: that there are none, where the scene asks for those of all quantities.
    """

    def __init__(
        self, scene: Scene, application: Application, estimates: QuantityErrors | None, singular: Mapping[str, float]
    ) -> None:
        self.note = ""
        self.names = estimated_quantities(scene, application)
        self.estimates = estimates
        if self.estimates is None:
            given = table_in(scene.raw, "quantities")
            asked = next((name for name in given if table_in(given, name).get("error") is True), None)
            if asked is not None:
                raise scene.located(UserError(NONE_HERE, f"quantities.{asked}.error", LEAVE_OUT))
            self.note = NO_ERRORS if given.get(ALL_ERRORS) is True else ""
            self.names = []
        self.singular = singular

    def __call__(self, row: RowValues) -> RowValues:
        """The columns of a frame that was solved; infinite where a quantity has no limit under refinement.

        The first frame also has the note.
        """
        if self.estimates is None:
            first = self.note and not whole(row, "index")
            return {"note": "; ".join(filter(None, (text(row, "note"), self.note)))} if first else {}
        if not self.names:
            return {}
        found: dict[str, float] = dict.fromkeys(self.singular, np.inf)
        found |= self.estimates([name for name in self.names if name not in self.singular])
        return {error_column(name): found.get(name, np.nan) for name in self.names}
