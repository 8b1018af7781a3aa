"""Beams held at one end that deform by their own weight and by wind, to meet a goal: after figure 4.4 of the thesis.

Quantities of interest: the mean distance of the deformed outline from a goal, and those of solids at rest.
"""

from dataclasses import replace
from pathlib import Path

from restshape_apps.solid import LARGE_DEFORMATION, Gravity, Solid

from restshape.application import Application
from restshape.physics.elasticity.declaration import PLANE_SOLIDS
from restshape.scene.effect import Effect

application = Application(
    name="cantilever",
    summary="beams that deform by weight and wind to meet a goal shape",
    effects={
        "solid": Effect(Solid, "elasticity", required=True),
        "large_deformation": replace(LARGE_DEFORMATION, required=True),
        "gravity": Effect(Gravity, "weight of the body", drives=True),
    },
    folder=Path(__file__).parent,
    physics=(PLANE_SOLIDS,),
    analysis="restshape.physics.elasticity.analyses:steady_analysis",
)
