"""Linear elastic solids in the plane, at rest: plates, brackets, membranes.

Quantities of interest: displacements, reactions, stresses and strain energy, at points, on edges, or as extremes.
"""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from restshape.application import Application, Effect


class Solid(BaseModel):
    """Keys of ``[effects.solid]``."""

    model_config = ConfigDict(extra="forbid")
    model: Literal["plane_stress", "plane_strain"] = "plane_stress"


class Gravity(BaseModel):
    """Keys of ``[effects.gravity]``: the acceleration g [m/s^2]."""

    model_config = ConfigDict(extra="forbid")
    g: Annotated[list[float], Field(min_length=2, max_length=2)] = [0.0, -9.81]


application = Application(
    name="solid",
    summary="linear elastic solids in the plane, at rest",
    effects={
        "solid": Effect(Solid, "linear elasticity", required=True),
        "gravity": Effect(Gravity, "weight of the body"),
    },
    folder=Path(__file__).parent,
    analysis="restshape.analysis.static:StaticAnalysis",
    validation="restshape_apps.solid.validation:CASES",
    thesis="restshape_apps.solid.thesis:rows",
)
