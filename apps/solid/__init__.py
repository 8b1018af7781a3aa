"""Elastic solids in the plane in static equilibrium, of small or large deformation: plates, brackets, membranes, beams.

Quantities of interest: displacements, reactions, stresses and strain energy, at points, on edges, or as extremes, and
critical load factors.
"""

from pathlib import Path

from restshape.application import Application
from restshape.physics.elasticity.elasticity_declaration import PLANE_SOLIDS

application = Application(
    name="solid",
    summary="elastic solids in the plane, in static equilibrium",
    folder=Path(__file__).parent,
    physics=(PLANE_SOLIDS,),
    analysis="restshape.physics.elasticity.elasticity_analyses:steady_analysis",
)
