"""Curves that deformed edges should meet."""

from itertools import pairwise
from typing import Annotated, Self

from pydantic import Field, model_validator

from restshape.scene.units import UnitError
from restshape.scene.values import Point, Strict, only_one


class Goal(Strict):
    """``[goal.NAME]``: a curve in the plane that a deformed shape is measured against, through points [m] in order.

    ``spline`` is a cubic spline through them, ``polyline`` straight pieces between them.

    Args:
        spline: points of a cubic spline, in order.
        polyline: corners of straight pieces, in order.
    """

    spline: Annotated[list[Point], Field(min_length=2)] | None = None
    polyline: Annotated[list[Point], Field(min_length=2)] | None = None

    @model_validator(mode="after")
    def _is_one_curve(self) -> Self:
        points = getattr(self, only_one(self, ("spline", "polyline")))
        if any(a == b for a, b in pairwise(points)):
            raise UnitError("two points of a goal that follow each other are the same")
        return self


def goal_words(goal: Goal) -> str:
    """What a goal is, for people."""
    return f"a curve through {len(goal.spline or goal.polyline)} points"
