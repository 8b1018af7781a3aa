"""Bridges that span a gap and bear a weight, strong enough with little material: after section 4.5 of the thesis.

Quantities of interest: the largest von Mises stress at nodes, whose limit gives the verdict, and the area, the score.
"""

from pathlib import Path

from restshape_apps.solid import LARGE_DEFORMATION, Gravity, Solid

from restshape.application import Application
from restshape.physics.elasticity.declaration import PLANE_SOLIDS
from restshape.scene.effect import Effect

application = Application(
    name="bridge",
    summary="bridges that bear a weight with little material",
    effects={
        "solid": Effect(Solid, "elasticity", required=True),
        "gravity": Effect(Gravity, "weight of the body", drives=True),
        "large_deformation": LARGE_DEFORMATION,
    },
    folder=Path(__file__).parent,
    physics=(PLANE_SOLIDS,),
    analysis="restshape.physics.elasticity.analyses:steady_analysis",
)
