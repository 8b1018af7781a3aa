"""Applications of the tests' own: one for each kind of analysis, of the library's physics alone.

They are found by the entry points beside this folder, which pytest has on its path and conftest on that of processes.
"""

from pathlib import Path

from restshape.application import Application
from restshape.physics.cloth.cloth_declaration import CLOTH
from restshape.physics.elasticity.elasticity_declaration import FREE_VIBRATIONS, MOVING_SOLIDS, PLANE_SOLIDS
from restshape.physics.heat.heat_declaration import HEAT

HERE = Path(__file__).parent

plane = Application(
    name="plane",
    summary="solids in the plane, in static equilibrium",
    folder=HERE / "plane",
    physics=(PLANE_SOLIDS,),
    analysis="restshape.physics.elasticity.elasticity_analyses:steady_analysis",
)
beams = Application(
    name="beams",
    summary="beams that deform far",
    folder=HERE / "beams",
    physics=(PLANE_SOLIDS,),
    analysis="restshape.physics.elasticity.elasticity_analyses:steady_analysis",
    takes=("solid", "large_deformation", "gravity"),
    needs=("large_deformation",),
)
moving = Application(
    name="moving",
    summary="solids in motion",
    folder=HERE / "moving",
    physics=(MOVING_SOLIDS,),
    analysis="restshape.physics.elasticity.elasticity_analyses:transient_analysis",
)
modes = Application(
    name="modes",
    summary="bodies that vibrate freely",
    folder=HERE / "modes",
    physics=(FREE_VIBRATIONS,),
    analysis="restshape.physics.free_vibration.vibrating_bodies:modal_analysis",
)
cloth = Application(
    name="cloth",
    summary="cloth at rest",
    folder=HERE / "cloth",
    physics=(CLOTH,),
    analysis="restshape.physics.cloth.relaxation.relaxation_analysis:RelaxationAnalysis",
)
conduction = Application(
    name="conduction",
    summary="bodies that conduct heat",
    folder=HERE / "conduction",
    physics=(HEAT,),
    analysis="restshape.physics.heat.heat_analyses:heat_analysis",
)
