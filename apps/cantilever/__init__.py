"""Beams clamped at one end that deform by their own weight and by wind, to meet a goal: after figure 4.4 of the thesis.

Quantities of interest: the mean distance of the deformed outline from a goal, and those of static solids.
"""

from pathlib import Path

from restshape.application import Application, Declared, HandMarks

application = Application(
    name="cantilever",
    summary="beams that deform by weight and wind to meet a goal shape",
    folder=Path(__file__).parent,
    physics=Declared("restshape.physics.elasticity.elasticity_declaration:PLANE_SOLIDS"),
    analysis="restshape.physics.elasticity.elasticity_analyses:steady_analysis",
    marks=HandMarks("restshape_apps.cantilever.miss_marks:miss_marks"),
    takes=("solid", "large_deformation", "gravity"),
    needs=("large_deformation",),
)
