"""Errors of quantities beside their values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, cast

import numpy as np

from restshape.analysis.quantity_errors import LEAVE_OUT, NONE_HERE
from restshape.errors import ReplayProblem, UserError
from restshape.replay.columns import error_column, estimated_quantities
from restshape.scene.plain_values import table_in
from restshape.scene.quantity import ALL_ERRORS

if TYPE_CHECKING:
    from restshape.analysis.analysis import Analysis, RowValues, Solvable
    from restshape.application import Application
    from restshape.scene.model import Scene
    from restshape.shape.protocol import Session
    from restshape.shape.session import EditSession


def singular_quantities(scene: Scene, application: Application, session: Session) -> dict[str, float]:
    """Quantities without a limit under refinement on the first shape, with the exponent lambda of displacements."""
    found: dict[str, float] = {}
    for physics in application.physics:
        if physics.inspect_shape:
            try:
                found |= physics.inspected(scene, cast("EditSession", session).outline).singular
            except ReplayProblem:
                # The first frame says what is wrong with the shape.
                continue
    return found


class QuantityErrorColumns:
    """Estimates errors of the quantities that a scene wants them of, frame after frame.

    Args:
        scene: of the replay.
        application: of the scene.
        analysis: that gives the quantities.
        singular: quantities without a limit under refinement.

    Raises:
        UserError: the scene asks for an error that this analysis does not estimate.
    """

    def __init__(
        self, scene: Scene, application: Application, analysis: Analysis[Solvable], singular: Mapping[str, float]
    ) -> None:
        self.analysis = analysis
        self.names = estimated_quantities(scene, application)
        self.estimates = analysis.quantity_errors
        if self.estimates is None:
            asked = next((name for name, quantity in scene.quantities.items() if quantity.error), None)
            if asked is not None:
                key = "error" if table_in(scene.raw, "quantities").get(ALL_ERRORS) is True else f"{asked}.error"
                raise scene.located(UserError(NONE_HERE, f"quantities.{key}", LEAVE_OUT))
            self.names = []
        self.singular = [name for name in self.names if name in singular]

    def __call__(self, row: RowValues) -> RowValues:
        """The columns of a frame that was solved; infinite where a quantity has no limit under refinement."""
        if self.estimates is None:
            return {}
        found: dict[str, float] = dict.fromkeys(self.singular, np.inf)
        found |= self.estimates([name for name in self.names if name not in self.singular])
        return {error_column(name): found.get(name, np.nan) for name in self.names}
