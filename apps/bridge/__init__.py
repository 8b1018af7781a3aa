"""Bridges that span a gap and bear a weight, strong enough with little material: after section 4.5 of the thesis.

Quantities of interest: the largest von Mises stress at nodes, whose limit gives the constraint status, and the area,
the score.
"""

from pathlib import Path

from restshape.application import Application, Declared, HandMarks

application = Application(
    name="bridge",
    summary="bridges that bear a weight with little material",
    folder=Path(__file__).parent,
    physics=Declared("restshape.physics.elasticity.elasticity_declaration:PLANE_SOLIDS"),
    analysis="restshape.physics.elasticity.elasticity_analyses:steady_analysis",
    marks=HandMarks("restshape_apps.bridge.score_marks:score_marks"),
    takes=("solid", "gravity", "large_deformation"),
)
