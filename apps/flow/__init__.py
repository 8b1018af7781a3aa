"""Incompressible flow around and through shapes in the plane: bodies in a stream, channels, vessels.

Quantities of interest: drag and lift, differences of pressure, discharges.
"""

from pathlib import Path

from restshape.application import Application, Declared, HandMarks

application = Application(
    name="flow",
    summary="incompressible flow around and through shapes",
    folder=Path(__file__).parent,
    physics=Declared("restshape.physics.flow.flow_declaration:FLOW"),
    analysis="restshape.physics.flow.flow_analyses:flow_analysis",
    marks=HandMarks("restshape_apps.flow.force_marks:force_marks"),
    needs=("flow",),
)
