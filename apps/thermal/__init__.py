"""Bodies in the plane that conduct heat: heat sinks, walls, pipes, steady or in time.

Quantities of interest: temperatures, means and extremes, and the heat that leaves by an edge.
"""

from pathlib import Path

from restshape.application import Application, Declared

application = Application(
    name="thermal",
    summary="bodies in the plane that conduct heat",
    folder=Path(__file__).parent,
    physics=Declared("restshape.physics.heat.heat_declaration:HEAT"),
    analysis="restshape.physics.heat.heat_analyses:heat_analysis",
)
