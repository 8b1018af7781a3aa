"""Heat in the plane: bodies that conduct it, steady or in time, and fluids that carry it and that it drives.

Quantities of interest: temperatures, means and extremes, heat that leaves by an edge, Nusselt numbers, those of flow.
"""

from pathlib import Path

from restshape.application import Application, Declared, HandMarks, SceneKind

application = Application(
    name="thermal",
    summary="heat that bodies conduct, and that fluids carry",
    folder=Path(__file__).parent,
    physics=Declared("restshape.physics.heat.heat_declaration:HEAT"),
    analysis="restshape.physics.heat.heat_analyses:heat_analysis",
    marks=HandMarks("restshape_apps.thermal.isotherm_marks:isotherm_marks"),
    kinds={
        "fluid": SceneKind(
            physics=Declared(
                "restshape.physics.flow.flow_declaration:FLOW",
                "restshape.physics.heated_flow.heated_flow_declaration:HEATED_FLOW",
            ),
            analysis="restshape.physics.heated_flow.heated_flow_analyses:fluid_analysis",
        )
    },
)
