"""Elastic solids in the plane in static equilibrium, of small or large deformation: plates, brackets, membranes, beams.

Quantities of interest: displacements, reactions, stresses and strain energy, at points, on edges, or as extremes, and
critical load factors.
"""

from pathlib import Path

from restshape.application import Application, Command, Declared, HandMarks

application = Application(
    name="solid",
    summary="elastic solids in the plane, in static equilibrium",
    folder=Path(__file__).parent,
    physics=Declared("restshape.physics.elasticity.elasticity_declaration:PLANE_SOLIDS"),
    analysis="restshape.physics.elasticity.elasticity_analyses:steady_analysis",
    marks=HandMarks("restshape_apps.solid.buckling_marks:buckling_marks"),
    commands=(Command("buckling", "draw the modes in which a solid buckles", "restshape_apps.solid.buckling_command"),),
)
