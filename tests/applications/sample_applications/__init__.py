"""Applications of the tests' own: one for each kind of analysis, of the library's physics alone.

They are found by the entry points beside this folder, which pytest has on its path and conftest on that of processes.
"""

from pathlib import Path

from restshape.application import Application, Command, Declared

HERE = Path(__file__).parent

plane = Application(
    name="plane",
    summary="solids in the plane, in static equilibrium",
    folder=HERE / "plane",
    physics=Declared("restshape.physics.elasticity.elasticity_declaration:PLANE_SOLIDS"),
    analysis="restshape.physics.elasticity.elasticity_analyses:steady_analysis",
    commands=(Command("sample-names", "print the names in a scene", "sample_applications.names_command"),),
)
beams = Application(
    name="beams",
    summary="beams that deform far",
    folder=HERE / "beams",
    physics=Declared("restshape.physics.elasticity.elasticity_declaration:PLANE_SOLIDS"),
    analysis="restshape.physics.elasticity.elasticity_analyses:steady_analysis",
    takes=("solid", "large_deformation", "gravity"),
    needs=("large_deformation",),
)
moving = Application(
    name="moving",
    summary="solids in motion",
    folder=HERE / "moving",
    physics=Declared("restshape.physics.elasticity.elasticity_declaration:MOVING_SOLIDS"),
    analysis="restshape.physics.elasticity.elasticity_analyses:transient_analysis",
)
modes = Application(
    name="modes",
    summary="bodies that vibrate freely",
    folder=HERE / "modes",
    physics=Declared("restshape.physics.elasticity.elasticity_declaration:FREE_VIBRATIONS"),
    analysis="restshape.physics.free_vibration.vibrating_bodies:modal_analysis",
)
cloth = Application(
    name="cloth",
    summary="cloth at rest",
    folder=HERE / "cloth",
    physics=Declared("restshape.physics.cloth.cloth_declaration:CLOTH"),
    analysis="restshape.physics.cloth.relaxation.relaxation_analysis:RelaxationAnalysis",
)
conduction = Application(
    name="conduction",
    summary="bodies that conduct heat",
    folder=HERE / "conduction",
    physics=Declared("restshape.physics.heat.heat_declaration:HEAT"),
    analysis="restshape.physics.heat.heat_analyses:heat_analysis",
)
