"""Which limits are nearer to values than these are known: by estimated errors, and by jumps of the mesh."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from typing import TYPE_CHECKING

from restshape.analysis.row_values import number, text, whole
from restshape.findings import decode_findings, encode_findings
from restshape.first_use import made
from restshape.replay.columns import distance_column, error_column, jump_column
from restshape.replay.constraints import (
    FAILS,
    HOLDS,
    LIMIT,
    MIN,
    UNCERTAIN,
    UNSURE,
    Limits,
    formatted_constraint,
    uncertain_constraints,
    value_and_bound,
    violated_constraints,
)
from restshape.replay.estimated_frames import EVERYTHING, WantedErrors
from restshape.replay.step_errors import UNKNOWN, StepErrors
from restshape.scene.quantity import in_unit

if TYPE_CHECKING:
    from restshape.analysis.analysis import RowValues
    from restshape.analysis.row_values import RowValue
    from restshape.findings import Finding

ERROR_FACTOR = 2.0
"""True errors up to so many times the estimated one count: the least effectivity that tests accept of it is 0.5."""
BY_ERROR, BY_JUMP = "twice its estimated error", "a jump of the mesh"
BY_EARLIER = "twice its error as estimated in an earlier frame"
BY_PLACE = "at a singular place, finer meshes give more"
BY_PREDICTION, BY_STEPS = "the error of the prediction", "the errors of its time steps"
UNESTIMATED = {BY_PREDICTION: "a prediction of unknown error", BY_STEPS: "less than ten time steps a period"}
"""What is said where nothing gives the size of an error."""
BY_VALUES = "limits are judged by values alone: solve.estimate leaves out the errors of quantities"
"""Note of the first frame whose limits count without any error known."""


class UncertainLimits:
    """Makes the constraint status uncertain where a value is nearer to its limit than it is known.

    A jump counts until the next new mesh: frames between have the answers of this mesh, not of another. Of what is not
    estimated in a frame the last estimate counts.

    Args:
        singular: quantities without a limit under refinement.
        own_row: gives the columns of the frame that only its analysis has, which may violate constraints of its own.
        exact: quantities of the shape alone, which no prediction changes, nor a time step.
    """

    def __init__(
        self,
        singular: Mapping[str, float],
        own_row: Callable[[], Mapping[str, RowValue]] = dict,
        exact: Collection[str] = (),
    ) -> None:
        self.singular, self.own_row, self.exact = singular, own_row, frozenset(exact)
        self._jumps: dict[str, float] = {}
        self._errors: dict[str, float] = {}
        self._earlier: set[str] = set()
        self._steps = StepErrors()
        self._judged = False

    def __call__(self, row: RowValues, limits: Limits, wanted: WantedErrors = EVERYTHING) -> RowValues:
        """The columns of a frame that was solved which change, with its errors and jumps in the row.

        Args:
            row: of the frame.
            limits: of its scene, by quantity.
            wanted: what is estimated of it; of the others the last estimate counts.
        """
        values = {name: number(row, f"q_{name}") for name in limits}
        self._steps.take(row, limits, wanted.answer)
        self._take_errors(row, limits, wanted)
        errors, why = {}, {}
        for name in limits:
            errors[name], why[name] = max(self._doubts(name, row))
        uncertain, violated = (
            uncertain_constraints(limits, values, errors),
            violated_constraints(limits, values),
        )
        known = {(one.detail, one.subjects) for one in uncertain}
        certain = {one.subjects for one in violated if (one.detail, one.subjects) not in known}
        uncertain = tuple(one for one in uncertain if one.subjects not in certain)
        unjudged, self._judged = not (self._judged or wanted.solves or self.exact >= limits.keys()), True
        said = (BY_VALUES,) if unjudged else ()
        if not uncertain:
            return {"note": "; ".join(filter(None, (text(row, "note"), *said)))} if said else {}
        beyond = [one for one in violated if one.subjects not in certain]
        others = [one for one in decode_findings(text(row, "findings")) if one not in beyond]
        own, left = self.own_row(), [formatted_constraint(one) for one in others if one.kind == LIMIT]
        fails = bool(left) or text(own, "constraint_status") == FAILS
        notes = [_note(one, errors[one.subjects[0]], why[one.subjects[0]]) for one in uncertain]
        return {
            "constraint_status": FAILS if fails else UNCERTAIN,
            "violated_constraints": "; ".join(filter(None, (text(own, "violated_constraints"), *left))),
            "note": "; ".join(filter(None, (text(row, "note"), *said, *notes))),
            "findings": encode_findings((*others, *uncertain)),
        }

    def _doubts(self, name: str, row: RowValues) -> list[tuple[float, str]]:
        """By how much the value of a quantity may be off, and why; infinite at a singular place."""
        jump, known = abs(number(row, jump_column(name))), self._jumps.get(name, 0.0)
        if math.isfinite(jump):
            self._jumps[name] = jump if whole(row, "level") == 3 else max(known, jump)
        return [
            (math.inf if name in self.singular else 0.0, BY_PLACE),
            (ERROR_FACTOR * self._errors.get(name, 0.0), BY_EARLIER if name in self._earlier else BY_ERROR),
            (self._jumps.get(name, 0.0), BY_JUMP),
            (self._of_prediction(name, row), BY_PREDICTION),
            (0.0 if name in self.exact else self._steps.error(name), BY_STEPS),
        ]

    def _take_errors(self, row: RowValues, limits: Limits, wanted: WantedErrors) -> None:
        """Take note of the errors of a frame; where it has none and none was wanted, that of before stays."""
        for name in limits:
            error = number(row, error_column(name))
            self._earlier.add(name)
            if math.isfinite(error):
                self._errors[name] = error
                self._earlier.remove(name)
            elif wanted.solves:
                self._errors.pop(name, None)

    def _of_prediction(self, name: str, row: RowValues) -> float:
        """The estimated distance of a predicted quantity from its solution; else that of the frame, of its value."""
        if name in self.exact or not whole(row, "predicted"):
            return 0.0
        if math.isfinite(own := number(row, distance_column(name))):
            return own
        share = number(row, "estimate")
        return UNKNOWN if math.isnan(share) else share * abs(number(row, f"q_{name}"))


def _note(finding: Finding, error: float, why: str) -> str:
    """The side of its limit on which a value is, by how much it may be off, and why."""
    value, bound = value_and_bound(finding)
    beyond = made(finding.value) > made(finding.bound)
    status = FAILS if beyond != (finding.detail == MIN) and finding.value != finding.bound else HOLDS
    limit = f"{'at least' if finding.detail == MIN else 'at most'} {bound}"
    known = error < UNKNOWN
    off = f" ± {in_unit(finding.unit, error, 2)}" if known else ""
    return (
        f"{finding.subjects[0]} {status}, {UNSURE} {value}{off}, {limit}: {why if known else UNESTIMATED.get(why, why)}"
    )
